"""Several soils in touch, with fractions of F-bar and strengths of particles of their own.

Two or three soils of different laws lie in layers or side by side, with their borders inside of cells, and slump. The run or
a soil may have an -f_bar_fraction, and a file may give each particle of a soil its own su or cohesion: a random field. Checked:

- what collapses.py demands of a run: its end, finite numbers, all mass, and no energy out of nothing;
- each soil has the fraction of F-bar that the rule says, also one that dilates beside clay;
- first and last frame hold the strengths of the file, in the file's order, and soils without own strengths have none;
- no stress of von_mises and tresca is beyond the particle's own strength;
- another strategy, back end and number of ranks gives the same particles to round-off;
- a run that starts from the last frame or checkpoint has the same strengths.
"""
import json
import math

import h5py
import numpy as np

from collapse_decks import Options
from collapses import Collapses
from mpm_regression import particles
from mpm_regression.folders import checkpoints, frames

CLAY = ("von_mises", "tresca", "softening_clay")
FRICTION = ("mohr_coulomb", "drucker_prager")
STEPS = 250  # of a run, about
ROUND_OFF = 1e-8


def key_of(model):
    """The parameter that a file may give each particle."""
    return "su" if model in CLAY else "cohesion" if model in FRICTION else None


def draw_law(dice, o, soil, pressure):
    """A law for a soil that carries about a pressure [Pa] at its base; its strength, or None."""
    model = dice.choice([*CLAY, *FRICTION, "mohr_coulomb", "linear_elastic"])
    strength = float(f"{pressure * dice.uniform(0.1, 1):.4g}")
    o.update({f"{soil}_model": model, f"{soil}_density": round(dice.uniform(1500, 2200)),
              f"{soil}_young": float(f"{pressure * dice.uniform(200, 800):.4g}"), f"{soil}_poisson": round(dice.uniform(0.25, 0.45), 3)})
    if model in CLAY:
        o[f"{soil}_su"] = strength
    if model == "softening_clay":
        o.update({f"{soil}_remoulded_ratio": round(dice.uniform(0.3, 0.9), 3), f"{soil}_xi95": round(dice.uniform(1, 5), 3)})
    if model in FRICTION:
        friction = round(dice.uniform(10, 40), 3)
        o.update({f"{soil}_cohesion": strength, f"{soil}_friction_deg": friction})
        if dice.random() < 0.6:
            o[f"{soil}_dilation_deg"] = round(dice.uniform(1, friction), 3)
    if model == "drucker_prager":
        o[f"{soil}_match"] = dice.choice(["compression", "extension", "plane_strain"])
    return strength if key_of(model) else None


def draw_f_bar(dice, o, soils):
    """The options of F-bar, and the fraction that each soil then has. F-bar is not for soil that dilates."""
    of_run = dice.choice([None, None, 0, 0.5, 0.9, 1])
    if of_run is not None:
        o["f_bar_fraction"] = of_run
    fractions = {}
    for soil in soils:
        dilates = o.get(f"{soil}_dilation_deg", 0) > 0
        fractions[soil] = of_run if of_run is not None else 0 if dilates else 0.98
        if dilates and of_run:
            fractions[soil] = o[f"{soil}_f_bar_fraction"] = 0
        elif not dilates and dice.random() < 0.4:
            fractions[soil] = o[f"{soil}_f_bar_fraction"] = round(dice.uniform(0, 1), 3)
    return fractions


def field(dice, position, mean, size):
    """A smooth random strength, log-normal about a mean."""
    waves = np.zeros(len(position))
    for _ in range(4):
        direction = np.array([dice.uniform(-1, 1) for _ in range(position.shape[1])])
        waves += dice.uniform(-0.4, 0.4) * np.cos(2 * math.pi * position @ direction / size + dice.uniform(0, 6))
    return mean * np.exp(waves)


