"""Thin plate deep in clay

A thin plate far below the surface, pushed normal to its faces, carries $N s_u$ times its area while the clay flows round it:
$N$ = 11.42 for a strip, rough or smooth, and 12.42 for a smooth and 13.11 for a rough disc (Martin & Randolph 2001), in clay of `tresca`. The plate
is one cell thick, and has contact at sites or at nodes. The mean over the ways from 0.04 $B$ to 0.12 $B$ is compared.
The walls are 1.5 $B$ or more from its edge.
"""

import itertools
import re

import numpy as np

from mpm_regression.row import Row

STRENGTH = 3000.0
SOURCE = "Martin & Randolph (2001)"
PLATES = {  # options, exact factor, area in the mesh [m2]
    "strip_rough": ("-plate_shear_fraction 1", 11.42, 0.5),
    "strip_smooth": ("-plate_shear_fraction 0", 11.42, 0.5),
    "disc_rough": ("-plate_shear_fraction 1 -geometry axisymmetric", 13.11, np.pi / 4),
    "disc_smooth": ("-plate_shear_fraction 0 -geometry axisymmetric", 12.42, np.pi / 4),
}
COARSE = "-mesh_spacing 0.125 -plate_lower -0.5,-0.0625 -plate_upper 0.5,0.0625"
HOW = {"sites, B/16": "-plate_contact sites", "sites, B/8": f"-plate_contact sites {COARSE}", "nodes, B/16": ""}
SHORT = {"sites, B/8": "Eight cells over the plate.", "nodes, B/16": "Discs act wider by a part of a cell with contact at nodes (docs/axisymmetry.md)."}
RUNS = {f"{plate}_{re.sub('[, B/]+', '_', how)}": f"{options} {more}" for plate, (options, *_) in PLATES.items() for how, more in HOW.items()}
LONG = True


def curve(run, plate):
    """Way over B, and the factor, in the middle of each interval of the history."""
    way = -run.history["plate_y"]
    return (way[1:] + way[:-1]) / 2, run.history["plate_force_y"][1:] / (PLATES[plate][2] * STRENGTH)


def factor(run, plate):
    way, n = curve(run, plate)
    return n[(way > 0.04) & (way < 0.12)].mean()


def check(runs):
    for (plate, how), run in zip(itertools.product(PLATES, HOW), runs.values()):
        yield Row(f"N, {plate.replace('_', ', ')}, contact at {how}", factor(run, plate), PLATES[plate][1], 0.05, SOURCE, relative=True,
                  shortfall=SHORT.get(how, ""), bound=0.12)


def draw(axes, runs):
    for plate, colour in zip(PLATES, ("C0", "C1", "C2", "C3")):
        way, n = curve(runs[f"{plate}_sites_16"], plate)
        axes.plot(*(np.convolve(each, np.ones(15) / 15, "valid") for each in (way, n)), colour, lw=1, label=plate.replace("_", ", "))
        axes.axhline(PLATES[plate][1], color=colour, ls="--", lw=0.8)
    axes.set(xlabel="way over B", ylabel="$N$, mean of 15 rows (dashed: exact)", xlim=(0, 0.12), ylim=(0, 16))
    axes.legend(fontsize=8)
