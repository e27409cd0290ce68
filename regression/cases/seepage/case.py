"""Seepage through a column

Water of the pressure $p_b = 0.1\\,\\gamma_w H$ stands on the top of a column whose base is open. When the flow is steady, the flux is
$k i$ with $i = 0.1$, and the pressure falls straight to 0 (`uniform`); through layers of 0.4 m and 0.6 m with
$k = 10^{-3}$ and $10^{-4}$ m/s in series it is $p_b/\\gamma_w$ over the sum of $h/k$, and a sixteenth of the pressure is lost in the upper
one (`layers`). Permeabilities are a hundred times these.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame

HEAD, SCALE, BOUNDARY = 0.1, 100.0, 0.6  # m, m
RUNS = {"uniform": "", "layers": "-sand_permeability 1e-3"}
WEIGHT = 9810.0  # N/m3
PRECISIONS = ("double",)
LONG = True


def check(runs):
    for name, run in runs.items():
        upper = 1e-4 if name == "uniform" else 1e-3
        resistance = (1 - BOUNDARY) / upper + BOUNDARY / 1e-4
        groups = read_frame(run.frame)[1]
        flux = np.concatenate([groups[body]["darcy_flux"][:, 1] for body in groups])
        exact = HEAD / resistance * SCALE
        yield Row(f"mean flux over that of Darcy's law, {name}", -flux.mean() / exact, 1, 1e-3, "resistances in series", single=5e-3)
        yield Row(f"largest difference of the flux over it, {name}", np.abs(flux + exact).max() / exact, 0, 0.01, "steady flow", single=0.03)
        y = np.concatenate([groups[body]["position"][:, 1] for body in groups])
        pressure = np.concatenate([groups[body]["pore_pressure"] for body in groups])
        head = np.where(y < BOUNDARY, y / 1e-4, BOUNDARY / 1e-4 + (y - BOUNDARY) / upper) / resistance * HEAD
        # A group of particles has one pressure: compare the means of the rows of cells.
        cell = np.floor(y / 0.025)
        error = [np.mean((pressure - WEIGHT * head)[cell == c]) for c in np.unique(cell)]
        yield Row(f"largest error of the pressure of a row of cells over that on top, {name}", np.abs(error).max() / (WEIGHT * HEAD), 0,
                  0.01, "steady flow", single=0.02)
