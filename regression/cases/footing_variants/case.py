"""Variants of the footing

The whole footing of footing_coarse instead of half of it, in single precision, 200 m away, and with every strategy.
All runs must give the same curve.

Positions count from the mesh's lower corner. There are therefore two runs 200 m away: one whose mesh moves with the footing,
and one whose mesh begins 200 m before the footing. In the latter the footing is mirrored, with its plane of symmetry at the upper
side of the mesh, and a smooth rigid bank stands where the far side was.
"""

from mpm_regression.checks.footing import distance, mean
from mpm_regression.row import Row

DECK = "regression/cases/footing/coarse.opts"
PRECISIONS = ("double",)  # but for the runs that say otherwise
LONG = True
FULL = " -mesh_lower -3,0 -soil_lower -3,0 -plate_lower -0.5,4"
AWAY = (" -mesh_lower 200,0 -mesh_upper 203,4.45 -soil_lower 200,0 -soil_upper 203,4"
        " -plate_lower 200,4 -plate_upper 200.5,4.05")
MIRROR = (" -precision single -mesh_upper 0,4.45 -soil_lower -3,0 -soil_upper 0,4 -plate_lower -0.5,4 -plate_upper 0,4.05"
          " -rigid_bodies plate,bank -bank_shape box -bank_lower -3.2,0 -bank_upper -3,4.45")
STRATEGIES = ("atomic", "mosaic", "gather", "tile")
RUNS = {
    "half": "-p2g sequential",
    "full": FULL,
    "single": "-precision single",
    "single_away": "-precision single" + AWAY,
    "mirrored": MIRROR + " -mesh_lower -3.2,0",
    "mirrored_away": MIRROR + " -mesh_lower -203.2,0",
    **{how: f"-p2g {how}" for how in STRATEGIES},
}


def check(runs):
    def same(name, other, allowed, what):
        return Row(f"{what}: largest difference of Nc in windows", distance(runs[name], runs[other]), 0, allowed, other)

    yield same("full", "half", 1e-3, "whole footing")
    yield Row("single: mean Nc over that of double", mean(runs["single"]) / mean(runs["half"]), 1, 0.01, "double")
    yield same("single_away", "single", 1e-3, "single, mesh and footing 200 m away")
    yield same("mirrored_away", "mirrored", 1e-3, "single, mesh begins 200 m away")
    for how in STRATEGIES:
        yield same(how, "half", 1e-3, how)
