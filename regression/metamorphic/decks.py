"""Random decks: a deck is {option without dash: number, word or tuple}, small enough for a run of a fraction of a second."""
import math

from flow import add_flow

E, NU, RHO = 5e5, 0.3, 1800.0  # Pa, -, kg/m3: what soils are near to
LAWS = {
    "linear_elastic": {"young": E, "poisson": NU}, "von_mises": {"young": E, "poisson": NU, "su": 3e3},
    "tresca": {"young": E, "poisson": 0.4, "su": 2e3}, "mohr_coulomb": {"young": E, "poisson": 0.25, "cohesion": 1e3, "friction_deg": 30.0},
    "drucker_prager": {"young": E, "poisson": NU, "cohesion": 500.0, "friction_deg": 25.0, "match": "plane_strain"},
    "mu_i": {"young": E, "poisson": NU, "mu_static": 0.4, "mu_dynamic": 0.7, "inertial_number": 0.3, "grain_diameter": 0.01, "grain_density": 2600.0},
    "newtonian": {"bulk_modulus": E, "viscosity": 30.0},
    "yield_stress_fluid": {"bulk_modulus": E, "shear_modulus": 1e5, "yield_stress": 300.0, "consistency": 20.0, "exponent": 1.0},
    "power_elastic": {"bulk_modulus": E, "pressure_reference": 1e4, "exponent": 0.5, "pressure_min": 1e3, "poisson": NU},
    "j2_hardening": {"young": E, "poisson": NU, "yield_stress": 5e3, "hardening_modulus": 1e5},
    "cam_clay": {"critical_state_ratio": 1.0, "lambda": 0.1, "kappa": 0.01, "poisson": NU, "specific_volume": 2.0, "ocr": 1.5},
    "softening_clay": {"young": E, "poisson": 0.4, "su": 3e3, "remoulded_ratio": 0.3, "xi95": 2.0},
}
MORE = {  # options that a law may have beside
    "von_mises": {"su_gradient": 1e3}, "tresca": {"su_gradient": 1e3, "tension": 500.0}, "mohr_coulomb": {"dilation_deg": 5.0, "tension": 200.0},
    "drucker_prager": {"dilation_deg": 5.0, "cohesion_gradient": 500.0}, "linear_elastic": {"young_gradient": 1e5},
    "softening_clay": {"rate_factor": 0.1, "rate_reference": 0.01, "rate_time": 0.01, "xi95_cell": 0.2, "surface": "tresca"},
    "yield_stress_fluid": {"exponent": 0.5}, "cam_clay": {"pressure_min": 500.0},
}
STRENGTH = {"von_mises", "tresca", "softening_clay"}  # laws whose strength is an su
SIDES = tuple(f"mesh_{axis}{end}" for axis in "xyz" for end in ("min", "max"))
OFFSETS = (0.11, 0.2, 0.29, 0.37, 0.43, 0.61, 0.71, 0.87)  # cells; a cell owns particles on its lower faces, its mirror image does not
FLUIDS = {"newtonian", "yield_stress_fluid"}  # without Poisson's ratio
DIVIDED = STRENGTH | {"mohr_coulomb", "drucker_prager"}  # laws with a strength_factor
FEATURES = ("rayleigh", "accelerations", "strength", "water", "smooth", "analysis", "pairs", "flow")  # that a run can ask for in every deck
ASKED = {"flow"}  # of them those that a deck has only then
EFFECTIVE = {"linear_elastic", "mohr_coulomb", "drucker_prager", "cam_clay", "power_elastic"}  # laws in whose pores water may flow


