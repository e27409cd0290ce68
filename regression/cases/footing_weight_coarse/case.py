"""Strip footing on sand with weight, coarse

$N_\\gamma$ for $\\phi$ = 30° as in `footing_weight`, with 11 cells under the footing instead of 41.
"""

from mpm_regression import cases
from mpm_regression.checks import footing_limits as footing
from mpm_regression.row import Row

fine = cases.Case("footing_weight").module
DECK = "regression/cases/footing_weight/case.opts"
CELLS, PHI = 11, 30
RUNS = {base: footing.weight_options(PHI, CELLS, fine.WEIGHT * fine.EXACT[base, PHI] / 2) + more
        for base, more in footing.BASES.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)


def prepare(run, path, options):
    fine.write_ground(path, PHI, CELLS)


def check(runs):
    for base, run in runs.items():
        yield Row(f"N gamma, {base}, phi = {PHI}, d = B/{CELLS}", fine.factor(run), fine.EXACT[base, PHI], 0.08, fine.SOURCE,
                  relative=True)
