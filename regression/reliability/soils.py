#!/usr/bin/env python3
"""Several soils in touch, with fractions of F-bar and strengths of particles of their own: random decks.

    soils.py MPM [--count 60] [--seed 1] [--only K,...] [--dims 2,3] [--precisions double,single] [--keep FOLDER]

Two or three soils of different laws lie in layers or side by side, with their borders inside of cells, and slump. The run or
a soil may have an -f_bar_fraction, and a file may give each particle of a soil its own su or cohesion: a random field. Checked:

- what collapses.py demands of a run: its end, finite numbers, all mass, and no energy out of nothing;
- each soil has the fraction of F-bar that the rule says, also one that dilates beside clay;
- first and last frame hold the strengths of the file, in the file's order, and soils without own strengths have none;
- no stress of von_mises and tresca is beyond the particle's own strength;
- another strategy, back end and number of ranks gives the same particles to round-off;
- a run that starts from the last frame or checkpoint has the same strengths;
- on one core a restart from a checkpoint half-way reaches the same bits.
"""
import argparse
import json
import math
import pathlib
import random
import shutil
import sys
import tempfile

import h5py
import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import collapses  # noqa: E402
import particles  # noqa: E402
from collapse_decks import Deck  # noqa: E402
from folders import checkpoints, frames, run  # noqa: E402

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


def random_deck(seed, k, dims, precisions, folder):
    """The deck, and of each soil its fraction of F-bar and the strengths of its particles, or None."""
    for attempt in range(100):
        dice = random.Random(f"soils {seed} {k} {attempt}")
        dim, h = dice.choice(dims), round(math.exp(dice.uniform(math.log(0.05), math.log(1))), 3)
        per_cell = dice.choice([1, 2, 2, 2, 3]) if dim == 2 else dice.choice([1, 2, 2])
        boxes, extent = soils_of(dice, dim, h)
        lattice = particles.lattice([0] * dim, boxes[-1][1], h / per_cell)
        inside = [((lattice > lower) & (lattice < upper)).all(axis=1) for lower, upper in boxes]
        if all(rows.any() for rows in inside):
            break
    names = [f"soil{n}" for n in range(len(boxes))]
    o = {"dim": dim, "mesh_lower": (0,) * dim, "mesh_upper": tuple(round(x, 9) for x in extent), "mesh_spacing": h,
         f"mesh_{'yz'[dim - 2]}min": "fixed", "gravity": (0,) * (dim - 1) + (-9.81,), "precision": dice.choice(precisions),
         "velocity_update": dice.choice(["flip", "flip", "xpic", "apic"]), "damping": dice.choice([0, 0, 0.2]),
         "materials": ",".join(names), "bodies": ",".join(f"body{n}" for n in range(len(boxes)))}
    pressure = 1800 * 9.81 * boxes[-1][1][-1]
    strengths, speed = {}, 0
    for n, (soil, (lower, upper)) in enumerate(zip(names, boxes)):
        strength, body = draw_law(dice, o, soil, pressure), f"body{n}"
        o.update({f"{body}_material": soil, f"{body}_particles_per_cell": per_cell})
        speed = max(speed, math.sqrt(4 * o[f"{soil}_young"] / o[f"{soil}_density"]))
        strengths[body] = None
        if strength and dice.random() < 0.6:
            position = lattice[inside[n]]
            strengths[body] = field(dice, position, strength, extent[-1])
            path = folder / f"{body}.h5"
            particles.write(path, body, position, h / per_cell, **{key_of(o[f"{soil}_model"]): strengths[body]})
            o.update({f"{body}_shape": "particles", f"{body}_file": str(path)})
        else:
            o.update({f"{body}_shape": "box", f"{body}_lower": tuple(lower), f"{body}_upper": tuple(upper)})
    fractions = draw_f_bar(dice, o, names)
    o["time_end"] = float(f"{STEPS * 0.3 * h / speed:.3g}")
    return Deck(f"{k}", o), fractions, strengths, dice


def ways(dice):
    """Options and ranks of two machines."""
    def way():
        backend = dice.choice(["serial", "openmp"])
        strategies = ["atomic", "mosaic", "gather", "tile"] + ["sequential"] * (backend == "serial")
        return ["-backend", backend, "-p2g", dice.choice(strategies)], dice.choice([1, 1, 2, 3])
    return way(), way()


def group_of(path, body):
    with h5py.File(path) as file:
        return {key: item[()] for key, item in file[body].items()}


