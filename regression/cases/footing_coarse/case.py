"""Strip footing of Dong, Wang & Randolph (2015), cells of B/20

The same problem on cells twice as large.
"""

from mpm_regression.checks.footing import against_reference, draw_curve

RUNS = {"footing": ""}
LONG = True


def check(runs):
    yield from against_reference(runs["footing"], spacing=0.05, allowed=0.15)


def draw(axes, runs):
    draw_curve(axes, runs["footing"], 0.05)
