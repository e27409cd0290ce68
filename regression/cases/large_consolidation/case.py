"""Consolidation with large strains

A column of 1 m, Young's modulus 1 MPa, Poisson's ratio 0 and porosity 0.6 under 400 kPa, which the water carries at first, settles by
a third. Finite volumes and Chebyshev polynomials give the settlement and the pressure at the base by Gibson's equation (Gibson,
England and Hussey 1967) in the logarithmic strain of this program's elastic law, for a constant permeability and one that follows the
porosity (`kozeny`). Terzaghi's series with the first height would give a degree of consolidation of 0.76 where the answer is 0.92.
The load passes from the water to the soil within 0.25 s, from whose middle times count. Permeabilities are fifty times those of
the mud, and times a fiftieth.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, time_of

LOAD, WHOLE, SCALE, UNIT = 400e3, 0.329680, 50.0, 99.081  # Pa; m, the last settlement; s, time of T = 1
MIDDLE = 0.125  # s, of the time in which the load comes
RUNS = {"constant": "", "kozeny": "-mud_permeability_law kozeny"}
# T, settlement [m], pressure at the base over the load.
EXACT = {"constant": {0.5: (0.30234, 0.15796), 1: (0.32784, 0.01077)}, "kozeny": {0.5: (0.19152, 0.64466), 1: (0.25053, 0.39862)}}
PRECISIONS = ("double",)
LONG = True


def check(runs):
    for name, run in runs.items():
        start = read_frame(run.frames[0])[1]["column"]["position"][:, 1].max()
        times = np.array([time_of(path) for path in run.frames])
        for at, (settled, base) in EXACT[name].items():
            # The mean over a period of the fast wave, 4H/c, of which there are frames enough.
            near = [read_frame(path)[1]["column"] for path, time in zip(run.frames, times) if abs(time - MIDDLE - at * UNIT / SCALE) < 0.0085]
            found = start - np.mean([column["position"][:, 1].max() for column in near])
            # The uppermost particles' centres are a quarter of a cell below the top at the start.
            found += (1 - np.exp(-LOAD / 1e6)) * 0.025 / 4
            yield Row(f"settlement over the last one, {name}, T = {at}", found / WHOLE, settled / WHOLE, 0.015, "Gibson's equation")
            pressure = np.mean([column["pore_pressure"][column["position"][:, 1] < 0.025].mean() for column in near]) / LOAD
            yield Row(f"pressure at the base over the load, {name}, T = {at}", pressure, base, 0.015, "Gibson's equation")
