"""The footing of footing_coarse in other clothes: the whole of it instead of half, in single precision, 200 m away,
and with every strategy. All must give the same curve."""

from footing_checks import distance, mean
from row import Row

DECK = "-options_file inputs/footing_coarse.opts"
FULL = " -mesh_lower -3,0 -soil_lower -3,0 -plate_lower -0.5,4"
AWAY = (" -mesh_lower 200,0 -mesh_upper 203,4.45 -soil_lower 200,0 -soil_upper 203,4"
        " -plate_lower 200,4 -plate_upper 200.5,4.05")
STRATEGIES = ("atomic", "mosaic", "gather", "tile")
RUNS = {
    "half": DECK + " -p2g sequential",
    "full": DECK + FULL,
    "single": DECK + " -precision single",
    "single_away": DECK + " -precision single" + AWAY,
    **{how: f"{DECK} -p2g {how}" for how in STRATEGIES},
}


def check(runs):
    def same(name, other, allowed, what):
        return Row(f"{what}: largest difference of Nc in windows", distance(runs[name], runs[other]), 0, allowed, other)

    yield same("full", "half", 1e-3, "whole footing")
    yield Row("single: mean Nc over that of double", mean(runs["single"]) / mean(runs["half"]), 1, 0.01, "double")
    yield same("single_away", "single", 1e-3, "single, 200 m away")
    for how in STRATEGIES:
        yield same(how, "half", 1e-3, how)
