"""Saturated soil in whose pores water flows: layers of random porosity and permeability, loads, sides, laws.

A deck is a box of one to three layers, as wide as the mesh or with a free flank, with permeabilities over eight decades, water of 3 to
100 times the stiffness of the soil, sides that are open or closed to the water, some with friction, and one of: a load on its top, a load
of water, a plate that is driven or falls, with friction or permeable, a wave (`wave`: elastic soil that begins with velocities and
pressures). Some are submerged.

- The water of each body, and what has left it, add up to what it had.
- Grains keep their volume, and the mass is that of the grains and the water in the pores.
- Where nothing is open, no water leaves.
- A wave loses energy, that of the flux included, and gains none.
"""
import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.folders import frames, history, rows

CELL, WATER = 0.1, 1000.0  # m, kg/m3
STRENGTHS = {"linear_elastic": {}, "mohr_coulomb": {"cohesion": (1e3, 1e4), "friction_deg": (20, 40)},
             "drucker_prager": {"cohesion": (1e3, 1e4), "friction_deg": (20, 35)}}
NEVER = 1e12  # Pa, tension that water does not come to
KEPT, SHARED = 1e-3, 1e-2  # of the water that moves: missing from all layers, from one
GAIN = 0.02  # of the largest energy of a wave: kinetic and stored energy are half a step apart