class Case:
    """One deck, and what is wrong with it."""

    def __init__(self, program, folder, seed, k, dims, precisions):
        self.program, self.folder = program, folder
        self.deck, self.fractions, self.strengths, self.dice = random_deck(seed, k, dims, precisions, folder)
        self.single = self.deck.options["precision"] == "single"
        (folder / "deck.opts").write_text(self.deck.text())
        self.end = self.deck.options["time_end"]

    def launch(self, name, way, *options):
        prefix = ("mpirun", "-n", str(way[1]), "--bind-to", "none") if way[1] > 1 else ()
        run(self.program, self.folder / "deck.opts", self.folder / name, *way[0], *options, prefix=prefix)
        return self.folder / name

    def model_of(self, body):
        return self.deck.options[self.deck.options[f"{body}_material"] + "_model"]

    def faults(self):
        way, other = ways(self.dice)
        out = self.launch("out", way, "-output_interval", self.end, "-checkpoint_interval", self.end / 2)
        yield from collapses.faults_of(self.deck, 0, "", self.folder)
        yield from self.f_bar_faults(out)
        for frame in (frames(out)[0], frames(out)[-1]):
            yield from self.strength_faults(frame)
        yield from self.yield_faults(frames(out)[-1])
        if not self.single:
            yield from self.way_faults(way, other)
        yield from self.start_faults(out, other)
        if way == (["-backend", "serial", *way[0][2:]], 1):
            yield from self.restart_faults(out, way)

    def f_bar_faults(self, out):
        options = json.loads((out / "options.json").read_text())["options"]
        for soil, fraction in self.fractions.items():
            told = options[f"{soil}_f_bar_fraction"]
            if float(told) != fraction:
                yield f"-{soil}_f_bar_fraction is {told} where the rule says {fraction}"

    def strength_faults(self, frame):
        for body, own in self.strengths.items():
            found, key = group_of(frame, body), key_of(self.model_of(body))
            if own is None:
                if key in found:
                    yield f"{frame.name}: {body} has {key}, which its file does not give"
                continue
            wanted = own.astype(np.float32) if self.single else own
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
            if not beyond <= (1 + 1e-4 if self.single else 1 + 1e-10):
                yield f"{frame.name}: {body} of {model} bears {beyond:.8g} times its strength"

    def way_faults(self, way, other):
        short = ("-time_end", self.end / 10, "-output_interval", self.end / 10)
        one, two = (frames(self.launch(name, how, *short))[-1] for name, how in (("one", way), ("two", other)))
        for body in self.strengths:
            a, b = group_of(one, body), group_of(two, body)
            for key in a:
                if a[key].shape != b[key].shape:
                    yield f"{way} and {other} have other numbers of particles"
                    return
                apart = np.abs(a[key] - b[key]).max() / max(np.abs(a[key]).max(), 1e-300)
                if not apart <= ROUND_OFF and key != "plastic_strain":
                    yield f"{key} of {body} differs by {apart:.3g} of the largest between {way} and {other}"

    def start_faults(self, out, way):
        source = self.dice.choice([frames(out)[-1], checkpoints(out)[-1]])
        more = []
        for body in self.strengths:
            more += [f"-{body}_shape", "particles", f"-{body}_file", source]
        lines = (self.folder / "deck.opts").read_text().splitlines()
        left_out = tuple(f"-{body}_{key} " for body in self.strengths for key in ("lower", "upper", "shape", "file"))
        (self.folder / "start.opts").write_text("\n".join(line for line in lines if not line.startswith(left_out)) + "\n")
        prefix = ("mpirun", "-n", str(way[1]), "--bind-to", "none") if way[1] > 1 else ()
        run(self.program, self.folder / "start.opts", self.folder / "start", *way[0], *more, "-time_end", self.end / 20,
            "-output_interval", self.end / 20, prefix=prefix)
        for frame in (frames(self.folder / "start")[0], frames(self.folder / "start")[-1]):
            for fault in self.strength_faults(frame):
                yield f"started from {source.name}: {fault}"

    def restart_faults(self, out, way):
        shutil.copytree(out, self.folder / "again")
        first = checkpoints(self.folder / "again")[0]
        again = self.launch("again", way, "-output_interval", self.end, "-checkpoint_interval", self.end / 2, "-restart", first)
        for body in self.strengths:
            a, b = group_of(frames(out)[-1], body), group_of(frames(again)[-1], body)
            if any((a[key] != b[key]).any() for key in a):
                yield f"a restart from {first.name} reaches another state of {body}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="numbers of decks, with commas")
    parser.add_argument("--dims", default="2,3")
    parser.add_argument("--precisions", default="double,single")
    parser.add_argument("--keep", type=pathlib.Path, help="where folders of decks that fail are kept")
    arguments = parser.parse_args()
    numbers = [int(k) for k in arguments.only.split(",")] if arguments.only else range(arguments.count)
    program, failed = pathlib.Path(arguments.program).resolve(), 0
    dims, precisions = [int(d) for d in arguments.dims.split(",")], arguments.precisions.split(",")
    for k in numbers:
        with tempfile.TemporaryDirectory(prefix="mpm_soils_") as name:
            case = Case(program, pathlib.Path(name), arguments.seed, k, dims, precisions)
            try:
                faults = list(case.faults())
            except (AssertionError, OSError, KeyError) as error:
                faults = [f"{type(error).__name__}: {error}"]
            own = sum(values is not None for values in case.strengths.values())
            laws = ", ".join(case.model_of(body) for body in case.strengths)
            print(f"{'FAIL' if faults else 'ok  '} {k}: {case.deck.dim}D, {laws}; {own} with own strengths", flush=True)
            for fault in faults:
                print(f"  {fault}", flush=True)
            failed += bool(faults)
            if faults and arguments.keep:
                shutil.copytree(name, arguments.keep / str(k), dirs_exist_ok=True)
    print(f"{len(numbers) - failed} of {len(numbers)} decks of several soils are as they should be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
