"""Smooth retaining wall, finer

The case `retaining_wall` with 40 cells over the height instead of 10.
"""

from mpm_regression import cases

wall = cases.Case("retaining_wall").module
DECK = "regression/cases/retaining_wall/case.opts"
RUNS = {name: f"{options} -mesh_spacing 0.025" for name, options in wall.RUNS.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True
prepare, check, draw = wall.prepare, wall.check, wall.draw
