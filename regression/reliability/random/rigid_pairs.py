"""Rigid bodies that hit each other, the sides of the mesh and fixed bodies, in flight, in heaps and on soil.

A deck has three to six bodies of random shapes, some of two parts or of triangles, dynamic, fixed or prescribed, over a rigid plane or over soil, with random friction and
restitution. What a dynamic body gains of momentum must be the impulse of the soil, of contact and of its weight; what contact gives to
all bodies together must be nothing where no side of the mesh can be reached; without soil and driven bodies the energy must not grow;
balls must not come into each other or into planes; the mirror image must move as the mirror, and bodies in another order likewise.
"""
import pathlib

import numpy as np

from deck import Deck, changer, rounded, vector
from mpm_regression.folders import history

SPIN = {2: ("",), 3: ("_x", "_y", "_z")}
SPACING = 0.25
CUBE = pathlib.Path(__file__).with_name("cube.obj")  # of edge 1, about the origin


class RigidPairs(Deck):
    backends = ("serial", "openmp")
    strategies = ("tile", "tile", "gather", "sequential")
    counts = (2,)
    apart = {"double": 1e-5, "single": 0.5}  # an impact amplifies round-off of the soil

    def make(self):
        draw, dim = self.draw, self.dim
        self.gravity = [draw.choice([0.0, 2.0])] + [0.0] * (dim - 2) + [-9.81]
        self.top = [5.0, *[2.0] * (dim - 2), 4.0]
        self.kind = draw.choice(["plane", "plane", "box", "soil", "sides"])
        side = "roller" if self.kind == "sides" else "free"
        lower, upper = ([0.0] * dim, [*self.top[:-1], 0.75]) if self.kind == "soil" else ([0.0] * (dim - 1) + [3.5], [0.25] * (dim - 1) + [3.75])
        self.options = [*(f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(self.top)} -mesh_spacing {SPACING} "
                          + " ".join(f"-mesh_{axis}{end} {side}" for axis in self.axes for end in ("min", "max"))
                          + f" -gravity {vector(self.gravity)} -materials soil -soil_model linear_elastic -soil_density 1800 -soil_young 2e5 "
                          f"-soil_poisson 0.3 -bodies pad -pad_material soil -pad_shape box -pad_lower {vector(lower)} -pad_upper {vector(upper)} "
                          "-time_end 0.4 -time_step 5e-4 -history_interval 0.02 -output_interval 0.2").split()]
        if self.kind == "soil":
            self.options[self.options.index(f"-mesh_{self.up}min") + 1] = "fixed"
        self.friction = draw.choice([0.0, 0.3, 0.6])
        self.options += ["-rigid_friction", str(self.friction)]
        self.bodies, self.parts, words = {}, [], []
        places = [(x, z) for x in (1.2, 2.5, 3.8) for z in (1.45, 2.3)]
        draw.shuffle(places)
        for k, (x, z) in enumerate(places[:draw.randint(3, 5)]):
            words += self.body(f"b{k}", x + draw.uniform(-0.15, 0.15), z + draw.uniform(-0.05, 0.05))
        self.order = [*self.bodies]
        if self.kind in ("plane", "box"):
            self.order.append("floor")
            words += self.floor()
        self.words, self.options = words, [*self.options, *words]
        self.listed = ["-rigid_bodies", ",".join(self.order)]
        self.options += self.listed

    def floor(self):
        if self.kind == "plane":
            self.normal = [self.draw.choice([0.0, 0.2]), *[0.0] * (self.dim - 2), 1.0]
            point = [2.5, *[1.0] * (self.dim - 2), 0.8]
            return ["-floor_shape", "half_plane", "-floor_point", vector(point), "-floor_normal", vector(self.normal), "-floor_particles_per_cell", "1"]
        return ["-floor_shape", "box", "-floor_lower", vector([0] * self.dim), "-floor_upper", vector([*self.top[:-1], 0.75]), "-floor_particles_per_cell", "1"]

    def body(self, name, x, z):
        draw, dim = self.draw, self.dim
        a, b = draw.uniform(0.15, 0.3), draw.uniform(0.15, 0.3)
        middle = [1.0 + draw.uniform(-0.1, 0.1)] * (dim - 2)
        centre = [x, *middle, z]
        low, high = [x - a, *(m - a for m in middle), z - b], [x + a, *(m + a for m in middle), z + b]
        shape = draw.choice(["disc", "disc", "box", "polygon", "parts", *(["cylinder", "stl"] if dim == 3 else [])])
        words = {"disc": f"-{name}_shape disc -{name}_centre {rounded(centre)} -{name}_radius {a:.6f}",
                 "box": f"-{name}_shape box -{name}_lower {rounded(low)} -{name}_upper {rounded(high)}",
                 "polygon": f"-{name}_shape polygon -{name}_polygon {rounded([x - a, z - b, x + a, z - b, x + a / 3, z + b])}"
                            + (f" -{name}_width {low[1]:.6f},{high[1]:.6f}" if dim == 3 else ""),
                 "cylinder": f"-{name}_shape cylinder -{name}_centre {rounded([*centre[:-1], z - b])} -{name}_radius {a:.6f} -{name}_height {2 * b:.6f}",
                 "parts": f"-{name}_parts {name}_foot,{name}_leg,{name}_head -{name}_foot_shape box -{name}_foot_lower {rounded(low)} "
                          f"-{name}_foot_upper {rounded([*high[:-1], z - b / 3])} -{name}_leg_shape box "
                          f"-{name}_leg_lower {rounded([*low[:-1], z - b / 3])} -{name}_leg_upper {rounded([x, *high[1:-1], z + b])} "
                          f"-{name}_head_shape disc -{name}_head_centre {rounded([x - a / 2, *middle, z + b])} -{name}_head_radius {a / 2:.6f}",
                 "stl": f"-{name}_shape stl -{name}_file {CUBE} -{name}_scale {2 * a:.6f} -{name}_offset {rounded(centre)}"}[shape].split()
        if shape == "parts":
            self.parts += [f"{name}_foot", f"{name}_leg", f"{name}_head"]
            words += [f"-{name}_part_forces", "on"]
        body = {"motion": draw.choice(["dynamic"] * 6 + ["fixed", "prescribed"]) if self.bodies else "dynamic", "shape": shape,
                "centre": np.array(centre), "radius": round(a, 6)}
        self.bodies[name] = body
        words += draw.choice([[], [f"-{name}_restitution", draw.choice(["0.5", "1", "0.9"])]])
        words += [f"-{name}_motion", body["motion"]]
        if body["motion"] == "fixed":
            return words
        velocity = [draw.uniform(-1, 1), *[draw.uniform(-0.3, 0.3)] * (dim - 2), draw.uniform(-2, 0.5)]
        if body["motion"] == "prescribed":
            return [*words, f"-{name}_velocity", rounded(v / 4 for v in velocity)]
        spins = len(SPIN[dim])
        body["mass"], body["inertia"] = round(draw.uniform(100, 900), 6), round(draw.uniform(4, 20), 6)
        inertia = [body["inertia"]] if dim == 2 else [body["inertia"]] * 3 + [0.0] * 3
        body["turns"] = draw.random() < 0.8
        words += [f"-{name}_velocity", rounded(velocity), f"-{name}_mass", f"{body['mass']:.6f}"]
        if body["turns"]:
            words += [f"-{name}_free", ",".join([*self.axes, *(["rz"] if dim == 2 else ["rx", "ry", "rz"])]), f"-{name}_inertia", vector(inertia),
                      f"-{name}_angular_velocity", rounded(draw.uniform(-4, 4) for _ in range(spins))]
        return words

    def check(self, folder):
        values = history(folder)
        t = values["time"]
        total, largest, energy = np.zeros((len(t), self.dim)), 1e-9, np.zeros(len(t))
        for name, body in self.bodies.items():
            force = np.column_stack([values[f"{name}_contact_force_{axis}"] for axis in self.axes])
            total += force
            largest = max(largest, np.abs(force).max())
            if body["motion"] != "dynamic":
                continue
            for k, axis in enumerate(self.axes):
                gain = force[:, k] + values[f"{name}_force_{axis}"] + body["mass"] * self.gravity[k]
                gained = np.cumsum(gain[1:] * np.diff(t))
                momentum = body["mass"] * values[f"{name}_velocity_{axis}"]
                scale = np.abs(momentum).max() + np.abs(gain[1:] * np.diff(t)).sum()
                error = np.abs(momentum[1:] - momentum[0] - gained).max() / scale
                self.note("momentum of a body off its impulse", error)
                assert error < 1e-8, f"{name}: its momentum along {axis} is {error:.3g} off the impulse on it"
                energy += momentum**2 / (2 * body["mass"]) - body["mass"] * self.gravity[k] * values[f"{name}_{axis}"]
            for end in SPIN[self.dim] if body["turns"] else ():
                energy += body["inertia"] * values[f"{name}_angular_velocity{end}"] ** 2 / 2
        if self.kind in ("plane", "box"):
            total += np.column_stack([values[f"floor_contact_force_{axis}"] for axis in self.axes])
        if self.kind != "sides":
            self.note("sum of contact forces over the largest", np.abs(total).max() / largest)
            assert np.abs(total).max() < 1e-9 * largest, f"contact forces are not opposite: {np.abs(total).max() / largest:.3g}"
        if self.kind in ("plane", "box", "sides") and all(body["motion"] != "prescribed" for body in self.bodies.values()):
            kinetic = np.ptp(energy) + 1
            grown = max((energy[k:] - energy[k]).max() for k in range(len(energy))) / kinetic
            self.note("growth of energy over its range", grown)
            assert grown < 0.01, f"the energy grows by {grown:.3g} of its range"
        self.check_parts(values)
        self.check_gaps(values)

    def check_parts(self, values):
        """What the soil does to the parts of a body adds up to what it does to the body."""
        for name in {part.split("_")[0] for part in self.parts}:
            spins = [f"moment{end}" for end in SPIN[self.dim]] if self.bodies[name].get("turns") else []
            for kind in [f"force_{axis}" for axis in self.axes] + spins:
                of = np.array([values[f"{name}_{part}{kind}"] for part in ("", "foot_", "leg_", "head_")])
                off = np.abs(of[1:].sum(axis=0) - of[0]).max() / max(1.0, np.abs(of).max())
                self.note("force on the parts off that on the body", off)
                assert off < 1e-9, f"{name}: the {kind} of its parts is {off:.3g} off that of the body"

    def check_gaps(self, values):
        """Balls against balls, and against the floor."""
        balls = [name for name, body in self.bodies.items() if body["shape"] == "disc"]
        place = {name: self.bodies[name]["centre"] + np.column_stack([values[f"{name}_{axis}"] for axis in self.axes]) for name in balls}
        depth = 0.0
        for k, name in enumerate(balls):
            radius = self.bodies[name]["radius"]
            for other in balls[k + 1:]:
                if "dynamic" in (self.bodies[name]["motion"], self.bodies[other]["motion"]):
                    gap = np.linalg.norm(place[name] - place[other], axis=1) - radius - self.bodies[other]["radius"]
                    depth = max(depth, -gap.min())
            if self.kind == "plane" and self.bodies[name]["motion"] == "dynamic":
                normal = np.array(self.normal) / np.linalg.norm(self.normal)
                depth = max(depth, -((place[name] - [2.5, *[1.0] * (self.dim - 2), 0.8]) @ normal - radius).min())
        self.note("depth of a ball in another body, in cells", depth / SPACING)
        assert depth < 0.02 * SPACING, f"a ball is {depth / SPACING:.3g} cells in another body"

    def compare(self, whole):
        """The bodies in another order, and the mirror image across the middle plane of x."""
        if not self.exact:
            return
        turned = [word for word in self.options if word not in self.listed] + ["-rigid_bodies", ",".join(reversed(self.order))]
        self.compare_motions(self.go("order", options=turned), whole, 1, "bodies in another order")
        self.compare_motions(self.go("image", options=self.mirror()), whole, -1, "the mirror image")

    def compare_motions(self, folder, whole, sign, what):
        """The places up to the time at which impacts may have amplified round-off."""
        mine, theirs = history(folder), history(whole)
        for name, body in self.bodies.items():
            for axis in self.axes:
                off = np.abs((sign if axis == "x" else 1) * mine[f"{name}_{axis}"] - theirs[f"{name}_{axis}"]).max()
                self.note(f"way of {what}, apart (m)", off)
                assert off < 0.02, f"{what}: {name}_{axis} is {off:.3g} m apart"

    def mirror(self):
        """The options of the mirror image."""
        words, width = list(self.options), self.top[0]
        change = changer(words)

        def turned(w):
            return [-w[0]] if len(w) == 1 else [w[0], -w[1], -w[2]]

        for option in ("-gravity", "-floor_normal"):
            change(option, lambda v: [-v[0], *v[1:]])
        for name in (*self.bodies, *self.parts, "pad", "floor"):
            change(f"-{name}_angular_velocity", turned)
            change(f"-{name}_velocity", lambda v: [-v[0], *v[1:]])
            for place in ("centre", "point", "offset"):
                change(f"-{name}_{place}", lambda c: [width - c[0], *c[1:]])
            if f"-{name}_lower" in words:
                low, high = ([float(x) for x in words[words.index(f"-{name}_{end}") + 1].split(",")] for end in ("lower", "upper"))
                words[words.index(f"-{name}_lower") + 1] = vector([width - high[0], *low[1:]])
                words[words.index(f"-{name}_upper") + 1] = vector([width - low[0], *high[1:]])
            change(f"-{name}_polygon", lambda p: [width - x if k % 2 == 0 else x for k, x in enumerate(p)])
        return words
