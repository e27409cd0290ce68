"""Vertical cut in soil with cohesion and friction, coarse

The case `cut_friction` for $\\phi$ = 20° with 20 cells over the height instead of 40.
"""

from mpm_regression import cases

cut = cases.Case("cut_friction").module
DECK = "regression/cases/cut_friction/case.opts"
RUNS = cut.runs_of((20,), " -mesh_spacing 0.05")
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)


def check(runs):
    yield from cut.rows(runs, (20,), 20)
