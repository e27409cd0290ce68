#!/usr/bin/env python3
"""Random loads on surfaces: pressures and tractions, constant and by tables, on bodies of random shapes.

    tractions.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single] [--backends serial,openmp]

A body that touches nothing has up to three loads on parts of its surface. From row to row its momentum must change by the force that
the history tells, and by its weight. A table of one value must give the same bits as the constant, and so must a run that is cut in
two by a checkpoint; another strategy and two or three ranks must give the same to round-off. Where the run has an energy balance, its
row must hold. In some decks stages change the loads.
"""
import sys

import numpy as np

from folders import ENVIRONMENT, checkpoints, differences, fresh, of_velocities, rows, run
from random_decks import draws_of, read_arguments

STEP = 2e-4  # s
CUT = 1e-7  # share of a step's impulse that nodes below the cut of the mass leave out (method.md), while a surface leaves a row of nodes
SPACING = 0.25
GRAVITY = 9.81


def vector(values):
    return ",".join(repr(round(float(x), 6)) for x in values)


class Deck:
    def __init__(self, draw, folder, dim):
        self.dim = dim
        self.rings = dim == 2 and draw.random() < 0.2
        self.steps = draw.choice([20, 40, 80])
        self.gravity = draw.choice([0.0, -GRAVITY])
        across = [4.0, 4.0] if dim == 2 else [4.0, 3.0, 4.0]
        centre = [0.0 if self.rings else 2.0, *[x / 2 for x in across[1:]]]
        free = ["x", "y", "z"][:dim]
        walls = " ".join(f"-mesh_{a}{s} free" for a in free for s in ("min", "max") if not (self.rings and a + s == "xmin"))
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing {SPACING} {walls} "
                        "-materials soil -soil_density 2000 -soil_poisson 0.3 "
                        f"-soil_model {draw.choice(['linear_elastic', 'von_mises -soil_su 2e4'])} -soil_young {draw.choice(['1e6', '2e7'])} "
                        f"-gravity {vector([0] * (dim - 1) + [self.gravity])} -time_step {STEP} -time_end {STEP * self.steps} "
                        f"-history_interval {STEP} -output_interval {STEP * self.steps}").split()
        domain = "fixed" if self.rings else draw.choice(["fixed", "fixed", "stretch", "split"])
        self.options += ["-particle_domain", domain, "-velocity_update", draw.choice(["flip", "flip", "apic", "xpic"])]
        self.balance = draw.random() < 0.3
        self.options += ["-output_energy", "on"] if self.balance else []
        self.add_shapes(draw, centre)
        self.loads = ["top", "side", "all"][: draw.choice([1, 1, 2, 3])]
        self.constant, self.timed, self.flat = ["-loads", ",".join(self.loads)], ["-loads", ",".join(self.loads)], []
        self.flat = list(self.constant)
        for name in self.loads:
            self.add_load(draw, folder, name, across)

    def add_shapes(self, draw, centre):
        dim, names = self.dim, ["block"]
        per_cell = draw.choice([1, 2, 3])
        kind = draw.choice(["box", "disc"] if self.rings else ["box", "turned", "disc", "two"])
        half = [draw.choice([0.5, 0.75, 0.7]) for _ in range(dim)]
        lower, upper = [c - h for c, h in zip(centre, half)], [c + h for c, h in zip(centre, half)]
        if self.rings:
            lower[0] = 0.0
        if kind == "disc":
            self.options += f"-block_shape disc -block_centre {vector(centre)} -block_radius {draw.choice([0.6, 0.8])}".split()
        else:
            self.options += f"-block_shape box -block_lower {vector(lower)} -block_upper {vector(upper)}".split()
            self.options += ["-block_angle_deg", str(draw.choice([10, 30, 45, -20]))] if kind == "turned" else []
        if kind == "two":  # another body on the first: the face between them is no surface
            names.append("other")
            low, high = list(lower), list(upper)
            low[0], high[0] = upper[0], upper[0] + 0.5
            self.options += (f"-other_shape box -other_lower {vector(low)} -other_upper {vector(high)} -other_material soil "
                             f"-other_particles_per_cell {per_cell}").split()
        self.options += f"-bodies {','.join(names)} -block_material soil -block_particles_per_cell {per_cell}".split()
        self.names, self.centre, self.covered = names, centre, kind == "two"
        self.options += ["-geometry", "axisymmetric"] if self.rings else ["-block_velocity", vector([draw.uniform(-0.5, 0.5) for _ in range(dim)])]

    def add_load(self, draw, folder, name, across):
        dim = self.dim
        body = "block"
        low, high = [0.0] * dim, list(across)
        options = []
        if name != "all" and draw.random() < 0.5:
            k = draw.randrange(dim)
            low[k] = self.centre[k] if not (k == 0 and (self.rings or self.covered)) else 0.0
        if name == "top":
            options += ["-top_facing", vector([0] * (dim - 1) + [1])]
        if name == "side":
            options += ["-side_facing", vector([-1 if self.covered else 1] + [0] * (dim - 1))]
        options += f"-{name}_body {body} -{name}_lower {vector(low)} -{name}_upper {vector(high)}".split()
        self.constant += options
        self.timed += options
        self.flat += options
        for kind in draw.choice([["pressure"], ["traction"], ["pressure", "traction"]]):
            count = 1 if kind == "pressure" else dim
            value = [draw.uniform(-300, 300) for _ in range(count)]
            if kind == "traction" and self.rings:
                value[0] = 0.0
            flat = ",".join(":".join([t, *map(repr, value)]) for t in ("-1", "0.0031", "9"))
            self.constant += [f"-{name}_{kind}", ",".join(map(repr, value))]
            self.flat += [f"-{name}_{kind}_table", flat]
            self.timed += self.table(draw, folder, name, kind, value)

    def table(self, draw, folder, name, kind, value):
        end = STEP * self.steps
        times = sorted([0.0, end * 1.01, *(draw.uniform(0, end) for _ in range(draw.choice([0, 2, 9])))])
        factors = draw.random() < 0.5
        points = [[repr(t), *map(repr, [draw.uniform(-1, 1)] if factors else [x * draw.uniform(-1, 1) for x in value])] for t in times]
        if draw.random() < 0.5:
            path = folder / f"{name}_{kind}.csv"
            path.write_text("# a record\n" + "".join(",".join(point) + "\n" for point in points))
            text = str(path)
        else:
            text = ",".join(":".join(point) for point in points)
        smooth = [f"-{name}_{kind}_table_interpolation", "smooth"] if draw.random() < 0.4 else []
        return [f"-{name}_{kind}_table", text, *smooth] + ([f"-{name}_{kind}", ",".join(map(repr, value))] if factors else [])


