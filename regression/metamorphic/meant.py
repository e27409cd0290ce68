"""Differences of a deck and an image that are meant, each with its reason."""
import re


def moving_sides_meet(deck):
    """Whether sides across two axes move."""
    sides = [name for name in deck if name.startswith("mesh_") and name.endswith(("_velocity", "_velocity_table", "_acceleration_table"))]
    return len({name[5] for name in sides}) > 1


# (image, condition on the deck, columns and fields, the most that is meant, reason)
MEANT = [
    ("turn", lambda deck: moving_sides_meet(deck), ".*", float("inf"),
     "of two sides that move and prescribe the same component of a velocity, that of the last axis prevails"),
    (".*", lambda deck: "loads" in deck, ".*", 1e-6,
     "weights on a face are those of a box of 1e-12 cells, which have fewer digits, and so have the forces and what they move"),
    ("restart_ranks", lambda deck: True, r"history (energy|work)_", 1e-12,
     "at a restart rank 0 goes on with the works of all ranks, which are then summed in another order"),
    ("units", lambda deck: {"power_elastic", "cam_clay", "yield_stress_fluid"} & {str(value) for value in deck.values()}, ".*", 1e-9,
     "powers and logarithms have other round-off in other units"),
]


def is_meant(deck, image, share, where):
    """Whether a difference, relative to the field's largest value, is one that is meant."""
    return any(re.fullmatch(images, image) and condition(deck) and re.search(places, where) and share <= most
               for images, condition, places, most, _ in MEANT)
