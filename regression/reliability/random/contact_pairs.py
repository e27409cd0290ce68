"""Deformable bodies that meet in pairs: in a row, about a corner, up to eight about a point, one inside another, on the ground, under a rigid body, as bodies of revolution.

Materials, laws of contact, pairs that are left out, and stages that change laws or remove a body are random. What all bodies have of momentum
changes by weight, sides and rigid bodies alone, what each has by its pairs too; contact never adds energy but for round-off of the bodies'
vibration; the mirror image moves as the mirror.
"""
import itertools

import numpy as np

from deck import Deck, rounded, vector
from mpm_regression.folders import history, of_velocities
from pair_scenes import NAMES, Scene

END = 0.16  # s; so many whole steps also in two stages: a shorter step at the end has the force of a rigid body over the mean of two steps
LAWS = [[], ["_friction", "0.3"], ["_friction", "0.8", "_adhesion", "500"], ["_shear_limit", "800"], ["_friction", "0.5", "_shear_limit", "2e3"], ["_friction", "0", "_adhesion", "1e3"],
        ["_contact", "weld"]]


class ContactPairs(Deck):
    strategies = ("tile", "tile", "gather", "sequential", "mosaic")
    ranks = (1, 1, 2)
    sums = ("energy_", "work_", "wall_", "tool_", *(f"{one}_{two}_" for one, two in itertools.permutations(NAMES, 2)))
    apart = {"double": 1e-6, "single": 0.2}  # bodies that slide amplify round-off

    def make(self):
        draw, dim = self.draw, self.dim
        self.kind = draw.choice(["row", "row", "corner", "corner", "inside", "ground", "wheel", "rigid_between", *(["rings"] if dim == 2 else [])])
        self.scene = scene = Scene(draw, dim, self.kind, self.folder)
        self.names = scene.names
        sides = {f"{axis}{end}": "free" for axis in self.axes for end in ("min", "max")}
        sides.update(scene.sides)
        if self.kind == "rings":
            sides["xmin"] = "roller"
        domain = "fixed" if self.kind == "rings" else draw.choice(["fixed", "fixed", "stretch", "split"])
        step = (4e-3 if domain == "fixed" else 2.5e-3) * scene.cell  # domains that become shorter want shorter steps
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(scene.size)} -mesh_spacing {scene.cell} -gravity {vector(scene.gravity)} "
                        f"-time_end {END} -time_step {step:g} -history_interval 0.0025 -output_interval 0.05 -output_energy on").split()
        for side, kind in sides.items():
            self.options += [f"-mesh_{side}", kind, *([f"-mesh_{side}_friction", "0.5"] if kind == "friction" else [])]
            if kind in ("fixed", "roller") and self.kind == "ground":  # a side that moves, if but little, has the mean force in rows
                self.options += [f"-mesh_{side}_velocity", vector([1e-9 * (axis == side[0]) for axis in self.axes])]
        self.options += ["-geometry", "axisymmetric"] if self.kind == "rings" else []
        self.options += ["-f_bar_fraction", draw.choice(["0", "0.98"]), "-velocity_update", draw.choice(["flip", "flip", "apic", "xpic"])]
        self.options += ["-particle_domain", domain]
        self.clay = {name: draw.random() < 0.5 for name in self.names}
        self.options += ["-materials", ",".join(f"m{name}" for name in self.names), "-bodies", ",".join(self.names), *scene.words, *scene.rigid]
        for name in self.names:
            self.options += self.material(name)
        self.options += ["-contact_pairs", ",".join(":".join(pair) for pair in scene.pairs)]
        self.laws = {"_".join(pair): self.law(pair) for pair in scene.pairs}
        self.options += [word for pair, words in self.laws.items() for word in words]
        self.stages(draw.random() < 0.3)

    def material(self, name):
        draw = self.draw
        words = [f"-{name}_material", f"m{name}", f"-{name}_velocity", rounded(self.scene.velocity[name]), f"-{name}_particles_per_cell", str(self.scene.particles),
                 f"-m{name}_density", str(draw.choice([800, 1600, 2600])), f"-m{name}_young", str(draw.choice([2e5, 1e6, 3e6])),
                 f"-m{name}_poisson", draw.choice(["0", "0.3", "0.45"]), f"-m{name}_model", "von_mises" if self.clay[name] else "linear_elastic"]
        return words + ([f"-m{name}_su", str(draw.choice([2e3, 2e4]))] if self.clay[name] else [])

    def law(self, pair):
        words = self.draw.choice(LAWS + ([["_shear_fraction", "0.5"]] if any(self.clay[name] for name in pair) else []))
        return [f"-{'_'.join(pair)}{word}" if word.startswith("_") else word for word in words]

    def stages(self, two):
        """A second stage with other laws, and in some decks without the last body."""
        if not two:
            return
        draw, slides = self.draw, [pair for pair, words in self.laws.items() if "weld" not in words]
        self.options[self.options.index("-time_end") + 1] = str(END / 2)
        self.options += ["-stages", "first,second"]
        for pair in slides:
            self.options += draw.choice([[], [f"-second_{pair}_friction", "0.1"], [f"-second_{pair}_friction", "1"], [f"-second_{pair}_shear_limit", "300"]])
        if len(self.names) > 2 and draw.random() < 0.4:
            self.options += ["-second_remove", self.names[-1]]

    # ------------------------------------------------------------------------------------------ checks

    def columns(self, values):
        """Pairs that have columns: two bodies that are welded, and of which no other pair has either, share a field."""
        return ["_".join(pair) for pair in self.scene.pairs if f"{'_'.join(pair)}_force_{self.up}" in values]

    def check(self, folder):
        values = history(folder)
        steps, pairs = np.diff(values["time"]), self.columns(values)
        weighs = np.diff(of_velocities(values["time"], values["dt"]))
        for axis, gravity in zip(self.axes, self.scene.gravity):
            if self.kind == "rings" and axis == "x":
                continue
            parts = {name: values[f"{name}_momentum_{axis}"] + values[f"{name}_lost_momentum_{axis}"] for name in self.names}
            force = sum(values[name] for name in values if name.startswith(("wall_", "tool_force_")) and name.endswith(f"force_{axis}"))
            between = {pair: values[f"{pair}_force_{axis}"] for pair in pairs}
            scale = sum(np.abs(part).max() for part in parts.values()) + sum(np.abs(one[1:] * steps).sum() for one in between.values()) + 1e-6
            mass = sum(values[f"{name}_mass"] for name in self.names)
            gained = np.cumsum(weighs * gravity * mass[1:] - (force[1:] if np.ndim(force) else 0) * steps)
            off = np.abs(sum(part[1:] - part[0] for part in parts.values()) - gained).max() / scale
            self.note("change of all momentum", off)
            # A node below the least mass feels no force; where soil begins at nodes one may come to it: 1e-11, once.
            assert off < self.bound(1e-10, 1e-4), f"the momentum {axis} of all bodies changes by {off:.3g}"
            if self.kind in ("row", "rings", "corner", "wheel", "inside") and self.has_all_pairs():
                self.check_each(axis, parts, between, steps)
        self.check_energy(values)
        self.note("touched", not pairs or any(np.abs(values[f"{pair}_force_{self.axes[self.scene.along]}"]).max() > 0 for pair in pairs))
        assert values["time"][-1] > 0.99 * END and all(np.isfinite(column).all() for column in values.values())

    def has_all_pairs(self):
        """Whether no two bodies share momentum, as those that are welded, or in no pair, do."""
        return len(self.scene.pairs) == len(self.names) * (len(self.names) - 1) // 2 and not any("weld" in words for words in self.laws.values())

    def check_each(self, axis, parts, between, steps):
        for name, momentum in parts.items():
            rate = sum({0: 1, 1: -1}[pair.split("_").index(name)] * force for pair, force in between.items() if name in pair.split("_"))
            scale = np.abs(momentum).max() + np.abs(rate[1:] * steps).sum() + 1e-6
            error = np.abs(momentum[1:] - momentum[0] - np.cumsum(rate[1:] * steps)).max() / scale
            self.note("momentum of a body off its impulse", error)
            assert error < self.bound(1e-10, 1e-4), f"the momentum {axis} of {name} is {error:.3g} off the impulse on it"

    def check_energy(self, values):
        """Contact takes energy, and none comes from nothing."""
        start = values["energy_kinetic"][0]
        given = values["work_gravity"] + values["work_rigids"]
        scale = start + np.abs(given).max()
        added = values["work_contact"].max() / scale
        self.note("energy that contact adds over the kinetic one", max(added, 0))
        assert added < 0.01, f"contact adds {added:.3g} of the kinetic energy at the start"
        grown = (values["energy_kinetic"] + values["energy_elastic"] + values["energy_lost"] - start - given).max() / scale
        self.note("kinetic and elastic energy from nothing", grown)
        assert grown < 0.03, f"kinetic and elastic energy grow by {grown:.3g} of the kinetic one at the start from nothing"
        for name in (name for name in values if name.endswith("_friction_work")):
            back = -np.diff(values[name]).min() / scale
            self.note("work that friction gives back", max(back, 0))
            assert back < 1e-3, f"{name} falls by {back:.3g} of the kinetic energy at the start"

    def compare(self, whole):
        """The mirror image across the middle of the mesh along the row."""
        image = self.scene.mirrored(self.options)
        if not self.exact or image is None:
            return
        axis = self.axes[self.scene.along]
        mine, theirs = history(self.go("image", options=image)), history(whole)
        for name in self.names:
            a, b = mine[f"{name}_momentum_{axis}"], -theirs[f"{name}_momentum_{axis}"]
            error = np.abs(a - b).max() / (np.abs(b).max() + 1e-3 * np.abs(theirs[f"{name}_mass"]).max())
            self.note("difference of the mirror image", error)
            assert error < 1e-5, f"{name}: the momentum {axis} of the mirror image differs by {error:.3g}"

    @classmethod
    def fault_of_all(cls, noted, count):
        touched = sum(noted.get("touched", []))
        return f"bodies touch in {touched:g} of {count} decks alone" if touched < count // 2 else ""