class Maker:
    """Draws one deck. Lengths in cells until `scaled`; `ground` is the height of the soil at the bottom."""

    def __init__(self, draw, dim, precision, wanted=()):
        self.draw, self.dim, self.up = draw, dim, dim - 1
        self.has = {name: name in wanted or name not in ASKED and draw.random() < 0.15 for name in FEATURES}
        if self.has["flow"]:
            self.has.update(rayleigh=False, strength=False, pairs=False, accelerations=False)
        self.axisymmetric = dim == 2 and draw.random() < 0.2 and "accelerations" not in wanted  # whose sides do not move
        self.deck = {"dim": dim, "precision": precision, "backend": "serial", "progress": "off"}
        self.h = draw.choice([0.25, 0.25, 0.1, 0.3])
        self.steps = draw.randint(10, 50) if dim == 2 else draw.randint(8, 25)
        if precision == "single":
            self.steps = min(self.steps, 20)
        self.cells = [16, 8] if dim == 2 else [8, 3, 7]  # two patches along x, for ranks
        self.speed = 0.02 * math.sqrt(E / RHO)

    def some(self, share):
        return self.draw.random() < share

    def near(self, x):
        """A length of about x cells [m], on a line of the mesh or where a lattice that begins there has no particle on a line."""
        return round((math.floor(x) + (0 if self.some(0.4) else self.draw.choice(OFFSETS))) * self.h, 4)

    def vector(self, size):
        out = [round(self.draw.uniform(-size, size), 4) for _ in range(self.dim)]
        return tuple([0.0, *out[1:]] if self.axisymmetric else out)

    def down(self, size):
        return tuple([0.0] * self.up + [-round(size, 4)])

    def make(self):
        d, draw = self.deck, self.draw
        if self.axisymmetric:
            d["geometry"] = "axisymmetric"
        d.update(mesh_lower=(0.0,) * self.dim, mesh_upper=tuple(n * self.h for n in self.cells), mesh_spacing=self.h)
        gravity = "down" if self.has["water"] else draw.choice(["down", "down", "any", "none"])
        if gravity != "none":
            d["gravity"] = self.down(9.81) if gravity == "down" or self.axisymmetric else tuple(draw.choice([-9.0, -3.0, 2.0, 6.0]) for _ in range(self.dim))
        self.water = self.has["water"]
        self.materials(draw.choice([1, 2]))
        self.numerics()
        self.bodies()
        if self.has["pairs"]:
            self.pairs()
        if self.some(0.6):
            self.rigid()
        self.sides()
        if self.some(0.25):
            self.load()
        if self.some(0.3):
            self.probes()
        if self.has["flow"]:
            add_flow(self, SIDES, E)
        elif self.water and self.some(0.5):
            self.water_region()
        self.timing()
        if self.has["rayleigh"]:
            self.rayleigh()
        if self.has["accelerations"] and not self.axisymmetric:
            self.accelerations()
        if self.some(0.5 if self.has["water"] or self.has["strength"] else 0.15):
            self.stages()
        return d

    def stages(self):
        """Two stages in the place of one, of which the second has other loads."""
        d = self.deck
        d.update(stages="first,second", time_end=d["time_end"] / 2, second_damping=0.2)
        if "gravity" in d and not self.water:
            d["second_gravity"] = tuple(0.5 * x for x in d["gravity"])
        if self.water and not self.has["flow"] and self.some(0.7):
            d["second_water_level"] = self.near(1.5)
        if "water_regions" in d and self.some(0.5):
            d["second_pit_water_level"] = self.draw.choice(["dry", self.near(1.0)])
        if d.get("rayleigh_ratio") and self.some(0.3):
            d["second_rayleigh_ratio"] = 0.0
        if self.has["strength"] and self.some(0.6):
            d["second_strength_factor"] = 1.5
        if self.has["pairs"] and "weld" not in d.values() and self.some(0.7):
            d[f"second_{d['contact_pairs'].replace(':', '_')}_friction"] = self.draw.choice([0.0, 0.2, 1.0])

    def water_region(self):
        """A box whose water has a level of its own; no body that floats may be in it."""
        d, wide = self.deck, self.deck["mesh_upper"]
        if d.get("tool_motion") == "dynamic":
            return
        middle = tuple(0.0 if self.axisymmetric else self.near(n / 3) for n in self.cells[:self.up])
        d.update(water_regions="pit", pit_lower=(*middle, 0.0), pit_upper=wide)
        if self.some(0.8):
            d["pit_water_level"] = self.draw.choice(["dry", self.near(1.2), self.near(3.1)])

    def rayleigh(self):
        """Damping of frequencies that the mesh has, whose stiffness shortens the stable step a little."""
        d, step = self.deck, self.step
        moves = self.has["accelerations"] or any(name.startswith("mesh_") and name.endswith("_velocity") for name in d)
        parts = self.draw.choice(["stiffness"] if moves else ["both", "both", "stiffness", "mass"])
        high, low = float(f"{0.1 / step:.4g}"), float(f"{0.02 / step:.4g}")
        d.update(rayleigh_ratio=self.draw.choice([0.02, 0.1]), rayleigh_frequencies=(low, high) if parts == "both" else high)
        if parts != "both" or self.some(0.3):
            d["rayleigh_parts"] = parts

    def accelerations(self):
        """Records of accelerations at one or two sides, in components or as factors."""
        d, draw = self.deck, self.draw
        sides = [name for name, kind in d.items() if name in SIDES and kind in ("roller", "fixed", "friction", "smooth", "absorbing")]
        for side in draw.sample(sides, min(len(sides), draw.choice([1, 1, 2]))):
            d.pop(f"{side}_velocity", None)
            axis = "xyz".index(side[5])
            moves = [k == axis or d[side] != "roller" for k in range(self.dim)]
            length = d["time_end"] * draw.choice([1.0, 1.0, 1.3])
            size = 0.3 * self.speed / d["time_end"]
            times = [float(f"{x * length:.5g}") for x in (0.0, 0.21, 0.5, 0.83, 1.0)]
            times[-1] = max(times[-1], d["time_end"])
            if self.some(0.4):
                d[f"{side}_acceleration"] = tuple(float(f"{draw.uniform(-size, size):.4g}") if m else 0.0 for m in moves)
                rows = [(t, round(draw.uniform(-1, 1), 3)) for t in times]
            else:
                rows = [(t, *(float(f"{draw.uniform(-size, size):.4g}") if m else 0.0 for m in moves)) for t in times]
            d[f"{side}_acceleration_table"] = ",".join(":".join(map(repr, row)) for row in rows)
            if self.some(0.6):
                d[f"{side}_acceleration_correction"] = draw.choice(["none", "quadratic", "linear"])
            if self.some(0.3):
                d[f"{side}_acceleration_table_interpolation"] = "smooth"

    def materials(self, count):
        names = ["clay", "sand"][:count]
        self.deck["materials"] = ",".join(names)
        self.laws = {}
        for name in names:
            law = self.draw.choice([law for law in LAWS if not (self.has["rayleigh"] and law in FLUIDS)
                                    and (law in DIVIDED or not self.has["strength"])
                                    and (law in EFFECTIVE or not self.has["flow"])])
            values = dict(LAWS[law])
            for key, value in MORE.get(law, {}).items():
                if self.some(0.3):
                    values[key] = value
                    if key.endswith("gradient"):
                        values[key.replace("gradient", "datum")] = round(3 * self.h, 4)
            if "rate_factor" in values:
                values["rate_reference"] = 0.01
            self.laws[name] = law
            self.deck.update({f"{name}_model": law, f"{name}_density": round(RHO * self.draw.uniform(0.8, 1.2))})
            self.deck.update({f"{name}_{key}": value for key, value in values.items()})
            if self.some(0.15) and law in ("linear_elastic", "mohr_coulomb", "cam_clay"):
                self.deck[f"{name}_pore_stiffness"] = 1e6
            if self.has["strength"] and law in DIVIDED and self.some(0.6):
                self.deck[f"{name}_strength_factor"] = self.draw.choice([0.8, 1.3])
            if self.has["strength"] and law in STRENGTH and self.some(0.7):
                self.deck[f"{name}_su_ratio"] = self.draw.choice([0.25, 0.4])
        if self.has["strength"] and self.some(0.7):
            self.deck["strength_factor"] = self.draw.choice([0.9, 1.25])

    def numerics(self):
        d, draw = self.deck, self.draw
        d["p2g"] = "gather"
        d["velocity_update"] = draw.choice(["flip", "flip", "pic", "xpic", "apic"])
        if d["velocity_update"] in ("flip", "xpic") and self.some(0.3):
            d["flip_fraction"] = draw.choice([0.9, 0.99])
        if self.some(0.3):
            d["damping"] = draw.choice([0.05, 0.3])
        d["particle_domain"] = draw.choice(["fixed", "fixed", "stretch"] if self.axisymmetric else ["fixed", "fixed", "stretch", "split"])
        if self.axisymmetric:
            d["particle_domain"] = "fixed"
        if self.some(0.2) and not self.axisymmetric:
            d["position_correction"] = "delta"
        if self.some(0.4):
            d["f_bar_fraction"] = draw.choice([0.0, 0.5, 0.95])
        if self.some(0.5):
            d["output_energy"] = "on"
        if self.some(0.3):
            d["rebuild_margin"] = 0.1
        if self.has["analysis"]:
            d["analysis"] = draw.choice(["flow", "flow", "penetration"])
            for name in ("velocity_update", "particle_domain", "position_correction"):
                if self.some(0.8):
                    d.pop(name, None)
            if "velocity_update" not in d:
                d.pop("flip_fraction", None)
        if self.water:
            d.update(water_level=self.near(2.5), water_density=1000.0)

    def bodies(self):
        """Soil at the bottom, in half of the decks as wide as the mesh, and in most decks a body on it or above it."""
        d, draw, dim, up = self.deck, self.draw, self.dim, self.up
        wide = d["mesh_upper"]
        self.level = self.near(draw.choice([2, 3]) if dim == 2 else 2)
        names, materials = ["ground"], list(self.laws)
        shape = draw.choice(["box", "box", "layer", "polygon"])
        d["ground_shape"] = shape
        if shape == "box":  # of whole cells: the lattice of a box begins at its lower corner
            self.level = round(max(1, round(self.level / self.h)) * self.h, 4)
            upper = [x if self.some(0.6) else x - draw.randint(1, 2) * self.h for x in wide[:up]] + [self.level]
            d.update(ground_lower=(0.0,) * dim, ground_upper=tuple(upper))
        elif shape == "layer":
            d.update(ground_top=self.level, ground_base=0.0)
        else:
            d["ground_polygon"] = (0.0, 0.0, wide[0], 0.0, wide[0], round(self.level * 0.7, 4), round(wide[0] / 2.1, 4), self.level, 0.0, self.level)
            if dim == 3:
                d["ground_width"] = (0.0, wide[1])
        if shape != "box" and self.some(0.7):
            d["ground_fill"] = "centre"
        if self.has["pairs"] or self.some(0.7):
            names.append("top")
            self.top_body(wide)
        for name in names:
            material = draw.choice(materials)
            d[f"{name}_material"] = material
            # One particle a cell is at the bound of what is alone.
            d[f"{name}_particles_per_cell"] = draw.choice([2, 2, 3]) if dim == 2 else 2
            if self.some(0.5):
                d[f"{name}_velocity"] = self.vector(self.speed)
            if self.laws[material] in ("cam_clay", "power_elastic") or f"{material}_su_ratio" in d or self.some(0.2):
                normal = -round(draw.uniform(5e3, 2e4), 1)
                d[f"{name}_stress"] = (normal, normal if self.some(0.5) else 0.8 * normal, normal) + (0.0,) * (1 if dim == 2 else 3)
        d["bodies"] = ",".join(names)

    def pairs(self):
        """The two bodies slide on each other, or are welded."""
        d, draw = self.deck, self.draw
        laws = [{}, {"friction": 0.4}, {"friction": 0.2, "adhesion": 500.0}, {"shear_limit": 800.0}, {"friction": 0.6, "shear_limit": 1e3}, {"contact": "weld"}]
        if STRENGTH & {self.laws[d[f"{body}_material"]] for body in ("ground", "top")}:
            laws.append({"shear_fraction": 0.5})
        d["contact_pairs"] = draw.choice(["ground:top", "top:ground"])
        name = d["contact_pairs"].replace(":", "_")
        d.update({f"{name}_{key}": value for key, value in draw.choice(laws).items()})

    def top_body(self, wide):
        d, draw, dim, up = self.deck, self.draw, self.dim, self.up
        base = self.level if self.some(0.6) else self.level + 0.42 * self.h
        base = round(math.ceil(base / self.h - 1e-6) * self.h if self.some(0.5) else base, 4)
        size = 1.57 * self.h
        left = [0.0 if self.axisymmetric else self.near(max(n / 2 - 2.4, 0.2)) for n in self.cells[:up]]
        shape = draw.choice(["box", "box", "polygon", "disc"] if dim == 2 else ["box", "box", "ball", "cylinder"])
        d["top_shape"] = shape
        self.top_base = base
        if shape == "box":
            d.update(top_lower=(*left, base), top_upper=tuple(x + draw.randint(1, 2) * self.h for x in (*left, base)))
        elif shape == "polygon":
            d["top_polygon"] = (left[0], base, left[0] + 2 * self.h, base, left[0] + 1.4 * self.h, base + size, left[0], base + size)
        elif shape == "cylinder":
            d.update(top_centre=tuple(w / 2 for w in wide[:2]) + (base,), top_radius=round(1.3 * self.h, 4), top_height=size)
        else:
            centre = [0.0 if self.axisymmetric else round(w / 2.1, 4) for w in wide[:up]]
            d.update(top_centre=(*centre, round(base + 1.23 * self.h, 4)), top_radius=round(1.23 * self.h, 4))
        if shape != "box" and self.some(0.4):
            d["top_fill"] = draw.choice(["cut", "cell"] if dim == 2 else ["cut"])

    def rigid(self):
        d, draw, dim, up = self.deck, self.draw, self.dim, self.up
        wide = d["mesh_upper"]
        shape = draw.choice(["box", "polygon", "disc"] if dim == 2 else ["box", "polygon", "ball", "cylinder"])
        d.update(rigid_bodies="tool", tool_shape=shape)
        depth = draw.choice([0.0, 0.0, -0.53, -1.2]) * self.h
        base = round(self.level + depth, 4)
        left, size = (0.0 if self.axisymmetric else self.near(self.cells[0] / 2 + 0.5)), 1.6 * self.h
        if self.axisymmetric:
            left, size = 0.0, 2.6 * self.h
        right, high = round(min(left + size, wide[0]), 4), round(base + 1.9 * self.h, 4)
        if shape == "box":
            across = [(0.0, wide[1])] if self.some(0.5) else [(0.4 * self.h, 1.6 * self.h)]
            across = across if dim == 3 else []
            d.update(tool_lower=(left, *(a for a, _ in across), base), tool_upper=(right, *(b for _, b in across), high))
        elif shape == "polygon":
            d["tool_polygon"] = (left, base, right, base, right, high, left, round(high - 0.5 * self.h, 4))
            if dim == 3:
                d["tool_width"] = (0.0, wide[1]) if self.some(0.5) else (0.4 * self.h, 1.6 * self.h)
        else:
            centre = [0.0] if self.axisymmetric else [round(x / 2.05, 4) for x in wide[:up]]
            if shape == "cylinder":
                d.update(tool_centre=(*centre, base), tool_radius=round(0.8 * self.h, 4), tool_height=size)
            else:
                d.update(tool_centre=(*centre, round(base + 0.9 * self.h, 4)), tool_radius=round(0.9 * self.h, 4))
        for body in d["bodies"].split(","):
            if depth < 0 or body == "top":
                d[f"{body}_cut_out"] = "tool"
        motion = draw.choice(["prescribed", "prescribed", "dynamic", "fixed"])
        d["tool_motion"] = motion
        if motion != "fixed":
            sideways = [] if self.axisymmetric or self.some(0.6) else [round(draw.uniform(-1, 1) * self.speed, 4)]
            d["tool_velocity"] = tuple((sideways + [0.0] * up)[:up] + [-round(2 * self.speed, 4)])
        if motion == "dynamic":
            d["tool_density"] = 2500.0
            if self.some(0.5):
                d["tool_force"] = self.down(2e4 * self.h ** up)
        interface = draw.choice(["smooth", "shear_limit", "shear_fraction", "friction"])
        used = {self.laws[d[f"{body}_material"]] for body in d["bodies"].split(",")}
        if interface == "shear_fraction" and STRENGTH & used:
            d["tool_shear_fraction"] = 0.5
        elif interface in ("shear_limit", "friction"):
            d.update({"tool_shear_limit": 1e3} if interface == "shear_limit" else {"tool_friction": 0.4})
        if self.some(0.2):
            d["tool_separation"] = "none"
        elif self.some(0.15):
            d["tool_contact_gap_scaling"] = "none"

    def sides(self):
        d, draw, dim = self.deck, self.draw, self.dim
        plain = ["roller", "roller", "roller", "fixed", "free", "friction"] + ([] if self.water or FLUIDS & set(self.laws.values()) else ["absorbing"])
        if self.has["smooth"]:
            plain += ["smooth"] * len(plain)
        if self.axisymmetric:
            plain = [kind for kind in plain if kind != "friction"]
        periodic = not self.axisymmetric and self.some(0.15) and not self.water and d.get("tool_shape", "ball") in ("ball", "disc", "box")
        for axis in range(dim):
            for end in ("min", "max"):
                side = f"mesh_{'xyz'[axis]}{end}"
                if periodic and axis == 0:
                    d[side] = "periodic"
                    continue
                if self.axisymmetric and axis == 0 and end == "min":
                    continue
                if axis == self.up and end == "max" and self.has["smooth"] and self.some(0.5):
                    continue  # a lid by default where gravity holds soil away from it
                kind = "free" if axis == self.up and end == "max" else draw.choice([k for k in plain if k != "free" or axis != self.up])
                d[side] = kind
                if kind == "friction":
                    d[f"{side}_friction"] = draw.choice([0.0, 0.3, 0.6])
                    if self.some(0.3):
                        d[f"{side}_shear_limit"] = 500.0
                if kind == "absorbing" and self.some(0.4):
                    d.update({f"{side}_dashpot_factor": 0.5, f"{side}_spring_length": 10 * self.h})
                if kind in ("roller", "fixed", "friction", "smooth") and self.some(0.15) and not self.axisymmetric:
                    move = [round(draw.uniform(-0.1, 0.1) * self.speed, 4) if k == axis or kind != "roller" else 0.0 for k in range(dim)]
                    d[f"{side}_velocity"] = tuple(move)

    def load(self):
        d = self.deck
        body = "top" if "top" in d["bodies"] else "ground"
        d.update(loads="push", push_body=body, push_lower=(0.0,) * self.up + (round(0.5 * self.level, 4),), push_upper=d["mesh_upper"])
        if self.some(0.6):
            d["push_facing"] = (0.0,) * self.up + (1.0,)
        d["push_pressure"] = 2e3
        if self.some(0.4):
            d["push_traction"] = self.down(500.0) if self.axisymmetric else self.vector(500.0)

    def probes(self):
        d, wide, axis = self.deck, self.deck["mesh_upper"], self.draw.randrange(self.dim)
        place = tuple(round(x / 3.3, 4) for x in wide[:self.up]) + (round(self.level / 2.3, 4),)
        kinds = {"spot": {"kind": "point", "at": place}, "grain": {"kind": "particle", "at": place},
                 "gauge": {"kind": "gauge", "at": place[:self.up] if self.dim == 3 else place[0]},
                 "cut": {"kind": "section", "axis": "xyz"[axis], "at": place[axis]}}
        names = self.draw.sample(sorted(kinds), self.draw.randint(1, 4))
        d["probes"] = ",".join(names)
        d.update({f"{name}_{key}": value for name in names for key, value in kinds[name].items()})

    def timing(self):
        """A time step of its own, or a Courant number, and times that end the run after about `steps`."""
        d = self.deck
        stiff = 2.5 * E + max((v for k, v in d.items() if k.endswith("pore_stiffness")), default=0) + (1e7 if "cam_clay" in self.laws.values() else 0)
        stiff += 2 * d.get("water_bulk_modulus", 0) / 0.3
        step = 0.2 * self.h / math.sqrt(stiff / (0.8 * RHO))
        self.step = step = float(f"{step:.4g}")
        if self.some(0.5):
            d["time_step"] = step
        elif self.some(0.5):
            d["time_courant"] = 0.3
        d["time_end"] = float(f"{step * self.steps:.6g}")
        d["history_interval"] = d["time_end"] / self.draw.choice([3, 5])
        d["output_interval"] = d["time_end"] / 2


def random_deck(draw, dim, precision, wanted=()):
    """A deck, with the `wanted` of FEATURES."""
    return Maker(draw, dim, precision, wanted).make()


def text_of(deck):
    """The deck as lines of an options file."""
    def word(value):
        if isinstance(value, tuple):
            return ",".join(word(x) for x in value)
        return repr(value) if isinstance(value, float) else str(value)
    return "".join(f"-{name} {word(value)}\n" for name, value in deck.items())
