"""Strip footing on sand under a surcharge, coarse

$N_q$ for $\\phi$ = 30° as in `footing_surcharge`, with 11 cells under the footing instead of 41.
"""

from mpm_regression import cases
from mpm_regression.checks import footing_limits as footing
from mpm_regression.row import Row

fine = cases.Case("footing_surcharge").module
DECK = "regression/cases/footing_surcharge/case.opts"
CELLS, PHI = 11, 30
RUNS = {base: footing.surcharge_options(PHI, CELLS) + more for base, more in footing.BASES.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)


def check(runs):
    for base, run in runs.items():
        yield Row(f"Nq, {base}, phi = {PHI}, d = B/{CELLS}", fine.factor(run), footing.surcharge_factor(PHI),
                  footing.tolerance(PHI), "Prandtl (1921), Reissner (1924)", relative=True, shortfall=footing.COARSE, bound=0.1)
        yield Row(f"surcharge at the end over that at the start, {base}", fine.pressure(run), 1, 0.02, "set-up")
