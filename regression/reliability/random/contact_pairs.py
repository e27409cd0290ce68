"""Deformable bodies that meet in pairs, in free space, of two to four materials and laws of contact.

What each body gains of momentum is the impulse of its pairs, and all together keep theirs; contact never adds energy but for
round-off of the bodies' vibration; the mirror image moves as the mirror.
"""
import itertools

import numpy as np

from deck import Deck, changer, rounded, vector
from mpm_regression.folders import history


class ContactPairs(Deck):
    strategies = ("tile", "tile", "gather", "sequential", "mosaic")
    ranks = (1, 1, 2)
    sums = ("energy_", "work_", *(f"{one}_{two}_" for one, two in itertools.combinations("abcd", 2)))
    apart = {"double": 1e-6, "single": 0.2}  # bodies that slide amplify round-off

    def make(self):
        draw, dim = self.draw, self.dim
        self.cell = 0.1
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector([3, *[1.2] * (dim - 2), 1.6])} -mesh_spacing {self.cell} "
                        + "".join(f"-mesh_{axis}{end} free " for axis in self.axes for end in ("min", "max"))
                        + "-time_end 0.15 -time_step 4e-4 -history_interval 0.0025 -output_interval 0.05 -output_energy on").split()
        self.options += ["-f_bar_fraction", draw.choice(["0", "0.98"]), "-velocity_update", draw.choice(["flip", "apic"]),
                         "-particle_domain", draw.choice(["fixed", "fixed", "stretch"])]
        names = draw.choice([["a", "b"], ["a", "b", "c"], ["a", "b", "c", "d"]])
        self.clay = [draw.random() < 0.5 for _ in names]
        self.options += ["-materials", ",".join(f"m{name}" for name in names), "-bodies", ",".join(names)]
        for k, name in enumerate(names):
            self.options += self.body(name, k, len(names))
        self.pairs = [f"{one}:{two}" for one, two in itertools.combinations(names, 2)]
        self.options += ["-contact_pairs", ",".join(self.pairs)]
        for one, two in itertools.combinations(range(len(names)), 2):
            self.options += self.law(f"{names[one]}_{names[two]}", self.clay[one] and self.clay[two])
        if self.options[-1] == "weld" and len(names) == 2:
            self.pairs = []  # the two share a velocity field, and have no columns
        self.names = names

    def body(self, name, k, count):
        """Bodies along x, which move towards the middle; each is a box or a disc. No particle begins on a face of a cell, whose mean round-off would choose."""
        draw, dim = self.draw, self.dim
        width = 2.6 / count
        middle = [0.2 + width * (k + 0.5) + draw.uniform(0.005, 0.02), *[0.6] * (dim - 2), 0.8 + draw.uniform(-0.15, 0.15)]
        half = 0.025 * int((0.5 * width - draw.uniform(0.001, 0.03)) / 0.025)  # lattices of boxes have mirror images
        inward = 1.0 - 2.0 * k / (count - 1)
        words = [f"-{name}_material", f"m{name}", f"-{name}_velocity", rounded([inward * draw.uniform(0.5, 2), *[draw.uniform(-0.3, 0.3) for _ in range(dim - 1)]]),
                 f"-m{name}_density", str(draw.choice([800, 1600, 2600])), f"-m{name}_young", str(draw.choice([2e5, 1e6, 3e6])),
                 f"-m{name}_poisson", draw.choice(["0", "0.3", "0.45"]), f"-m{name}_model", "von_mises" if self.clay[k] else "linear_elastic"]
        if self.clay[k]:
            words += [f"-m{name}_su", str(draw.choice([2e3, 2e4]))]
        if draw.random() < 0.4 and half < 0.5:
            return words + [f"-{name}_shape", "disc" if dim == 2 else "ball", f"-{name}_centre", rounded(middle), f"-{name}_radius", f"{half:.6f}",
                            f"-{name}_fill", draw.choice(["centre", "cut"])]
        size = [half, *[draw.uniform(0.2, 0.45) for _ in range(dim - 1)]]
        return words + [f"-{name}_shape", "box", f"-{name}_lower", rounded(m - s for m, s in zip(middle, size)),
                        f"-{name}_upper", rounded(m + s for m, s in zip(middle, size))]

    def law(self, pair, strong):
        draw = self.draw
        choices = [[], ["_friction", "0.3"], ["_friction", "0.8", "_adhesion", "500"], ["_shear_limit", "800"], ["_friction", "0.5", "_shear_limit", "2e3"],
                   ["_contact", "weld"]]
        if strong:
            choices.append(["_shear_fraction", "0.5"])
        words = draw.choice(choices)
        return [f"-{pair}{word}" if word.startswith("_") else word for word in words]

    # ------------------------------------------------------------------------------------------ checks

    def check(self, folder):
        values = history(folder)
        time, steps = values["time"], np.diff(values["time"])
        for axis in self.axes:
            parts = [values[f"{name}_momentum_{axis}"] for name in self.names]
            scale = sum(np.abs(part).max() for part in parts) + sum(np.abs(values[f"{pair.replace(':', '_')}_force_{axis}"][1:] * steps).sum() for pair in self.pairs)
            off = np.abs(sum(parts) - sum(part[0] for part in parts)).max() / scale
            self.note("change of all momentum", off)
            assert off < self.bound(1e-12, 2e-5), f"the momentum {axis} of all bodies changes by {off:.3g}"
        welds = any(word.endswith("_contact") for word in self.options)
        for name in () if welds else self.names:  # welded bodies share momentum too
            for axis in self.axes:
                rate = sum({0: 1, 2: -1}[pair.index(name)] * values[f"{pair.replace(':', '_')}_force_{axis}"] for pair in self.pairs if name in pair)
                momentum = values[f"{name}_momentum_{axis}"]
                scale = np.abs(momentum).max() + np.abs(rate[1:] * steps).sum() + 1e-6
                gained = np.cumsum(rate[1:] * steps)
                error = np.abs(momentum[1:] - momentum[0] - gained).max() / scale
                self.note("momentum of a body off its impulse", error)
                assert error < self.bound(1e-10, 1e-4), f"the momentum {axis} of {name} is {error:.3g} off the impulse on it"
        start = values["energy_kinetic"][0]
        added = values["work_contact"].max() / start
        self.note("energy that contact adds over the kinetic one", max(added, 0))
        assert added < 0.01, f"contact adds {added:.3g} of the kinetic energy at the start"
        after = (values["energy_kinetic"] + values["energy_elastic"]).max() / start
        self.note("largest kinetic and elastic energy over that at the start", after)
        assert after < 1.03, f"kinetic and elastic energy grow to {after:.3g} of that at the start"
        self.note("touched", not self.pairs or any(np.abs(values[f"{pair.replace(':', '_')}_force_x"]).max() > 0 for pair in self.pairs))
        assert time[-1] > 0.149

    def compare(self, whole):
        """The mirror image across the middle plane of x."""
        if not self.exact:
            return
        mine, theirs = history(self.go("image", options=self.mirror())), history(whole)
        for name in self.names:
            a, b = mine[f"{name}_momentum_x"], -theirs[f"{name}_momentum_x"]
            error = np.abs(a - b).max() / (np.abs(b).max() + 1e-9)
            self.note("difference of the mirror image", error)
            assert error < 1e-5, f"{name}: the momentum x of the mirror image differs by {error:.3g}"

    def mirror(self):
        words = list(self.options)
        change = changer(words)
        for name in self.names:
            change(f"-{name}_velocity", lambda v: [-v[0], *v[1:]])
            change(f"-{name}_centre", lambda v: [3 - v[0], *v[1:]])
            if f"-{name}_lower" in words:
                low, high = words.index(f"-{name}_lower") + 1, words.index(f"-{name}_upper") + 1
                a, b = ([float(x) for x in words[k].split(",")] for k in (low, high))
                words[low], words[high] = vector([3 - b[0], *a[1:]]), vector([3 - a[0], *b[1:]])
        return words

    @classmethod
    def fault_of_all(cls, noted, count):
        touched = sum(noted.get("touched", []))
        return f"bodies touch in {touched:g} of {count} decks alone" if touched < count // 2 else ""
