"""Soil under water that collapses, slides and strikes, and level ground: every run reaches its end, and its water is right.

Every second deck is one of collapses.py, with a level of water anywhere from below the mesh to above it, and a law of total or of
effective stress, drained or undrained. The others are level ground in up to three layers, drained and undrained, at rest or under a
plate (water_decks.py). Beside what collapses.py demands of a run (water gives no more energy than it carries of soil that rises):

- the pore pressure of each particle is that of its depth below the level, and its excess pore pressure, which is none in
  drained soil;
- the total stress and the pore pressure together are an effective stress that the law bears;
- at rest nothing moves, no excess pore pressure comes up, and the base carries the buoyant weight;
- in double precision ground under a plate is the same as on one core by the strategy `sequential`, up to round-off.
"""
import math

import h5py
import numpy as np

from collapses import Collapses
from deck import Machine
from mpm_regression.folders import frames, history
from water_decks import EXCESS, PRESSURE, SERIAL, STILL, YIELD, beyond_yield, ground_options

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


class Water(Collapses):
    seconds = (0.1, 1.0)
    ranks = (1, 1, 1, 1, 2, 2, 3, 4)
    precisions = ("double", "double", "single")
    restarts = 0.2
    frame_options = ["-output_frames", "on"]

    @classmethod
    def names(cls, given):
        return []

    def draw_deck(self):
        if self.key % 2 == 0:
            return self.submerge()
        self.deck = ground_options(self.draw, [dim for dim in (2, 2, 3) if str(dim) in self.given.dims])
        self.deck.ground.write(self.folder / "start.h5")
        self.deck.options.update({name: self.folder / "start.h5" for name in self.deck.options if name.endswith("_file")})

    def submerge(self):
        """Soil that flows, under water."""
        self.deck, dice = self.random_options(), self.draw
        o = self.deck.options
        o["clay_density"] = max(o["clay_density"], LIGHTEST)
        law = dice.choice(["clay", "clay", "frictional", "frictional", "grains"])
        if law == "frictional":
            frictional(o, dice)
        elif law == "grains":
            grains(o, dice)
        undrained, where = dice.random() < 0.5, "dry"
        if undrained:
            o["clay_pore_stiffness"] = float(f"{o['clay_young'] * dice.uniform(0.1, UP):.4g}")
        gravity = self.gravity()
        size = np.linalg.norm(gravity)
        if size > 0:
            share = dice.uniform(-0.1, 1.3)
            place = [a + share * (b - a) for a, b in zip(*self.deck.mesh())]
            self.deck.lift = 1000 / o["clay_density"]
            o["water_level"] = (-float(np.dot(place, gravity)) / size,)
            where = f"water to {share:.2f}"
        self.deck.name += f", {o['clay_model']}, {'undrained' if undrained else 'drained'}, {where}"
        o["output_interval"] = o["time_end"]

    def gravity(self):
        return np.array([float(x) for x in self.deck.value("gravity").split(",")])

    def law_of(self, body):
        """The options of a body's material, without its name."""
        material = self.deck.options[f"{body}_material"]
        return {name[len(material) + 1:]: value for name, value in self.deck.options.items() if name.startswith(material + "_")}

    def last_frame(self, folder):
        """{body: {field: array}} of soil in the last frame."""
        with h5py.File(frames(folder)[-1]) as file:
            found = {body: {name: values[()].astype(float) for name, values in file[body].items()} for body in self.deck.bodies()}
        return {body: fields for body, fields in found.items() if len(fields["position"])}

    def faults(self, folder):
        yield from super().faults(folder)
        soil = self.last_frame(folder)
        for body, fields in soil.items():
            yield from self.pressure_faults(body, fields)
        if self.deck.ground and self.deck.ground.kind == "rest":
            yield from self.rest_faults(soil, history(folder))

    def compare(self, whole):
        if self.deck.ground and self.deck.ground.kind == "plate" and self.exact:
            serial = self.go("serial", machine=Machine("serial", "sequential"))
            faults = list(self.serial_faults(self.last_frame(whole), self.last_frame(serial)))
            assert not faults, "\n".join(faults)

    def pressure_faults(self, body, fields):
        """Pore pressure, and effective stress."""
        law, gravity, position = self.law_of(body), self.gravity(), fields["position"]
        density, g = self.deck.options.get("water_density", 1000.0), np.linalg.norm(gravity)
        excess = fields.get("excess_pore_pressure", np.zeros(len(position)))
        right = excess
        if "water_level" in self.deck.options:
            depth = float(self.deck.value("water_level")) + position[:, :self.dim] @ gravity / g
            right = excess + density * g * np.maximum(0, depth)
        pore = fields.get("pore_pressure", excess)
        size = np.abs(fields["stress"][:, :3]).max(axis=1) + np.abs(right) + density * g * float(self.deck.value("mesh_spacing")) + 1e-9
        error = np.abs(pore - right) / size
        if not error.max() <= PRESSURE[self.precision]:
            yield f"pore pressure of {body} is off by {error.max():.2g} of the stress"
        if not float(law.get("pore_stiffness", 0)) and excess.any():
            yield f"drained soil of {body} has an excess pore pressure of {np.abs(excess).max():.3g} Pa"
        effective = fields["stress"].copy()
        effective[:, :3] += pore[:, None]
        beyond = beyond_yield(law, effective, fields)
        if beyond is None:
            return
        slack = YIELD[self.precision] + PRESSURE[self.precision] * size / (np.abs(effective).max(axis=1) + 1e-3 * size)
        if not (beyond <= slack).all():
            yield f"effective stress of {body} is beyond the yield condition of {law['model']} by {(beyond - slack).max():.2g}"

    def rest_faults(self, soil, values):
        """Nothing moves, and the water is hydrostatic."""
        ground = self.deck.ground
        speed = max(np.abs(fields["velocity"]).max() for fields in soil.values()) / ground.wave
        if not speed <= STILL[self.precision]:
            yield f"ground at rest moves with {speed:.2g} of the speed of its waves"
        scale = max(np.abs(fields["stress"]).max() for fields in soil.values())
        excess = max(np.abs(fields.get("excess_pore_pressure", np.zeros(1))).max() for fields in soil.values()) / scale
        if not excess <= EXCESS[self.precision]:
            yield f"ground at rest has an excess pore pressure of {excess:.2g} of the stress"
        area = math.prod([ground.wide * ground.cell, ground.across * ground.cell][:self.dim - 1])
        force = -values[f"wall_{self.up}min_force_{self.up}"][-1] / (ground.rows()[-1] * area)
        if not abs(force - 1) <= max(1e-10, STILL[self.precision]):
            yield f"the base carries {force:.15g} of the buoyant weight"

    def serial_faults(self, found, wanted):
        """The run on one core by the strategy `sequential` gives the same fields."""
        ground = self.deck.ground
        elastic = all(each.law["model"] == "linear_elastic" for each in ground.layers)
        bound = SERIAL["elastic" if elastic else "plastic"]
        stress = max(np.abs(fields["stress"]).max() for fields in wanted.values())
        for body in wanted:
            for name, scale in (("position", ground.cell), ("stress", stress), ("pore_pressure", stress),
                                ("velocity", stress / (2000 * ground.wave))):
                apart = np.abs(found[body][name] - wanted[body][name]).max() / scale
                if not apart <= bound:
                    yield f"{name} of {body} differs from that of one core by {apart:.2g}"
