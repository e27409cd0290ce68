"""Settling and consolidation of mud by its own weight

Mud of the porosity 0.7, 2 m deep under water, begins without effective stress: the water carries the whole buoyant weight. The surface
falls at the rate $k\\gamma'/\\gamma_w$ until consolidation from the base has reached it. Finite volumes and Chebyshev polynomials give
the settlement and the pressure at the base by Gibson's equation, in the logarithmic strain of this program's elastic law, for a
constant permeability and one that follows the porosity (Kozeny and Carman). Permeabilities are a hundred times those of the mud,
and the times a hundredth; water of 7 MPa changes the answers by less than the tolerance.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row
from soil_mpm.results import read_frame

DEPTH, SPACING, SCALE = 2.0, 0.025, 100.0  # m, m
BUOYANT = 0.3 * 1650 * 9.81  # N/m3
RUNS = {"constant": "-column_file {start}", "kozeny": "-column_file {start} -mud_permeability_law kozeny"}
# Time [s], settlement [m], excess pressure at the base over the buoyant weight of the column.
EXACT = {"constant": {50: (0.002475, 0.94258), 200: (0.009900, 0.88425), 1000: (0.049479, 0.73598)},
         "kozeny": {50: (0.002475, 0.9430), 200: (0.009900, 0.88615), 1000: (0.049461, 0.74588)}}
PRECISIONS = ("double",)
LONG = True


def prepare(run, path, options):
    place = particles.lattice((0, 0), (0.05, DEPTH), SPACING)
    particles.write(path, "column", place, SPACING, excess_pore_pressure=BUOYANT * (DEPTH - place[:, 1]))


def check(runs):
    for name, run in runs.items():
        start = read_frame(run.frames[0])[1]["column"]["position"][:, 1].max()
        for time, (settlement, base) in EXACT[name].items():
            column = read_frame(run.frame_near(time / SCALE))[1]["column"]
            y, pressure = column["position"][:, 1], column["excess_pore_pressure"]
            yield Row(f"settlement over the exact one, {name}, {time} s", (start - y.max()) / settlement, 1, 0.02, "Gibson's equation",
                      relative=True)
            yield Row(f"pressure at the base over the buoyant weight, {name}, {time} s", pressure[y < 2 * SPACING].mean() / (BUOYANT * DEPTH),
                      base, 0.02, "Gibson's equation")
