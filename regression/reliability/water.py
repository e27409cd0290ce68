#!/usr/bin/env python3
"""Soil under water that collapses, slides and strikes: every run reaches its end, and every kilogram is accounted for.

    water.py MPM [--count 60] [--seed 1] [--only K,...] [--jobs 2] [--keep FOLDER] [--precisions double,single]

The random decks of collapses.py, with a level of water anywhere from below the mesh to above it, laws of total and of
effective stress, drained and undrained. What must hold is what collapses.py
demands of a run; water gives no more energy than it carries of soil that rises.
"""
import random
import sys

sys.dont_write_bytecode = True
import collapse_decks  # noqa: E402
import collapses  # noqa: E402
from collapse_decks import random_deck  # noqa: E402

LIGHTEST = 1100.0  # kg/m3: lighter soil rises, and gains energy from the water
UP = 2.0           # of the stiffness of the pore water over Young's modulus, at most


def frictional(o, dice):
    """In place of the clay's strength, a cohesion and friction."""
    model = dice.choice(["mohr_coulomb", "drucker_prager"])
    for key in [key for key in o if key.startswith("clay_su")]:
        del o[key]
    o.update(clay_model=model, clay_cohesion=round(dice.uniform(10, 2000), 3), clay_friction_deg=round(dice.uniform(5, 45), 3))
    o["clay_dilation_deg"] = round(dice.uniform(0, 0.5) * o["clay_friction_deg"], 3)
    if model == "drucker_prager":
        o["clay_match"] = dice.choice(["compression", "extension", "plane_strain"])


def grains(o, dice):
    for key in [key for key in o if key.startswith("clay_su")]:
        del o[key]
    o.update(clay_model="mu_i", clay_mu_static=0.38, clay_mu_dynamic=0.64, clay_inertial_number=0.279,
             clay_grain_diameter=round(dice.uniform(1e-4, 5e-3), 6), clay_grain_density=2600)


def submerged_deck(seed, k):
    """The k-th random deck of a seed, under water."""
    deck, dice = random_deck(seed, k), random.Random(f"water {seed} {k}")
    o = deck.options
    o["clay_density"] = max(o["clay_density"], LIGHTEST)
    law = dice.choice(["clay", "clay", "frictional", "frictional", "grains"])
    if law == "frictional":
        frictional(o, dice)
    elif law == "grains":
        grains(o, dice)
    undrained = dice.random() < 0.5
    if undrained:
        o["clay_pore_stiffness"] = float(f"{o['clay_young'] * dice.uniform(0.1, UP):.4g}")
    gravity = [float(x) for x in deck.value("gravity").split(",")]
    size = sum(x * x for x in gravity) ** 0.5
    where = "dry"
    if size > 0:
        lower, upper = deck.mesh()
        share = dice.uniform(-0.1, 1.3)
        place = [a + share * (b - a) for a, b in zip(lower, upper)]
        deck.lift = 1000 / o["clay_density"]
        o["water_level"] = (-sum(x * g for x, g in zip(place, gravity)) / size,)
        where = f"water to {share:.2f}"
    deck.name = f"{deck.name}, {o['clay_model']}, {'undrained' if undrained else 'drained'}, {where}"
    return deck


if __name__ == "__main__":
    collapses.__doc__ = __doc__
    collapse_decks.LEAST_SECONDS, collapse_decks.MOST_SECONDS = 0.1, 1.0  # a deck
    collapses.random_deck, collapses.named_decks = submerged_deck, lambda: []
    sys.exit(collapses.main())
