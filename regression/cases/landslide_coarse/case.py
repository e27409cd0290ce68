"""Submarine landslide, cells of 0.25 m

The same slide on coarser cells: 12,584 particles, 30,000 steps.
"""

from mpm_regression.checks.landslide import draw_curve, rows

DECK = "inputs/landslide_coarse.opts"
RUNS = {"landslide": ""}
LONG = True


def check(runs):
    yield from rows(runs["landslide"])


def draw(axes, runs):
    draw_curve(axes, runs["landslide"])
