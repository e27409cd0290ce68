"""Strip footing of Dong, Wang & Randolph (2015), cells of B/40

The benchmark's own mesh: half of a smooth strip on weightless clay, 76,800 particles, 33,334 steps to 0.2 B, against an
independent sequential solver with the same rules of contact.
"""

from mpm_regression.checks.footing import against_reference, draw_curve
from mpm_regression.size import Size

DECK = "inputs/footing.opts"
RUNS = {"footing": ""}
LONG = True


def check(runs):
    yield from against_reference(runs["footing"], spacing=0.025, allowed=0.12)


def draw(axes, runs):
    draw_curve(axes, runs["footing"], 0.025)


class Coarse(Size):
    """Strip footing of Dong, Wang & Randolph (2015), cells of B/20

    The same problem on cells twice as large.
    """

    DECK = "regression/cases/footing/coarse.opts"

    def check(runs):
        yield from against_reference(runs["footing"], spacing=0.05, allowed=0.15)

    def draw(axes, runs):
        draw_curve(axes, runs["footing"], 0.05)
