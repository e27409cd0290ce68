"""Strip footing, finer

The case `strip` with cells of $B$/80 and of $B$/40: eight times the work, so the case runs on a GPU or on all cores, in
double precision. The straight line through the two answers, over $d$, gives the answer at $d = 0$. A part of the difference is no
error: a footing that has sunk by 0.035 $B$, the mean of the window, stands in a trough.
"""

from mpm_regression import cases
from mpm_regression.row import Row

strip = cases.Case("strip").module
DECK = "regression/cases/strip/case.opts"
SPACINGS = (0.025, 0.0125)
RUNS = {f"{base}_{d}": f"-mesh_spacing {d}" + more for base, more in (("smooth", ""), ("rough", strip.ROUGH)) for d in SPACINGS}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def check(runs):
    for base in ("smooth", "rough"):
        coarse, fine = (strip.factor(runs[f"{base}_{d}"]) for d in SPACINGS)
        yield Row(f"Nc, {base}, d = B/80", fine, strip.EXACT, 0.03, "Prandtl (1921)", relative=True)
        yield Row(f"Nc, {base}, extrapolated from B/40 and B/80", 2 * fine - coarse, strip.EXACT, 0.02, "Prandtl (1921)",
                  relative=True)


def draw(axes, runs):
    strip.draw_curves(axes, runs, dict(zip(SPACINGS, ("--", "-"))))
