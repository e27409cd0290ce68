"""Vertical cut, Tresca

The case `cut` with the law `tresca`, which has the strength of `von_mises` in plane strain: the cut stands up to
$\\gamma H / s_u$ = 3.7752 to 3.7776.
"""

from mpm_regression import cases
from mpm_regression.row import Row

cut = cases.Case("cut").module
DECK = "regression/cases/cut/case.opts"
RUNS = {name: f"{options} -clay_model tresca" for name, options in cut.RUNS.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def check(runs):
    yield Row("gamma H/su at failure, d = H/40", cut.line(runs)[1], 3.7764, 0.03,
              "limit analysis (Kammoun et al. 2010)", relative=True, shortfall=cut.COARSE, bound=0.045)
    yield Row(f"speed of the bank at gamma H/su = {cut.STANDS} (m/s)", cut.speed(runs[f"n_{cut.STANDS}"]), 0, 1e-3,
              "below the limit it stands")