def soils_of(dice, dim, h):
    """Lower and upper corner of each soil [m], and the mesh's upper corner."""
    count = dice.choice([2, 2, 3])
    wide, deep, high = (dice.randint(5, 12), 0, dice.randint(5, 10)) if dim == 2 else (dice.randint(4, 6), dice.randint(2, 3), dice.randint(4, 6))
    along = dice.choice([0, dim - 1])
    size = [wide * h, high * h] if dim == 2 else [wide * h, deep * h, high * h]
    inner = sorted(dice.uniform(0.15, 0.85) for _ in range(count - 1))
    cuts = [0, *(x * size[along] for x in inner), size[along]]
    boxes = []
    for a, b in zip(cuts, cuts[1:]):
        lower, upper = [0.0] * dim, list(size)
        lower[along], upper[along] = round(a, 6), round(b, 6)
        boxes.append((lower, upper))
    run_out = [2 * wide * h, (high + 2) * h] if dim == 2 else [2 * wide * h, deep * h, (high + 2) * h]
    return boxes, run_out


def group_of(path, body):
    with h5py.File(path) as file:
        return {key: item[()] for key, item in file[body].items()}


class Soils(Collapses):
    precisions = ("double", "single")
    strategies = ("sequential", "atomic", "mosaic", "gather", "tile")
    ranks = (1, 1, 2, 3)
    threads, partitions = (1,), ("box",)
    restarts = 0.35
    frame_options = []

    @classmethod
    def names(cls, given):
        return []

    def draw_deck(self):
        """`fractions` of F-bar by soil; `strengths` of the particles by body, or None."""
        dice, dim, inside = self.draw, self.dim, [np.zeros(1)]
        while not all(rows.any() for rows in inside) or thinnest < 0.51:
            h = round(math.exp(dice.uniform(math.log(0.05), math.log(1))), 3)
            per_cell = dice.choice([1, 2, 2, 2, 3]) if dim == 2 else dice.choice([1, 2, 2])
            boxes, extent = soils_of(dice, dim, h)
            lattice = particles.lattice([0] * dim, boxes[-1][1], h / per_cell)
            # The lattice of a box follows the box, which then needs half a particle's width.
            thinnest = min(np.subtract(upper, lower).min() for lower, upper in boxes) * per_cell / h
            inside = [((lattice > lower) & (lattice < upper)).all(axis=1) for lower, upper in boxes]
        names = [f"soil{n}" for n in range(len(boxes))]
        o = {"dim": dim, "mesh_lower": (0,) * dim, "mesh_upper": tuple(round(x, 9) for x in extent), "mesh_spacing": h,
             f"mesh_{self.up}min": "fixed", "gravity": (0,) * (dim - 1) + (-9.81,),
             "velocity_update": dice.choice(["flip", "flip", "xpic", "apic"]), "damping": dice.choice([0, 0, 0.2]),
             "materials": ",".join(names), "bodies": ",".join(f"body{n}" for n in range(len(boxes)))}
        self.deck, self.strengths, self.speed = Options("", o), {}, 0
        for n, (box, rows) in enumerate(zip(boxes, inside)):
            self.add_soil(f"soil{n}", f"body{n}", box, lattice[rows], h / per_cell, extent[-1])
            o[f"body{n}_particles_per_cell"] = per_cell
        self.fractions = draw_f_bar(dice, o, names)
        self.deck.name = ", ".join(map(self.model_of, self.strengths))
        o["time_end"] = end = float(f"{STEPS * 0.3 * h / self.speed:.3g}")
        self.end, o["output_interval"] = end, end
        o["checkpoint_interval"] = end / 2

    def add_soil(self, soil, body, box, position, width, high):
        """A law, and a box or particles with strengths of their own."""
        dice, o = self.draw, self.deck.options
        strength = draw_law(dice, o, soil, 1800 * 9.81 * high)
        self.speed = max(self.speed, math.sqrt(4 * o[f"{soil}_young"] / o[f"{soil}_density"]))
        self.strengths[body], o[f"{body}_material"] = None, soil
        if strength and dice.random() < 0.6:
            self.strengths[body] = field(dice, position, strength, high)
            path = self.folder / f"{body}.h5"
            particles.write(path, body, position, width, **{key_of(o[f"{soil}_model"]): self.strengths[body]})
            o.update({f"{body}_shape": "particles", f"{body}_file": str(path)})
        else:
            o.update({f"{body}_shape": "box", f"{body}_lower": tuple(box[0]), f"{body}_upper": tuple(box[1])})

    def model_of(self, body):
        return self.deck.options[self.deck.options[f"{body}_material"] + "_model"]

    def faults(self, folder):
        yield from super().faults(folder)
        options = json.loads((folder / "options.json").read_text())["options"]
        for soil, fraction in self.fractions.items():
            given = options[f"{soil}_f_bar_fraction"]
            if float(given) != fraction:
                yield f"-{soil}_f_bar_fraction is {given} where the rule says {fraction}"
        for frame in (frames(folder)[0], frames(folder)[-1]):
            yield from self.strength_faults(frame)
        yield from self.yield_faults(frames(folder)[-1])

    def strength_faults(self, frame):
        for body, own in self.strengths.items():
            found, key = group_of(frame, body), key_of(self.model_of(body))
            if own is None:
                if key in found:
                    yield f"{frame.name}: {body} has {key}, which its file does not give"
                continue
            wanted = own if self.exact else own.astype(np.float32)
            # Particles that have left the run are missing from the frame.
            if key not in found or not np.isin(found[key], wanted).all() or (len(found[key]) == len(own) and (found[key] != wanted).any()):
                yield f"{frame.name}: {key} of {body} is not that of its file"

    def yield_faults(self, frame):
        for body, own in self.strengths.items():
            model = self.model_of(body)
            if model not in ("von_mises", "tresca"):
                continue
            found, soil = group_of(frame, body), self.deck.options[f"{body}_material"]
            su = found["su"] if own is not None else self.deck.options[f"{soil}_su"]
            s = found["stress"].astype(float)
            deviator = s[:, :3] - s[:, :3].mean(axis=1, keepdims=True)
            size = np.sqrt((deviator**2).sum(axis=1) / 2 + (s[:, 3:]**2).sum(axis=1))
            beyond = (size / (su * (1 if model == "von_mises" else 2 / math.sqrt(3)))).max()
            if not beyond <= 1 + self.bound(1e-10, 1e-4):
                yield f"{frame.name}: {body} of {model} bears {beyond:.8g} times its strength"

    def compare(self, whole):
        other = self.draw_machine(self.ranks)
        if self.exact:
            self.check_machines(other)
        self.check_start(self.draw.choice([frames(whole)[-1], checkpoints(whole)[-1]]), other)

    def check_machines(self, other):
        """A short run on two machines."""
        short = ("-time_end", self.end / 10, "-output_interval", self.end / 10)
        one, two = (frames(self.go(name, *short, machine=machine))[-1] for name, machine in (("one", self.machine), ("two", other)))
        for body in self.strengths:
            a, b = group_of(one, body), group_of(two, body)
            for key in a:
                assert a[key].shape == b[key].shape, f"{self.machine} and {other} have other numbers of particles"
                apart = np.abs(a[key] - b[key]).max() / max(np.abs(a[key]).max(), 1e-300)
                assert apart <= ROUND_OFF or key == "plastic_strain", f"{key} of {body} differs by {apart:.3g} between {self.machine} and {other}"

    def check_start(self, source, machine):
        """A run that starts from a frame or a checkpoint."""
        left_out = tuple(f"-{body}_{key}" for body in self.strengths for key in ("lower", "upper", "shape", "file"))
        kept = [word for pair in zip(self.options[::2], self.options[1::2]) if pair[0] not in left_out for word in pair]
        more = [word for body in self.strengths for word in (f"-{body}_shape", "particles", f"-{body}_file", source)]
        start = self.go("start", *more, "-time_end", self.end / 20, "-output_interval", self.end / 20, options=kept, machine=machine)
        faults = [fault for frame in (frames(start)[0], frames(start)[-1]) for fault in self.strength_faults(frame)]
        assert not faults, f"started from {source.name}: " + "\n".join(faults)
