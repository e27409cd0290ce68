#!/usr/bin/env python3
"""Soil under water that collapses, slides and strikes, and level ground: every run reaches its end, and its water is right.

    water.py MPM [--count 60] [--seed 1] [--only K,...] [--jobs 2] [--keep FOLDER] [--precisions double,single] [--limit 300]

Of the random decks every second is one of collapses.py, with a level of water anywhere from below the mesh to above it, and a
law of total or of effective stress, drained or undrained. The others are level ground in up to three layers, drained and
undrained, at rest or under a plate (water_decks.py). All kinds have all strategies, back ends, velocity updates, and one to
four ranks. Beside what collapses.py demands of a run (water gives no more energy than it carries of soil that rises):

- the pore pressure of each particle is that of its depth below the level, and its excess pore pressure, which is none in
  drained soil;
- the total stress and the pore pressure together are an effective stress that the law bears;
- at rest nothing moves, no excess pore pressure comes up, and the base carries the buoyant weight;
- in double precision ground under a plate is the same as on one core by the strategy `sequential`, up to round-off.
"""
import copy
import math
import random
import sys

import h5py
import numpy as np

sys.dont_write_bytecode = True
import collapse_decks  # noqa: E402
import collapses  # noqa: E402
from collapse_decks import random_deck  # noqa: E402
from folders import frames  # noqa: E402
from water_decks import EXCESS, PRESSURE, SERIAL, STILL, YIELD, beyond_yield, ground_deck  # noqa: E402

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
    deck.frames = True
    o["output_interval"] = o["time_end"]
    return deck


def water_deck(seed, k):
    """The k-th random deck of a seed: soil that flows, or level ground."""
    return ground_deck(seed, k) if k % 2 else submerged_deck(seed, k)


# ---------------------------------------------------------------------------------------------- what must hold


def last_frame(folder):
    """{body: {field: array}} of the last frame of a run."""
    with h5py.File(frames(folder / "out")[-1]) as file:
        return {body: {name: values[()].astype(float) for name, values in group.items()} for body, group in file.items()}


def law_of(deck, body):
    """The options of a body's material, without its name."""
    material = deck.options[f"{body}_material"]
    return {name[len(material) + 1:]: value for name, value in deck.options.items() if name.startswith(material + "_")}


def depth_of(deck, position):
    """Depths below the level of water [m]."""
    gravity = np.array([float(x) for x in deck.value("gravity").split(",")])
    return float(deck.value("water_level")) + position[:, :deck.dim] @ gravity / np.linalg.norm(gravity)


def pressure_faults(deck, body, fields):
    """Pore pressure, and effective stress."""
    precision, law = deck.options["precision"], law_of(deck, body)
    wet = "water_level" in deck.options
    excess = fields.get("excess_pore_pressure", np.zeros(len(fields["position"])))
    density, g = deck.options.get("water_density", 1000.0), np.linalg.norm([float(x) for x in deck.value("gravity").split(",")])
    right = excess + (density * g * np.maximum(0, depth_of(deck, fields["position"])) if wet else 0)
    pore = fields.get("pore_pressure", excess)
    size = np.abs(fields["stress"][:, :3]).max(axis=1) + np.abs(right) + density * g * float(deck.value("mesh_spacing")) + 1e-9
    error = np.abs(pore - right) / size
    if not error.max() <= PRESSURE[precision]:
        yield f"pore pressure of {body} is off by {error.max():.2g} of the stress"
    if not float(law.get("pore_stiffness", 0)) and excess.any():
        yield f"drained soil of {body} has an excess pore pressure of {np.abs(excess).max():.3g} Pa"
    effective = fields["stress"].copy()
    effective[:, :3] += pore[:, None]
    beyond = beyond_yield(law, effective, fields)
    if beyond is None:
        return
    slack = YIELD[precision] + PRESSURE[precision] * size / (np.abs(effective).max(axis=1) + 1e-3 * size)
    if not (beyond <= slack).all():
        yield f"effective stress of {body} is beyond the yield condition of {law['model']} by {(beyond - slack).max():.2g}"


def rest_faults(deck, found, folder):
    """Nothing moves, and the water is hydrostatic."""
    ground, precision = deck.ground, deck.options["precision"]
    weight = ground.rows()[-1]
    speed = max(np.abs(fields["velocity"]).max() for fields in found.values()) / ground.wave
    if not speed <= STILL[precision]:
        yield f"ground at rest moves with {speed:.2g} of the speed of its waves"
    scale = max(np.abs(fields["stress"]).max() for fields in found.values())
    excess = max(np.abs(fields.get("excess_pore_pressure", np.zeros(1))).max() for fields in found.values()) / scale
    if not excess <= EXCESS[precision]:
        yield f"ground at rest has an excess pore pressure of {excess:.2g} of the stress"
    axis = "xyz"[deck.dim - 1]
    history = collapses.read_history(folder / "out" / "history.csv")
    area = math.prod([ground.wide * ground.cell, ground.across * ground.cell][:deck.dim - 1])
    force = -history[f"wall_{axis}min_force_{axis}"][-1] / (weight * area)
    if not abs(force - 1) <= max(1e-10, STILL[precision]):
        yield f"the base carries {force:.15g} of the buoyant weight"


def serial_faults(program, deck, found, folder):
    """The same on one core by the strategy `sequential`."""
    alone = copy.deepcopy(deck)
    alone.ranks = alone.threads = 1
    alone.options.update(backend="serial", p2g="sequential")
    alone.options.pop("partition", None)
    status, stderr = collapses.launch(program, alone, folder / "serial")
    if status != 0:
        yield f"on one core: exit status {status}\n    {stderr.strip()}"
        return
    wanted = last_frame(folder / "serial")
    elastic = all(each.law["model"] == "linear_elastic" for each in deck.ground.layers)
    bound = SERIAL["elastic" if elastic else "plastic"]
    stress = max(np.abs(fields["stress"]).max() for body, fields in wanted.items() if body in deck.bodies())
    for body in deck.bodies():
        for name, scale in (("position", deck.ground.cell), ("stress", stress), ("pore_pressure", stress),
                            ("velocity", stress / (2000 * deck.ground.wave))):
            apart = np.abs(found[body][name] - wanted[body][name]).max() / scale
            if not apart <= bound:
                yield f"{name} of {body} differs from that of one core by {apart:.2g}"


def more_faults(program, deck, folder):
    found = last_frame(folder)
    soil = {body: found[body] for body in deck.bodies() if len(found[body]["position"])}
    faults = [fault for body, fields in soil.items() for fault in pressure_faults(deck, body, fields)]
    if deck.ground and deck.ground.kind == "rest":
        faults += rest_faults(deck, soil, folder)
    if deck.ground and deck.ground.kind == "plate" and deck.options["precision"] == "double":
        faults += serial_faults(program, deck, found, folder)
    return faults


if __name__ == "__main__":
    collapses.__doc__ = __doc__
    collapse_decks.LEAST_SECONDS, collapse_decks.MOST_SECONDS = 0.1, 1.0  # a deck
    collapses.random_deck, collapses.named_decks, collapses.more_faults = water_deck, lambda: [], more_faults
    sys.exit(collapses.main())
