"""Deep pipe, finer

The smooth and the rough pipe of the case `pipe` with 32 cells across the pipe instead of 16: eight times the work, so the case
runs on a GPU or on all cores, in double precision.
"""

from mpm_regression import cases
from mpm_regression.row import Row

pipe = cases.Case("pipe").module
DECK = "regression/cases/pipe/case.opts"
RUNS = {f"a_{a}": f"{pipe.RUNS[f'a_{a}']} -mesh_spacing 0.03125" for a in (0, 1)}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def check(runs):
    for a in (0, 1):
        yield Row(f"N, tau_max/su = {a}, d = D/32", pipe.factor(runs[f"a_{a}"]), pipe.exact(a), 0.03, "Randolph & Houlsby (1984)",
                  relative=True)
