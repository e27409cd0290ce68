"""Submarine landslide of Dong, Wang & Randolph (2015)

A slab of clay, 40 m long and 5 m high, slides on a rough base that slopes by 5 degrees, and comes to rest after about
11 s and 20 to 25 m. Cells of 0.1 m, 79,456 particles, 75,000 steps. The expected run-out spans the published one and
those of an independent solver with two kinds of contact normals. The paper gives the time at which the slide stops
(11 s), but this time depends on the smallest residual motion, so it is no answer for a check.
"""

from mpm_regression.checks.landslide import draw_curve, rows
from mpm_regression.size import Size

DECK = "inputs/landslide.opts"
RUNS = {"landslide": ""}
BACKENDS = ("openmp", "cuda")
LONG = True


def check(runs):
    yield from rows(runs["landslide"])


def draw(axes, runs):
    draw_curve(axes, runs["landslide"])


class Coarse(Size):
    """Submarine landslide, cells of 0.25 m

    The same slide on coarser cells: 12,584 particles, 30,000 steps.
    """

    DECK = "inputs/landslide_coarse.opts"
    BACKENDS = ("serial", "openmp", "cuda")
    draw = draw
