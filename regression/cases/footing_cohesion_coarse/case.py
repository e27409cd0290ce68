"""Strip footing on soil with cohesion and friction, coarse

$N_c$ for $\\phi$ = 30° as in `footing_cohesion`, with 11 cells under the footing instead of 41.
"""

from mpm_regression import cases
from mpm_regression.checks import footing_limits as footing
from mpm_regression.row import Row

fine = cases.Case("footing_cohesion").module
DECK = "regression/cases/footing_cohesion/case.opts"
CELLS, PHI = 11, 30
RUNS = {base: footing.cohesion_options(PHI, CELLS) + more for base, more in footing.BASES.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)


def check(runs):
    for base, run in runs.items():
        yield Row(f"Nc, {base}, phi = {PHI}, d = B/{CELLS}", fine.factor(run), footing.cohesion_factor(PHI), footing.tolerance(PHI),
                  "Prandtl (1921)", relative=True, shortfall=footing.COARSE, bound=0.12)