def column(folder, name):
    lines = rows(folder)
    place = lines[0].index(name)
    return np.array([float(line[place]) for line in lines[1:]])


def check_momentum(deck, folder, tolerance):
    """Constant loads: their forces at a row are those of the step that follows."""
    time = column(folder, "time")
    mass = sum(column(folder, f"{name}_mass") for name in deck.names)
    assert np.ptp(mass) < 1e-6 * mass[0], "the body has left the mesh"
    for k, axis in enumerate("xyz"[: deck.dim]):
        if deck.rings and axis == "x":
            continue  # the axis holds it
        momentum = sum(column(folder, f"{name}_momentum_{axis}") for name in deck.names)
        force = sum(column(folder, f"{name}_force_{axis}") for name in deck.loads)
        weight = mass * deck.gravity if k == deck.dim - 1 else 0 * mass
        impulse = np.cumsum(np.diff(of_velocities(time, STEP)) * (force + weight)[:-1])
        steps = np.diff(of_velocities(time, STEP)) * (np.abs(force) + np.abs(weight))[:-1]
        size = steps.sum() + np.abs(momentum).max() + 1e-3
        error = np.abs(momentum[1:] - momentum[0] - impulse).max() / size
        allowed = tolerance + CUT * steps.max() / size
        assert error < allowed, f"the momentum along {axis} is {error:.3g} off the impulse of the loads, more than {allowed:.3g}"
        check_momentum.errors.append(error)


check_momentum.errors = []


def check_balance(folder):
    names = rows(folder)[0]
    works = sum(column(folder, name) for name in names if name.startswith("work_"))
    sides = column(folder, "energy_kinetic") - column(folder, "energy_kinetic")[0] + column(folder, "energy_internal") + column(folder, "energy_lost")
    error = np.abs(sides - works - column(folder, "energy_error")).max()
    size = max(np.abs(column(folder, name)).max() for name in names if name.startswith(("work_", "energy_")))
    assert error < 1e-9 * size, f"the energy balance is {error / size:.3g} off"
    missing = np.abs(column(folder, "energy_error")).max() / size
    check_balance.largest = max(check_balance.largest, missing)