class PoreFlow(Deck):
    dims = (2, 2, 2, 3)
    ranks = (1, 1, 1, 2, 3)
    precisions = ("double", "double", "single")
    several, others = 0.3, 0.3

    def make(self):
        draw, dim = self.draw, self.dim
        self.kind = draw.choice(["wave", "load", "pond", "driven", "falling"])
        self.flank = self.kind != "wave" and draw.random() < 0.25
        wide, high = (draw.randint(2, 6), draw.randint(4, 10)) if dim == 2 else (draw.randint(2, 3), draw.randint(3, 5))
        self.size = np.array([wide * CELL, *([2 * CELL] if dim == 3 else []), high * CELL])
        self.full = self.kind == "wave" and draw.random() < 0.5  # the soil fills the mesh
        self.level = draw.random() < 0.3
        upper = self.size + np.array([4 * CELL if self.flank else 0, *([0] if dim == 3 else []), 0 if self.full else 4 * CELL])
        self.layers = self.draw_layers(high)
        self.options = ["-dim", dim, "-mesh_lower", vector([0] * dim), "-mesh_upper", vector(upper), "-mesh_spacing", CELL,
                        "-history_interval", 1e-9, "-output_frames", "on", *self.soil_options(), *self.side_options(), *self.run_options()]
        self.options += getattr(self, f"{'load' if self.kind == 'pond' else 'plate' if self.kind in ('driven', 'falling') else self.kind}_options")()
        self.options = [str(word) for word in self.options]

    def __str__(self):
        return f"{self.kind}, {len(self.layers)} layers, {super().__str__()}"

    def draw_layers(self, high):
        draw, count = self.draw, self.draw.randint(1, 3)
        cuts = [0, *sorted(draw.sample(range(1, high), count - 1)), high]
        young, ratio = 10 ** draw.uniform(5.5, 8), 10 ** draw.uniform(0.5, 2)
        layers = []
        for k, (low, top) in enumerate(zip(cuts, cuts[1:])):
            poisson, law = draw.uniform(0, 0.4), "linear_elastic" if self.kind == "wave" else draw.choice(list(STRENGTHS))
            own = young * draw.uniform(0.3, 1)
            layers.append({"name": f"layer{k}", "low": low * CELL, "top": top * CELL, "law": law, "young": own, "poisson": poisson,
                           "modulus": own * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)), "porosity": draw.uniform(0.15, 0.75),
                           "grains": draw.uniform(1800, 3200), "permeability": 10 ** draw.uniform(-8, 0)})
        self.stiffest = max(layer["modulus"] for layer in layers)
        self.bulk = ratio * self.stiffest * min(layer["porosity"] for layer in layers)
        stiffness = self.stiffest + self.bulk / min(layer["porosity"] for layer in layers)
        self.wave = np.sqrt(stiffness / min((1 - layer["porosity"]) * layer["grains"] + layer["porosity"] * WATER for layer in layers))
        return layers

    def soil_options(self):
        draw, names = self.draw, [layer["name"] for layer in self.layers]
        words = ["-bodies", ",".join(names), "-materials", ",".join(f"m_{name}" for name in names), "-water_bulk_modulus", self.bulk,
                 "-water_density", WATER]
        per_cell = draw.choice([1, 2, 2, 3] if self.dim == 2 else [1, 2])
        for layer in self.layers:
            name, m = layer["name"], f"-m_{layer['name']}_"
            lower, upper = [0.0] * (self.dim - 1) + [layer["low"]], [*self.size[:-1], layer["top"]]
            words += [f"-{name}_shape", "box", f"-{name}_lower", vector(lower), f"-{name}_upper", vector(upper), f"-{name}_material", f"m_{name}",
                      f"-{name}_particles_per_cell", per_cell, m + "model", layer["law"], m + "young", layer["young"], m + "poisson", layer["poisson"],
                      m + "water", "saturated", m + "porosity", layer["porosity"], m + "grain_density", layer["grains"],
                      m + "permeability", layer["permeability"], m + "permeability_law", draw.choice(["constant", "kozeny"])]
            for key, (low, high) in STRENGTHS[layer["law"]].items():
                words += [m + key, draw.uniform(low, high)]
            words += [m + "match", "compression"] if layer["law"] == "drucker_prager" else []
            words += [f"-{name}_stress", vector([-1e4] * 3 + [0] * (1 if self.dim == 2 else 3))] if layer["law"] != "linear_elastic" else []
        return words

    def side_options(self):
        draw, words, self.open = self.draw, [], not self.full
        for axis in self.axes:
            for end in ("min", "max"):
                side = f"-mesh_{axis}{end}"
                if axis == self.up and end == "max" and not self.full or axis == "x" and end == "max" and self.flank:
                    words += [side, "free"]
                    continue
                water = draw.choice(["closed", "closed", "open"])
                self.open |= water == "open"
                kind = draw.choice(["roller", "roller", "fixed", "smooth", "friction"])
                words += [side, kind, side + "_water", water, *([side + "_friction", draw.uniform(0.1, 0.8)] if kind == "friction" else [])]
        return words

    def run_options(self):
        draw, steps = self.draw, self.draw.randint(60, 200)
        self.tension = NEVER if self.kind == "wave" else draw.choice([0, 1e5, NEVER, NEVER, NEVER])
        update = draw.choice(["flip", "flip", "pic", "xpic", "apic"]) if self.kind != "wave" else "flip"
        end = steps * 0.4 * CELL / self.wave
        words = ["-velocity_update", update, "-particle_domain", draw.choice(["fixed", "fixed", "stretch"]),
                 "-f_bar_fraction", draw.choice([0, 0.98, 0.98]), "-time_courant", draw.choice([0.2, 0.3, 0.4]) if self.kind != "wave" else 0.2,
                 "-time_end", end, "-output_interval", end / 8, "-damping", draw.choice([0, 0, 0.05]) if self.kind != "wave" else 0,
                 "-water_tension", self.tension]
        self.end = end
        if self.level or self.kind != "wave" and draw.random() < 0.4:
            words += ["-gravity", vector([0] * (self.dim - 1) + [-9.81])]
        words += ["-water_level", self.size[-1] + draw.choice([1.0, 20.0])] if self.level else []
        return words

    def face_of_top(self):
        return vector([0] * (self.dim - 1) + [self.size[-1] - 0.01]), vector([*self.size[:-1], self.size[-1] + 0.01])

    def load_options(self):
        lower, upper = self.face_of_top()
        pressure = self.stiffest * 10 ** self.draw.uniform(-4, -2)
        words = ["-loads", "top", "-top_body", self.layers[-1]["name"], "-top_lower", lower, "-top_upper", upper, "-top_pressure", pressure]
        return words + (["-top_on_pores", "on"] if self.kind == "pond" else [])

    def plate_options(self):
        low, high = [0.0] * (self.dim - 1) + [self.size[-1]], [*self.size[:-1], self.size[-1] + 2 * CELL]
        words = ["-rigid_bodies", "plate", "-plate_shape", "box", "-plate_lower", vector(low), "-plate_upper", vector(high)]
        words += ["-plate_friction", self.draw.uniform(0.1, 0.8)] if self.draw.random() < 0.4 else []
        words += ["-plate_permeable", "on"] if self.draw.random() < 0.3 else []
        down = vector([0] * (self.dim - 1) + [-0.02 * self.size[-1] / self.end])
        if self.kind == "driven":
            return [*words, "-plate_motion", "prescribed", "-plate_velocity", down]
        return [*words, "-plate_motion", "dynamic", "-plate_density", self.draw.uniform(300, 5000), "-plate_velocity", vector([0] * (self.dim - 1) + [-0.1])]

    def wave_options(self):
        words = []
        for layer in self.layers:
            speed = [self.wave * self.draw.uniform(-1e-3, 1e-3) for _ in range(self.dim)]
            words += [f"-{layer['name']}_velocity", vector(speed)]
            if not self.level:
                words += [f"-{layer['name']}_pore_pressure", self.stiffest * self.draw.uniform(-1e-3, 1e-3)]
        return words

    # ------------------------------------------------------------------------------------------ checks

    def check(self, folder):
        h, steps = history(folder), int(rows(folder)[-1][0])
        read = [self.soil_of(path) for path in frames(folder)]
        found = [self.check_water(layer, h, read, steps) for layer in self.layers]
        if self.tension == NEVER and not any(h[f"{layer['name']}_lost_mass"].max() > 0 for layer in self.layers):
            for layer, (error, moved, round_off) in zip(self.layers, found):  # a cell has one strain for the water of all bodies in it
                self.check_balance(layer["name"], error, moved, SHARED, round_off)
            self.check_balance("all layers", *map(sum, zip(*((each[0], each[1]) for each in found))), KEPT, sum(each[2] for each in found))
        if not self.open:
            left = sum(h[f"{layer['name']}_outflow"] for layer in self.layers)
            self.check_balance("the closed box", left, sum(each[1] for each in found), KEPT, sum(each[2] for each in found))
        if self.kind == "wave":
            self.check_energy(read)

    def check_balance(self, name, error, moved, share, round_off):
        error = np.abs(error).max()
        self.note(f"water of {'all layers' if name == 'all layers' else 'a layer'} that is missing over what moved, {self.precision}", error / moved)
        assert error <= share * moved + round_off, f"{error:.3g} m3 of the water of {name} are missing; {moved:.3g} moved or gave way"

    def soil_of(self, path):
        with h5py.File(path) as file:
            return {layer["name"]: {name: item[()].astype(float) for name, item in file[layer["name"]].items()} for layer in self.layers}

    def check_water(self, layer, h, read, steps):
        """Water and grains of a layer. Returns the error of its water, what moved or gave way, and its slack for round-off, m3."""
        name = layer["name"]
        water, left, first, last = h[f"{name}_water"], h[f"{name}_outflow"], read[0][name], read[-1][name]
        lost = h[f"{name}_lost_mass"].max() > 0 or h[f"{name}_strays"].max() > 0
        pressed = max(np.abs(each[name]["excess_pore_pressure"]).max() for each in read) / self.bulk
        moved = np.abs(water - water[0]).max() + np.abs(left).max() + pressed * water[0]
        # Volumes of particles round off in each step, and always in one direction where they change little.
        round_off = self.bound(1e-15, 1e-7) * steps * sum(first["volume"])
        for each in (first, last):
            mass = layer["grains"] * each["solid_volume"] + WATER * (each["volume"] - each["solid_volume"])
            assert np.allclose(each["mass"], mass, rtol=self.bound(1e-6, 2e-6)), f"the mass of {name} is not that of grains and water"
            assert np.allclose(each["porosity"], 1 - each["solid_volume"] / each["volume"], atol=2e-6), f"porosity of {name}"
        if not lost:
            solid = [each["solid_volume"].sum() for each in (first, last)]
            assert abs(solid[1] / solid[0] - 1) <= 1e-6, f"the grains of {name} have changed by {solid[1] / solid[0] - 1:.3g}"
        return (water + left - water[0]) * (not lost), moved, round_off

    def check_energy(self, read):
        """No energy comes from nothing; PIC of the flux and drag take some."""
        energy = [sum(self.energy(layer, each[layer["name"]]) for layer in self.layers) for each in read]
        gained = max(energy) / energy[0] - 1
        self.note(f"energy gained, {self.precision}", gained)
        assert gained <= GAIN, f"the energy grows by {gained:.3g}: {energy}"

    def energy(self, layer, soil):
        """J: motion of grains and water, strain of soil and water, and height of the grains above that of the water."""
        volume, n = soil["volume"], soil["porosity"]
        v, w = soil["velocity"], soil["darcy_flux"]
        motion = soil["mass"] * (v * v).sum(1) / 2 + WATER * volume * (v * w).sum(1) + WATER * volume / n * (w * w).sum(1) / 2
        s = soil["stress"].copy()
        s[:, :3] += soil["pore_pressure"][:, None]
        nu = layer["poisson"]
        strain = ((1 + nu) * ((s[:, :3] ** 2).sum(1) + 2 * (s[:, 3:] ** 2).sum(1)) - nu * s[:, :3].sum(1) ** 2) / (2 * layer["young"])
        water = n * soil["excess_pore_pressure"] ** 2 / (2 * self.bulk)
        height = 9.81 * (layer["grains"] - WATER) * soil["solid_volume"] * soil["position"][:, self.dim - 1] if self.level else 0
        base = 9.81 * (layer["grains"] - WATER) * soil["solid_volume"] * layer["low"] if self.level else 0
        return float((motion + volume * (strain + water) + height - base).sum())
