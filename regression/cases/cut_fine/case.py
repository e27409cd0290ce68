"""Vertical cut, finer

The case `cut` with 80 cells over the height instead of 40: eight times the work, so the case runs on a GPU or on all cores, in
double precision.
"""

from mpm_regression import cases
from mpm_regression.row import Row

cut = cases.Case("cut").module
DECK = "regression/cases/cut/case.opts"
RUNS = {name: f"{options} -mesh_spacing 0.0125" for name, options in cut.RUNS.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def check(runs):
    yield Row("gamma H/su at failure, d = H/80", cut.line(runs)[1], 3.78, 0.03, "limit analysis", relative=True)