check_balance.largest = 0.0


def near(one, other, tolerance, what):
    for line, mine in zip(rows(one), rows(other)):
        assert len(line) == len(mine)
    for name in rows(one)[0]:
        if name.endswith(("_force_x", "_force_y", "_force_z", "_area")) or "momentum" in name:
            a, b = column(one, name), column(other, name)
            size = max(np.abs(a).max(), 1.0)
            assert np.abs(a - b).max() < tolerance * size, f"{what}: {name} differs by {np.abs(a - b).max() / size:.3g}"


def check_cut(binary, empty, base, options, whole, draw):
    cut = fresh(base / "cut")
    at = draw.randint(1, int(rows(whole)[-1][0]) - 1)
    run(binary, empty, cut, *options, "-time_max_steps", at, "-checkpoint_interval", 1e3)
    run(binary, empty, cut, *options, "-restart", checkpoints(cut)[-1])
    found = [f for f in differences(cut, whole) if "checkpoint" not in str(f)]
    mine, theirs = rows(cut), rows(whole)
    kept = [line for line in mine if line in theirs]
    assert kept == theirs, f"cut at step {at}: {len(theirs) - len(kept)} rows differ, {found[:3]}"


def check_stages(binary, empty, base, deck, common, tolerance):
    folder = fresh(base / "stages")
    half = STEP * deck.steps
    more = ["-stages", "one,two", "-one_time_end", half, "-two_time_end", half]
    more += [f"-two_{option[1:]}" if n % 2 == 0 else ",".join(repr(-2 * float(x)) for x in option.split(","))
             for n, option in enumerate(pair for k in range(0, len(deck.constant), 2) for pair in deck.constant[k: k + 2]
                                        if deck.constant[k].endswith(("_pressure", "_traction")))]
    options = [word for n, word in enumerate(deck.options) if "-time_end" not in (word, deck.options[n - 1])]
    run(binary, empty, folder, *options, *deck.constant, *more, *common)
    force = sum(np.abs(column(folder, f"{name}_force_{axis}")) for name in deck.loads for axis in "xyz"[: deck.dim])
    assert force[-1] > 0, "the second stage has no load"


def main():
    given, base = read_arguments(__doc__, "tractions", backends="serial,openmp")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        deck = Deck(draw, base, dim)
        precision = draw.choice(given.precisions.split(","))
        tolerance = 1e-11 if precision == "double" else 2e-4
        strategy = draw.choice(["sequential", "mosaic", "gather", "tile", "tile"])
        common = ["-backend", draw.choice(given.backends.split(",")), "-precision", precision, "-p2g", strategy]
        ENVIRONMENT["OMP_NUM_THREADS"] = draw.choice(["1", "1", "1", "2"])
        try:
            whole, flat, timed = fresh(base / "whole"), fresh(base / "flat"), fresh(base / "timed")
            run(binary, empty, whole, *deck.options, *deck.constant, *common)
            check_momentum(deck, whole, tolerance)
            if deck.balance:
                check_balance(whole)
            run(binary, empty, flat, *deck.options, *deck.flat, *common)
            assert not differences(whole, flat), f"tables of one value: {differences(whole, flat)[:5]}"
            run(binary, empty, timed, *deck.options, *deck.timed, *common)
            check_cut(binary, empty, base, [*deck.options, *deck.timed, *common], timed, draw)
            if draw.random() < 0.5:
                other = fresh(base / "other")
                run(binary, empty, other, *deck.options, *deck.timed, *common[:-1], "tile" if strategy != "tile" else "atomic")
                near(timed, other, 1e-7 if precision == "double" else 2e-2, "another strategy")
            if draw.random() < 0.4:
                pair = fresh(base / "pair")
                ranks = draw.choice(["2", "3"])
                run(binary, empty, pair, *deck.options, *deck.timed, *common, prefix=("mpirun", "--oversubscribe", "-n", ranks, "--bind-to", "none"))
                near(timed, pair, 1e-7 if precision == "double" else 2e-2, f"{ranks} ranks")
            if draw.random() < 0.3:
                check_stages(binary, empty, base, deck, common, tolerance)
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, deck.options + deck.timed + common))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: momentum is the impulse of the loads (off by {np.median(check_momentum.errors):.2g} in the middle, at most "
          f"{max(check_momentum.errors):.2g}), the energy balance holds "
          f"(at most {check_balance.largest:.2g} missing); tables of one value and cut runs give the same bits")


main()
