"""The strip footing of Dong, Wang & Randolph (2015) with cells of B/40: 76,800 particles, 33,334 steps."""

from footing_checks import against_reference, distance, mean
from row import Row

DECK = "-options_file inputs/footing.opts"
RUNS = {"double": DECK, "single": DECK + " -precision single"}


def check(runs):
    yield from against_reference(runs["double"], spacing=0.025, allowed=0.12)
    yield Row("single: mean Nc over that of double", mean(runs["single"]) / mean(runs["double"]), 1, 0.01, "double")
    yield Row("single: largest difference of Nc in windows", distance(runs["single"], runs["double"]), 0, 0.03, "double")
