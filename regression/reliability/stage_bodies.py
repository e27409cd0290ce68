#!/usr/bin/env python3
"""Random runs whose stages place and remove bodies and change materials, against restarts, kills and other ranks.

    stage_bodies.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]
                    [--first 0] [--backends serial,openmp]

A deck has two bodies of soil under gravity; stages place up to two lifts of fill, a plate and a pile, remove some of them, change the
materials of bodies and the parameters of materials, loads and damping. Checked are: mass, which comes and goes with what is placed,
cut out and removed alone, to the last particle; loads on faces that a removal bares and on what is placed; zeros in the history for what is not there; bit by bit, runs that are cut in two by
a checkpoint at any step, runs that are killed inside a stage, and both on two or three ranks; positions on one rank against those
on several, to round-off; the dry run, whose stages must be those of the run.
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

import h5py
import numpy as np

from folders import ENVIRONMENT, checkpoints, command, frames, fresh, rows, run
from random_decks import draws_of, read_arguments
from stages import same, vector

DT, STEPS = 5e-4, (20, 60)  # s; least and most steps of a stage
LAWS = {"clay": "-clay_model von_mises -clay_young 1e6 -clay_poisson 0.3 -clay_su 5000 -clay_su_gradient 500 -clay_su_datum 1",
        "hard": "-hard_model linear_elastic -hard_young 4e6 -hard_poisson 0.2",
        "sand": "-sand_model drucker_prager -sand_young 2e6 -sand_poisson 0.25 -sand_friction_deg 32 -sand_cohesion 300 -sand_match plane_strain",
        "soft": "-soft_model softening_clay -soft_young 1.5e6 -soft_poisson 0.45 -soft_su 6000 -soft_remoulded_ratio 0.3 -soft_xi95 2",
        "cured": "-cured_model tresca -cured_young 3e6 -cured_poisson 0.3 -cured_su 2e4"}
PARAMETERS = ["clay_su", "clay_young", "sand_friction_deg", "soft_su", "hard_young", "cured_pore_stiffness", "clay_pore_stiffness"]
VALUES = {"su": (3000, 9000), "young": (1e6, 4e6), "friction_deg": (25, 35), "pore_stiffness": (0, 4e6)}


class Deck:
    def __init__(self, draw, dim):
        self.dim, self.draw = dim, draw
        flat, zero = [0.0] * (dim - 2), [0.0] * dim
        across = [3.0, 2.5] if dim == 2 else [3.0, 1.0, 2.5]
        up = across[1:-1]
        boxes = {"left": ([0.0, *flat, 0.0], [1.5, *up, 1.0]), "right": ([1.5, *flat, 0.0], [3.0, *up, 1.0]),
                 "fill": ([0.25, *flat, 1.0], [1.5, *up, 1.5]), "lift": ([0.5, *flat, 1.5], [1.0, *up, 2.0]),
                 "plate": ([1.7, *flat, 1.0], [2.4, *up, 1.6]), "pile": ([2.55, *flat, 0.5], [2.85, *up, 1.5])}
        self.stages = ["one", "two", "three", "four"][:draw.randint(2, 4)]
        self.steps = [draw.randint(*STEPS) for _ in self.stages]
        self.bodies = ["left", "right", *draw.sample(["fill", "lift"], draw.randint(0, 2))]
        self.bodies.sort(key=["left", "right", "fill", "lift"].index)
        self.rigids = [name for name in ("plate", "pile") if draw.random() < 0.6]
        self.placed, self.removed = {}, {}
        for name in self.bodies[2:] + self.rigids:
            self.placed[name] = draw.randrange(1, len(self.stages))
        for name in self.bodies[1:] + self.rigids:
            later = range(self.placed.get(name, 0) + 1, len(self.stages))
            if later and draw.random() < 0.4:
                self.removed[name] = draw.choice(later)
        self.options = (f"-dim {dim} -mesh_lower {vector(zero)} -mesh_upper {vector(across)} -mesh_spacing 0.25 "
                        f"-gravity {vector([0.0] * (dim - 1) + [-9.81])} -materials {','.join(LAWS)} -bodies {','.join(self.bodies)} "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -output_interval {DT * 17} "
                        f"-history_interval {DT * 7} -damping {draw.choice(['0', '0.2'])} "
                        f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch', 'split'])}").split()
        self.options += draw.choice([["-time_step", str(DT)], ["-time_courant", "0.2"]])
        for name, law in LAWS.items():
            self.options += [f"-{name}_density", draw.choice(["1500", "1800"]), *law.split()]
        if draw.random() < 0.3:
            self.options += ["-output_energy", "on"]
        for name in self.bodies:
            lower, upper = boxes[name]
            self.options += f"-{name}_shape box -{name}_material {draw.choice(list(LAWS))} -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
        if self.rigids:
            self.options += ["-rigid_bodies", ",".join(self.rigids)]
        for name in self.rigids:
            lower, upper = boxes[name]
            self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
            self.options += draw.choice([[], [f"-{name}_friction", "0.3"]])
            self.options += draw.choice([[], f"-{name}_motion dynamic -{name}_density 1900".split(),
                                         f"-{name}_motion prescribed -{name}_velocity {vector([0.0] * (dim - 1) + [-0.1])}".split()])
        for name in self.bodies:
            others = {"left": [], "right": ["plate", "pile"], "fill": ["left", "right", "plate"], "lift": ["fill", "left", "right"]}[name]
            others = [other for other in others if other in self.bodies + self.rigids]
            if others:
                self.options += [f"-{name}_cut_out", ",".join(others)]
        self.changes = [[]] + [self.some_changes(draw) for _ in self.stages[1:]]
        self.add_loads(draw, flat, up)

    def add_loads(self, draw, flat, up):
        """On the side of `left` that the removal of `right` bares, and on the top of what a stage places."""
        loads = []
        if "right" in self.removed and draw.random() < 0.8:
            loads += ["wall"]
            self.options += (f"-wall_body left -wall_stage {self.stages[self.removed['right']]} -wall_lower {vector([1.3, *flat, 0.2])} "
                             f"-wall_upper {vector([1.7, *up, 0.8])} -wall_facing {vector([1.0, *flat, 0.0])}").split()
        if "fill" in self.placed and draw.random() < 0.5:
            loads += ["top"]
            self.options += f"-top_body fill -top_lower {vector([0.0, *flat, 1.4])} -top_upper {vector([1.5, *up, 1.6])}".split()
        for name in loads:
            self.options += draw.choice([f"-{name}_pressure {draw.uniform(500, 3000):.6g}".split(),
                                         [f"-{name}_traction", vector([draw.uniform(-1000, 1000) for _ in range(self.dim)])]])
        if loads:
            self.options += ["-loads", ",".join(loads)]

    def some_changes(self, draw):
        found = []
        for name in self.bodies:
            if draw.random() < 0.4:
                found.append((f"{name}_material", draw.choice(list(LAWS))))
        for name in PARAMETERS:
            if draw.random() < 0.25:
                found.append((name, f"{draw.uniform(*VALUES[name.split('_', 1)[1]]):.6g}"))
        if draw.random() < 0.3:
            found.append(("gravity", vector([draw.uniform(-2, 2) for _ in range(self.dim - 1)] + [draw.uniform(-12, -5)])))
        return found

    def staged(self):
        words = [*self.options, "-stages", ",".join(self.stages)]
        for k, stage in enumerate(self.stages):
            words += [f"-{stage}_time_end", f"{self.steps[k] * DT:.12g}"]
            words += [word for key, value in self.changes[k] for word in (f"-{stage}_{key}", value)]
            for key, table in (("place", self.placed), ("remove", self.removed)):
                names = [name for name, at in table.items() if at == k]
                if names:
                    words += [f"-{stage}_{key}", ",".join(names)]
        return words


def kill_all(process, ranks):
    """Kills a run, and before it the ranks that it has started."""
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    for child in children.read_text().split() if ranks > 1 and process.poll() is None else []:
        os.kill(int(child), signal.SIGKILL)
    process.kill()
    process.wait()


class Checks:
    def __init__(self, binary, base):
        self.binary, self.base, self.empty = binary, base, base / "empty.opts"
        self.empty.write_text("\n")

    def run(self, name, *options, ranks=1, fresh_folder=True, status=0):
        folder = fresh(self.base / name) if fresh_folder else self.base / name
        return folder, run(self.binary, self.empty, folder, *options, prefix=self.launcher(ranks), status=status)

    @staticmethod
    def launcher(ranks):
        return ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()

    def compare(self, deck, folder, whole, what, ranks):
        """Bit by bit, but for the works of several ranks, whose sums begin anew at a restart (to round-off)."""
        def lines(path):
            of = rows(path)
            kept = [k for k, name in enumerate(of[0]) if ranks == 1 or not name.startswith(("energy_", "work_"))]
            return [[line[k] for k in kept] for line in of]
        wanted, found = lines(whole), lines(folder)
        kept = [line for line in found if line in wanted]
        assert kept == wanted, f"{what}: {len(wanted) - len(kept)} rows of {len(wanted)} differ"
        same(frames(folder)[-1], frames(whole)[-1], [*deck.bodies, *deck.rigids], f"{what}, last frame")

    def cut(self, deck, common, whole, ranks):
        """A checkpoint at any step, among them the first and the last of a stage."""
        lines = rows(whole)
        total = int(lines[-1][0])
        column = lines[0].index("stage")
        ends = [int(a[0]) for a, b in zip(lines[1:], lines[2:]) if a[column] != b[column]]
        at = deck.draw.choice([deck.draw.randint(1, total - 1), *ends, *[end + 1 for end in ends]])
        at = min(at, total - 1)
        self.run("cut", *deck.staged(), *common, "-time_max_steps", at, "-checkpoint_interval", 1e3, ranks=ranks)
        folder, _ = self.run("cut", *deck.staged(), *common, "-restart", checkpoints(self.base / "cut")[-1], ranks=ranks,
                             fresh_folder=False)
        self.compare(deck, folder, whole, f"cut at step {at} of {total}, {ranks} ranks", ranks)

    def kill(self, deck, common, whole, ranks):
        """A run that is killed once it has written a checkpoint or two."""
        folder = fresh(self.base / "killed")
        words = [*deck.staged(), *common, "-checkpoint_interval", f"{DT * deck.draw.randint(5, 30):.12g}"]
        process = subprocess.Popen([*self.launcher(ranks), *command(self.binary, self.empty, folder, *words)], env=ENVIRONMENT,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wanted = deck.draw.randint(1, 2)
        while process.poll() is None and len(checkpoints(folder)) < wanted:
            time.sleep(0.002)
        kill_all(process, ranks)
        if not checkpoints(folder):
            return
        self.run("killed", *words, "-restart", "latest", ranks=ranks, fresh_folder=False)
        self.compare(deck, folder, whole, f"killed, {ranks} ranks", ranks)

    def ranks(self, deck, common, whole, precision, ranks):
        """Several ranks against one, and their own restarts."""
        together, _ = self.run("together", *deck.staged(), *common, ranks=ranks)
        small = 1e-7 if precision == "double" else 2e-3
        with h5py.File(frames(together)[-1]) as a, h5py.File(frames(whole)[-1]) as b:
            for body in deck.bodies:
                x, y = a[body]["position"][()], b[body]["position"][()]
                assert x.shape == y.shape, f"{ranks} ranks: {x.shape} of {y.shape} particles of {body}"
                assert x.size == 0 or np.abs(x - y).max() < small, f"{ranks} ranks: {body} is {np.abs(x - y).max():.3g} m off"
        self.cut(deck, common, together, ranks)
        if deck.draw.random() < 0.5:
            self.kill(deck, common, together, ranks)

    def history(self, deck, whole, log):
        """What comes and goes, to the last particle."""
        lines = rows(whole)
        names, table = lines[0], np.array([[float(x) for x in line] for line in lines[1:]])
        stage = table[:, names.index("stage")].astype(int) - 1
        assert sorted(set(stage)) == list(range(len(deck.stages))), f"stages {sorted(set(stage))}"
        for name in deck.bodies + deck.rigids:
            before = stage < deck.placed.get(name, 0)
            columns = [k for k, column in enumerate(names) if column.startswith(name + "_")]
            assert not table[np.ix_(before, columns)].any(), f"{name}: not zero before it is placed"
        for name in deck.rigids:
            gone = stage >= deck.removed.get(name, len(deck.stages))
            for axis in "xyz"[:deck.dim]:
                assert not table[gone, names.index(f"{name}_force_{axis}")].any(), f"{name}: a force after it was removed"
                assert np.ptp(table[gone, names.index(f"{name}_{axis}")], axis=None) == 0 if gone.any() else True, f"{name} moves"
        for name in deck.bodies:
            mass, lost = table[:, names.index(f"{name}_mass")], table[:, names.index(f"{name}_lost_mass")]
            there = stage >= deck.placed.get(name, 0)
            total = (mass + lost)[there]
            assert np.abs(total - total[0]).max() < 1e-6 * total[0], f"{name}: mass and lost mass {total}"
            gone = stage >= deck.removed.get(name, len(deck.stages))
            assert not mass[gone].any(), f"{name}: mass after it was removed"
            placed = re.search(rf"body {name} is placed: (\d+) particles(?:; (\d+) were cut out)?", log)
            assert (placed is not None) == (name in deck.placed), f"{name}: {placed}"
            if placed:
                density = float(self.option(deck, self.option(deck, f"{name}_material", deck.placed[name]) + "_density"))
                expected = int(placed[1]) * density * 0.125**deck.dim
                assert abs(total[0] - expected) < 1e-5 * expected, f"{name}: {total[0]} kg placed of {expected}"
                assert placed[2] is None or int(placed[2]) > 0

    @staticmethod
    def option(deck, name, stage=0):
        """The value of an option in a stage."""
        for key, value in deck.changes[stage]:
            if key == name:
                return value
        return deck.options[deck.options.index("-" + name) + 1]

    def dry(self, deck, common):
        done = run(self.binary, self.empty, self.base / "dry", *deck.staged(), *common, "-dry_run")
        told = re.findall(r"^stage (\w+) +to .*?: (\d+) steps", done.stdout, re.M)
        assert [name for name, _ in told] == deck.stages, f"the dry run tells of {told}"
        assert not (self.base / "dry").exists(), "the dry run has written a folder"
        if "-time_step" in deck.options:
            assert [int(steps) for _, steps in told] == deck.steps, f"the dry run tells of {told} of {deck.steps}"


def check(checks, deck, draw, common, precision):
    """Whether the run reached its end: what is placed may meet soil that has come there."""
    whole, done = checks.run("whole", *deck.staged(), *common, status=None)
    if done.returncode == 3 and "in the place of something else" in done.stderr:
        return False
    assert done.returncode == 0, f"exit status {done.returncode}: {done.stderr}"
    checks.history(deck, whole, (pathlib.Path(whole) / "mpm.log").read_text())
    checks.cut(deck, common, whole, 1)
    if draw.random() < 0.5:
        checks.kill(deck, common, whole, 1)
    if draw.random() < 0.4:
        checks.ranks(deck, common, whole, precision, draw.randint(2, 3))
    if draw.random() < 0.4:
        checks.dry(deck, common)
    return True


def main():
    given, base = read_arguments(__doc__, "stage_bodies", backends="serial,openmp", first="0")
    checks, met = Checks(given.binary, base), 0
    for number in range(int(given.first), int(given.first) + given.count):
        draw = draws_of(given, number)
        deck = Deck(draw, int(draw.choice(given.dims.split(","))))
        precision = draw.choice(given.precisions.split(","))
        common = ["-backend", draw.choice(given.backends.split(",")), "-precision", precision, "-p2g",
                  draw.choice(["tile", "tile", "gather", "sequential"])]
        try:
            met += not check(checks, deck, draw, common, precision)
        except AssertionError as error:
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\n{' '.join(map(str, [*deck.staged(), *common]))}")
    print(f"{given.count} decks: what stages place and remove is accounted for, and cut and killed runs give the same bits; in {met} "
          "of them something was in the way")


if __name__ == "__main__":
    main()
