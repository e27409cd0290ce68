#!/usr/bin/env python3
"""Random runs of stages, against runs without stages, restarts, and other ranks.

    stages.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

A deck has soil of one to three bodies under gravity, up to two rigid bodies, and two to four stages, of which each changes some
loads, walls, contacts, damping, the clay and intervals of output, or removes a body. Checked are, bit by bit: a run that is cut
in two by a checkpoint at any step; a first stage and a restart with -restart_change in the place of the second stage; stages
that change nothing in the place of one run. On two ranks positions must be the same to round-off. Mass is lost by removal alone.
"""
import sys

import h5py
import numpy as np

from folders import checkpoints, contents, frames, fresh, rows, run
from random_decks import draws_of, read_arguments

DT, STEPS = 1e-3, (20, 60)  # s; least and most steps of a stage


def vector(values):
    return ",".join(repr(float(x)) for x in values)


class Deck:
    def __init__(self, draw, dim):
        self.dim, self.draw = dim, draw
        across = [3.0, 2.5] if dim == 2 else [3.0, 1.5, 2.5]
        self.bodies = ["left", "right", "top"][:draw.randint(1, 3)]
        self.rigids = draw.sample(["plate", "pile"], draw.randint(0, 2))
        zero, flat = [0.0] * dim, [0.0] * (dim - 2)
        boxes = {"left": ([0.0, *flat, 0.0], [1.5, *across[1:-1], 1.0]), "right": ([1.5, *flat, 0.0], [3.0, *across[1:-1], 1.0]),
                 "top": ([0.5, *flat, 1.0], [1.0, *across[1:-1], 1.5])}
        self.options = (f"-dim {dim} -mesh_lower {vector(zero)} -mesh_upper {vector(across)} -mesh_spacing 0.25 -time_step {DT} "
                        f"-gravity {vector([0.0] * (dim - 1) + [-9.81])} -materials clay -clay_model von_mises -clay_density 1500 "
                        f"-clay_young 1e6 -clay_poisson 0.3 -clay_su {draw.choice([800, 5000])} -bodies {','.join(self.bodies)} "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -output_interval {DT * 17} "
                        f"-history_interval {DT * 7}").split()
        for name in self.bodies:
            lower, upper = boxes[name]
            self.options += f"-{name}_shape box -{name}_material clay -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
        if self.rigids:
            self.options += ["-rigid_bodies", ",".join(self.rigids)]
        for k, name in enumerate(self.rigids):
            lower = [1.2 + 0.9 * k, *[0.3] * (dim - 2), 1.1]
            self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector([x + 0.6 for x in lower])}".split()
            self.options += draw.choice([[], [f"-{name}_friction", "0.3"]])
        self.stages = ["one", "two", "three", "four"][:draw.randint(2, 4)]
        self.steps = [draw.randint(*STEPS) for _ in self.stages]
        self.changes = [[]] + [self.some_changes(draw) for _ in self.stages[1:]]
        self.removed = {}
        if len(self.bodies) > 1 and draw.random() < 0.5:
            self.removed = {draw.randrange(1, len(self.stages)): self.bodies[-1]}

    def some_changes(self, draw):
        found, dim = [], self.dim
        if draw.random() < 0.5:
            found.append(("gravity", vector([draw.uniform(-2, 2) for _ in range(dim - 1)] + [draw.uniform(-12, -5)])))
        if draw.random() < 0.4:
            found.append(("damping", draw.choice(["0", "0.3", "0.7"])))
        if draw.random() < 0.3:
            found.append((draw.choice(["mesh_xmin", "mesh_xmax", "mesh_ymin"]), draw.choice(["fixed", "roller"])))
        if draw.random() < 0.4:
            found.append(draw.choice([("clay_su", "2000"), ("clay_young", "1.5e6"), ("clay_poisson", "0.4")]))
        for name in self.rigids:
            if draw.random() < 0.5:
                motion = draw.choice(["fixed", "prescribed", "dynamic"])
                found.append((f"{name}_motion", motion))
                if motion != "fixed":
                    found.append((f"{name}_velocity", vector([draw.uniform(-0.3, 0.3) for _ in range(dim)])))
                if motion == "dynamic":
                    found.append((f"{name}_density", "1800"))
            if draw.random() < 0.3:
                found.append((f"{name}_friction", draw.choice(["0.1", "0.5"])))
        return found

    def times(self, number):
        return f"{self.steps[number] * DT:.12g}"

    def staged(self):
        words = [*self.options, "-stages", ",".join(self.stages)]
        for k, stage in enumerate(self.stages):
            words += [f"-{stage}_time_end", self.times(k)]
            for key, value in self.changes[k]:
                words += [f"-{stage}_{key}", value]
            if k in self.removed:
                words += [f"-{stage}_remove", self.removed[k]]
        return words


def fields_of(path, bodies):
    """Fields of the bodies, without the attributes of the frame."""
    return {key: value for key, value in contents(path).items() if key.split("/")[0] in bodies}


def same(one, other, bodies, what):
    a, b = fields_of(one, bodies), fields_of(other, bodies)
    differ = [key for key in sorted(a.keys() | b.keys()) if a.get(key) != b.get(key)]
    assert not differ, f"{what}: {differ[:6]}"


