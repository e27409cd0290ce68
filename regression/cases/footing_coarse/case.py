"""The strip footing with cells of B/20, half of it, smooth, to 0.2 B."""

from footing_checks import against_reference

RUNS = {"double": "-options_file inputs/footing_coarse.opts"}


def check(runs):
    yield from against_reference(runs["double"], spacing=0.05, allowed=0.15)
