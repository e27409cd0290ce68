"""Circular footing on clay of one strength, cells of D/40

The same problem on cells half as large.
"""

from mpm_regression.checks.circle import ROUGH, check_factors, draw_factors

DECK = "regression/cases/circle/case.opts"
RUNS = {"smooth": "-mesh_spacing 0.025", "rough": "-mesh_spacing 0.025 " + ROUGH}
LONG = True


def check(runs):
    yield from check_factors(runs, cells=40, allowed=0.03)


def draw(axes, runs):
    draw_factors(axes, runs)