class Checks:
    def __init__(self, binary, base):
        self.binary, self.base, self.empty = binary, base, base / "empty.opts"
        self.empty.write_text("\n")

    def run(self, name, *options, ranks=1, fresh_folder=True):
        folder = fresh(self.base / name) if fresh_folder else self.base / name
        prefix = ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()
        run(self.binary, self.empty, folder, *options, prefix=prefix)
        return folder

    def cut(self, deck, common, whole):
        """A checkpoint at any step."""
        total = sum(deck.steps)
        at = deck.draw.choice([deck.draw.randint(1, total - 1), deck.steps[0], sum(deck.steps[:2])])
        at = min(at, total - 1)
        self.run("cut", *deck.staged(), *common, "-time_max_steps", at, "-checkpoint_interval", 1e3)
        folder = self.run("cut", *deck.staged(), *common, "-restart", checkpoints(self.base / "cut")[-1], fresh_folder=False)
        kept = [line for line in rows(folder) if line in rows(whole)]
        assert kept == rows(whole), f"cut at step {at}: {len(rows(whole)) - len(kept)} rows of {len(rows(whole))} differ"
        same(frames(folder)[-1], frames(whole)[-1], [*deck.bodies, *deck.rigids], f"cut at step {at}, last frame")

    def restart(self, deck, common):
        """The second stage by -restart_change."""
        if deck.removed.get(1):
            return
        two = [*deck.options, "-stages", "one,two"]
        for k in (0, 1):
            two += [f"-{deck.stages[k]}_time_end", deck.times(k)]
        two += [word for key, value in deck.changes[1] for word in (f"-two_{key}", value)]
        staged = self.run("staged", *two, *common)
        first = self.run("first", *deck.options, *common, "-time_end", deck.times(0), "-checkpoint_interval", 1e3)
        changed = dict(deck.changes[1])
        words = [word for key, value in changed.items() for word in (f"-{key}", value)]
        kept, options = [], deck.options
        for k in range(0, len(options), 2):
            if options[k][1:] not in changed:
                kept += options[k:k + 2]
        end = f"{(deck.steps[0] + deck.steps[1]) * DT:.12g}"
        listed = ["-restart_change", ",".join(changed)] if changed else []
        again = self.run("first", *kept, *words, *common, "-time_end", end, "-restart", checkpoints(first)[-1], *listed,
                         fresh_folder=False)
        same(frames(again)[-1], frames(staged)[-1], [*deck.bodies, *deck.rigids], "a restart in the place of a stage")

    def plain(self, deck, common):
        """Stages that change nothing."""
        words = [*deck.options, "-stages", ",".join(deck.stages)]
        for k, stage in enumerate(deck.stages):
            words += [f"-{stage}_time_end", deck.times(k)]
        staged = self.run("staged", *words, *common)
        plain = self.run("plain", *deck.options, *common, "-time_end", f"{sum(deck.steps) * DT:.12g}")
        same(frames(plain)[-1], frames(staged)[-1], [*deck.bodies, *deck.rigids], "stages that change nothing")

    def ranks(self, deck, common, whole, precision):
        pair = self.run("pair", *deck.staged(), *common, ranks=2)
        small = 1e-9 if precision == "double" else 1e-3
        with h5py.File(frames(pair)[-1]) as a, h5py.File(frames(whole)[-1]) as b:
            for body in deck.bodies:
                x, y = a[body]["position"][()], b[body]["position"][()]
                assert x.shape == y.shape, f"two ranks: {x.shape} of {y.shape} particles of {body}"
                assert x.size == 0 or np.abs(x - y).max() < small, f"two ranks: {body} is {np.abs(x - y).max():.3g} m off"

    def history(self, deck, whole):
        lines = rows(whole)
        column = [int(line[lines[0].index("stage")]) for line in lines[1:]]
        assert sorted(set(column)) == list(range(1, len(deck.stages) + 1)) and column == sorted(column), f"stages {column}"
        steps = [int(line[0]) for line in lines[1:]]
        for k in range(len(deck.stages)):
            last = max(s for s, c in zip(steps, column) if c == k + 1)
            assert last == sum(deck.steps[:k + 1]), f"stage {k + 1} ends at step {last} of {deck.steps}"
        for name in deck.bodies:
            mass = np.array([float(line[lines[0].index(f"{name}_mass")]) for line in lines[1:]])
            lost = np.array([float(line[lines[0].index(f"{name}_lost_mass")]) for line in lines[1:]])
            gone = [k for k, body in deck.removed.items() if body == name]
            expected = np.array([mass[0] if not gone or c <= gone[0] else 0 for c in column])
            assert np.abs(mass - expected).max() < 1e-5 * mass[0], f"{name}: mass {mass} of {expected}"
            assert np.abs(mass + lost - mass[0]).max() < 1e-5 * mass[0], f"{name}: lost {lost}"


def main():
    given, base = read_arguments(__doc__, "stages")
    checks = Checks(given.binary, base)
    for number in range(given.count):
        draw = draws_of(given, number)
        deck = Deck(draw, int(draw.choice(given.dims.split(","))))
        precision = draw.choice(given.precisions.split(","))
        common = ["-backend", draw.choice(["serial", "openmp"]), "-precision", precision, "-p2g", "tile"]
        try:
            whole = checks.run("whole", *deck.staged(), *common)
            checks.history(deck, whole)
            checks.cut(deck, common, whole)
            checks.restart(deck, common)
            checks.plain(deck, common)
            if draw.random() < 0.4:
                checks.ranks(deck, common, whole, precision)
        except AssertionError as error:
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\n{' '.join(map(str, [*deck.staged(), *common]))}")
    print(f"{given.count} decks: cut runs, restarts in the place of stages and stages that change nothing give the same bits")


if __name__ == "__main__":
    main()
