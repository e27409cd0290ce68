"""Rigid bodies that turn, on soil that they hit, roll over, dig into or stir.

A deck has soil under gravity and one or two bodies of random shapes, free in some degrees or driven, with random interfaces, velocities,
moments and inertia. What a body gains of momentum and of angular momentum must be the impulse and the moment that the history has,
to round-off; a body that is held in a degree must not move along it; its mirror image must move as its mirror.
"""
import numpy as np

from deck import Deck, changer, rounded, vector
from mpm_regression.folders import history

SPIN = {2: ("",), 3: ("_x", "_y", "_z")}


class Turning(Deck):
    strategies = ("tile", "tile", "gather", "mosaic", "atomic", "sequential")
    # Touch is found node by node: a body that tumbles on soil amplifies round-off.
    apart = {"double": 1e-6, "single": 0.2}

    def make(self):
        draw, dim = self.draw, self.dim
        self.gravity = [draw.choice([0.0, 1.5])] + [0.0] * (dim - 2) + [-9.81]
        self.top = [4.0, *[2.0] * (dim - 2), 3.0]
        self.options = [*(f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(self.top)} -mesh_spacing 0.125 "
                          f"-mesh_{self.up}max free -mesh_xmin {draw.choice(['smooth', 'fixed'])} -mesh_xmax smooth "
                          f"-materials soil -bodies ground -ground_material soil -ground_shape box -ground_lower {vector([0] * dim)} "
                          f"-ground_upper {vector([*self.top[:-1], 1.0])} -gravity {vector(self.gravity)} -damping {draw.choice([0, 0, 0.2])} "
                          f"-velocity_update {draw.choice(['flip', 'apic'])} -time_end 0.12 -time_courant 0.4 -history_interval 0.01 "
                          "-output_interval 0.06").split(), *self.soil()]
        names = draw.choice([["wheel"], ["wheel", "brick"]])
        self.bodies = {name: self.body(name, 0.9 + 1.6 * k) for k, name in enumerate(names)}
        self.options += ["-rigid_contact", "on", "-rigid_bodies", ",".join(names)] + [word for body in self.bodies.values() for word in body["words"]]

    def soil(self):
        common = "-soil_density 1700 -soil_young 2e6 -soil_poisson 0.3 "
        return (common + self.draw.choice(["-soil_model linear_elastic", "-soil_model von_mises -soil_su 4e3",
                                           "-soil_model mohr_coulomb -soil_cohesion 500 -soil_friction_deg 30"])).split()

    def shape(self, name, centre):
        """Words of a shape above the ground."""
        draw, dim = self.draw, self.dim
        half = [draw.uniform(0.15, 0.3) for _ in range(dim)]
        centre = [*centre[:-1], 1.02 + max(half) + draw.uniform(0, 0.03)]  # it meets the ground soon
        low, high = [c - h for c, h in zip(centre, half)], [c + h for c, h in zip(centre, half)]
        words = {"disc": f"-{name}_shape disc -{name}_centre {rounded(centre)} -{name}_radius {half[0]:.6f}",
                 "box": f"-{name}_shape box -{name}_lower {rounded(low)} -{name}_upper {rounded(high)} -{name}_fillet {draw.choice([0, 0.05])}"}
        x, y, a, b = centre[0], centre[-1], half[0], half[-1]
        corners = rounded([x - a, y - b, x + a, y - b, x + draw.uniform(-a, a), y + b])
        prism = f" -{name}_width {centre[1] - half[1]:.6f},{centre[1] + half[1]:.6f}" if dim == 3 else ""
        words["polygon"] = f"-{name}_shape polygon -{name}_polygon {corners}{prism}"
        if dim == 3:
            words["cylinder"] = f"-{name}_shape cylinder -{name}_centre {rounded([*centre[:2], low[2]])} -{name}_radius {a:.6f} -{name}_height {2 * b:.6f}"
        return words[draw.choice([*words])].split()

    def body(self, name, x):
        draw, dim = self.draw, self.dim
        spins = len(SPIN[dim])
        words = self.shape(name, [x + draw.uniform(-0.1, 0.1), *[1.0] * (dim - 1)])
        spin, velocity = [draw.uniform(-4, 4) for _ in range(spins)], [draw.uniform(-1, 1) for _ in range(dim)]
        body = {"driven": draw.random() < 0.25, "moment": [0.0] * spins}
        words += draw.choice([[], [f"-{name}_friction", f"{draw.uniform(0.05, 0.8):.3f}"], [f"-{name}_shear_limit", "1e3"]])
        words += [f"-{name}_angular_velocity", rounded(spin), f"-{name}_velocity", rounded(velocity)]
        if body["driven"]:
            return {**body, "words": [*words, f"-{name}_motion", "prescribed"]}
        moves = [axis for axis in self.axes if draw.random() < 0.85]
        turns = ["rz"] if dim == 2 else draw.choice([["rx", "ry", "rz"], ["rx", "ry", "rz"], ["ry"]])
        if len(turns) < spins:
            words[words.index(f"-{name}_angular_velocity") + 1] = rounded([0, spin[1], 0])
        words[words.index(f"-{name}_velocity") + 1] = rounded(v if axis in moves else 0 for axis, v in zip(self.axes, velocity))
        body["held"] = [axis for axis in self.axes if axis not in moves]
        body["turns"] = turns
        if draw.random() < 0.5:
            body["moment"] = [draw.uniform(-200, 200) for _ in range(spins)]
            words += [f"-{name}_moment", rounded(body["moment"])]
        body["mass"] = draw.uniform(300, 900)
        inertia = [draw.uniform(10, 40)] if dim == 2 else [30, 25, 20, draw.uniform(-4, 4), draw.uniform(-4, 4), draw.uniform(-4, 4)]
        body["inertia"] = inertia
        words += [f"-{name}_motion", "dynamic", f"-{name}_free", ",".join([*moves, *turns]), f"-{name}_mass", f"{body['mass']:.6f}",
                  f"-{name}_inertia", rounded(inertia)]
        return {**body, "words": words}

    def check(self, folder):
        values = history(folder)
        t = values["time"]
        for name, body in self.bodies.items():
            turned = {end: values[f"{name}_angular_velocity{end}"] for end in SPIN[self.dim]}
            if body["driven"]:
                for end, w in turned.items():
                    assert np.ptp(w) == 0, f"{name}: its prescribed angular velocity{end} changes"
                continue
            self.note("largest force on a body over its weight", max(np.abs(values[f"{name}_force_{axis}"]).max() for axis in self.axes) / (9.81 * body["mass"]))
            for axis in body["held"]:
                assert np.ptp(values[f"{name}_{axis}"]) == 0, f"{name} moves along {axis}"
            if "0.2" in self.options[self.options.index("-damping") + 1]:
                continue
            for axis, g in zip(self.axes, self.gravity):
                if axis not in body["held"]:
                    self.check_gain(name, axis, body["mass"] * values[f"{name}_velocity_{axis}"],
                                    values[f"{name}_force_{axis}"] + values[f"{name}_contact_force_{axis}"] + body["mass"] * g, t)
            if self.dim == 2:
                self.check_gain(name, "rz", round(body["inertia"][0], 6) * turned[""], values[f"{name}_moment"]
                                + values[f"{name}_contact_moment"] + round(body["moment"][0], 6), t)

    def check_gain(self, name, what, momentum, rate, t):
        """Between two rows a body gains the momentum of the mean force over the interval."""
        gained = np.cumsum(rate[1:] * np.diff(t))
        scale = np.abs(momentum).max() + np.abs(rate[1:] * np.diff(t)).sum()
        error = np.abs(momentum[1:] - momentum[0] - gained).max() / scale
        self.note("momentum of a body off its impulse", error)
        assert error < 2e-8, f"{name}: its momentum {what} is {error:.3g} off the impulse on it"

    def compare(self, whole):
        """The mirror image across the middle plane of x."""
        if not self.exact or "-mesh_xmin fixed" in " ".join(self.options):
            return
        image = self.go("image", options=self.mirror())
        mine, theirs = history(image), history(whole)
        for name in self.bodies:
            for what, sign in (("x", -1), ("velocity_x", -1), (self.up, 1), *((f"angular_velocity{end}", -1 if end in ("", "_y", "_z") else 1)
                                                                             for end in SPIN[self.dim])):
                off = np.abs(sign * mine[f"{name}_{what}"] - theirs[f"{name}_{what}"]).max()
                scale = np.abs(theirs[f"{name}_{what}"]).max() + 1
                self.note("difference of the mirror image", off / scale)
                assert off / scale < 1e-5, f"the mirror image: {name}_{what} is {off / scale:.3g} apart"

    def mirror(self):
        """The options of the mirror image."""
        words, width = list(self.options), self.top[0]
        change = changer(words)

        change("-gravity", lambda g: [-g[0], *g[1:]])
        for name in self.bodies:
            def spin(w):
                return [-w[0]] if len(w) == 1 else [w[0], -w[1], -w[2]]
            for option in ("angular_velocity", "moment"):
                change(f"-{name}_{option}", spin)
            change(f"-{name}_velocity", lambda v: [-v[0], *v[1:]])
            change(f"-{name}_centre", lambda c: [width - c[0], *c[1:]])
            if f"-{name}_lower" in words:
                low, high = ([float(x) for x in words[words.index(f"-{name}_{end}") + 1].split(",")] for end in ("lower", "upper"))
                words[words.index(f"-{name}_lower") + 1] = vector([width - high[0], *low[1:]])
                words[words.index(f"-{name}_upper") + 1] = vector([width - low[0], *high[1:]])
            change(f"-{name}_polygon", lambda p: [width - x if k % 2 == 0 else x for k, x in enumerate(p)])
            change(f"-{name}_inertia", lambda i: i if len(i) == 1 else [*i[:3], -i[3], i[4], -i[5]])
        return words
