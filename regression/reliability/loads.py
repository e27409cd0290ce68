#!/usr/bin/env python3
"""Random tables in time: gravity, velocities, displacements and forces of rigid bodies, on soil that they touch.

    loads.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

A deck has soil under gravity in time and up to three rigid bodies, each with a table of a random kind, in a line or in a CSV file,
straight or smooth, of components or of factors. The displacement of a driven body must be the integral of its table, to round-off,
at every row. A run that is cut in two by a checkpoint, and one in which a constant table takes the place of a constant, must give
the same bits as the whole one; a run on two ranks the same to round-off.
"""
import sys

import numpy as np

from folders import checkpoints, differences, frames, fresh, rows, run
from random_decks import draws_of, read_arguments

END = 0.2  # s


class Table:
    """A random table of `dim` components with the text of its option."""

    def __init__(self, draw, folder, name, dim, largest, factors_of=None):
        count = draw.choice([2, 3, 5, 12, 200])
        times = sorted(draw.uniform(-0.2, 1.3) * END for _ in range(count))
        times[0], times[-1] = min(times[0], draw.choice([0.0, -0.03])), max(times[-1], END * draw.choice([1, 1.5]))
        columns = 1 if factors_of is not None else dim
        values = np.array([[draw.uniform(-1, 1) * (1 if columns == 1 else largest) for _ in range(columns)] for _ in times])
        self.times, self.smooth = np.array(times), draw.random() < 0.4
        self.values = values * np.array(factors_of) if factors_of is not None else values
        points = [[repr(x) for x in (t, *row)] for t, row in zip(times, values.tolist())]
        if draw.random() < 0.5:
            path = folder / f"{name}.csv"
            head = draw.choice(["", "# a record\n", "time,a,b,c\n"])
            path.write_text(head + "".join(",".join(point) + "\n" for point in points))
            text = str(path)
        else:
            text = ",".join(":".join(point) for point in points)
        self.options = [f"-{name}_table", text] + ([f"-{name}_table_interpolation", "smooth"] if self.smooth else [])

    def way(self, t):
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        length = np.diff(self.times)[k]
        return k, length, np.clip((t - self.times[k]) / length, 0, 1)

    def value(self, t):
        k, _, x = self.way(t)
        return self.values[k] + np.diff(self.values, axis=0)[k] * (x**2 * (3 - 2 * x) if self.smooth else x)[:, None]

    def integral_from_start(self, t):
        k, length, x = self.way(t)
        parts = np.diff(self.times)[:, None] * (self.values[1:] + self.values[:-1]) / 2
        whole = np.concatenate([0 * self.values[:1], np.cumsum(parts, axis=0)])
        share = x**3 - x**4 / 2 if self.smooth else x**2 / 2
        return whole[k] + length[:, None] * (self.values[k] * x[:, None] + np.diff(self.values, axis=0)[k] * share[:, None])

    def integral(self, t):
        return self.integral_from_start(t) - self.integral_from_start(np.zeros(1))


def vector(values):
    return ",".join(repr(float(x)) for x in values)


class Deck:
    def __init__(self, draw, folder, dim):
        self.driven, self.placed = {}, {}
        across = [4.0, 3.0] if dim == 2 else [4.0, 2.0, 3.0]
        self.options = [*(f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.25 "
                          "-materials clay -clay_model von_mises -clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 "
                          f"-clay_su {draw.choice([500, 3000])} -bodies soil -soil_material clay -soil_shape box "
                          f"-soil_lower {vector([0] * dim)} -soil_upper {vector([*across[:-1], 1.5])} -damping {draw.choice([0, 0.1])} "
                          f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} "
                          f"-time_end {END} -time_courant {draw.choice([0.2, 0.33])} -history_interval 0.01 -output_interval 0.1").split()]
        weight = [0.0] * (dim - 1) + [-9.81]
        if draw.random() < 0.7:
            by_factor = draw.random() < 0.5
            table = Table(draw, folder, "gravity", dim, 8, weight if by_factor else None)
            self.options += table.options + (["-gravity", vector(weight)] if by_factor else [])
        else:
            self.options += ["-gravity", vector(weight)]
        names = draw.sample(["pile", "plate", "block"], draw.choice([1, 2, 3]))
        self.options += ["-rigid_bodies", ",".join(names)]
        for k, name in enumerate(names):
            lower = [0.3 + 1.2 * k, *[0.4] * (dim - 2), 1.6]
            upper = [x + 0.7 for x in lower]
            self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
            self.options += draw.choice([[], [f"-{name}_friction", "0.3"], [f"-{name}_contact_normal", "gradient"]])
            kind = draw.choice(["velocity", "displacement", "force"])
            by_factor = kind != "displacement" and draw.random() < 0.4
            constant = [0.2 if kind == "velocity" else 300.0] * dim
            table = Table(draw, folder, f"{name}_{kind}", dim, {"velocity": 0.4, "displacement": 0.03, "force": 500}[kind],
                          constant if by_factor else None)
            self.options += table.options + ([f"-{name}_{kind}", vector(constant)] if by_factor else [])
            self.options += [f"-{name}_motion", "dynamic" if kind == "force" else "prescribed"]
            if kind == "force":
                self.options += [f"-{name}_density", "2000"]
            {"velocity": self.driven, "displacement": self.placed}.get(kind, {})[name] = table


def columns(folder, name, dim):
    lines = rows(folder)
    return np.array([[float(line[lines[0].index(f"{name}{axis}")]) for axis in "xyz"[:dim]] for line in lines[1:]])


def times(folder):
    lines = rows(folder)
    return np.array([float(line[lines[0].index("time")]) for line in lines[1:]])


def check_motion(deck, folder, dim):
    t = times(folder)
    for name, table in deck.driven.items():
        exact = table.integral(t)
        error = np.abs(columns(folder, f"{name}_", dim) - exact).max()
        assert error < 1e-12, f"{name} is {error:.3g} m off the integral of its velocity"
        error = np.abs(columns(folder, f"{name}_velocity_", dim) - table.value(t)).max()
        assert error < 1e-12, f"{name} is {error:.3g} m/s off its velocity"
    for name, table in deck.placed.items():
        error = np.abs(columns(folder, f"{name}_", dim) - (table.value(t) - table.value(np.zeros(1)))).max()
        assert error < 1e-12, f"{name} is {error:.3g} m off its displacement"


def check_cut(binary, empty, base, deck, common, whole, draw):
    cut = fresh(base / "cut")
    step = int(rows(whole)[-1][0])
    at = draw.randint(1, step - 1)
    run(binary, empty, cut, *deck.options, *common, "-time_max_steps", at, "-checkpoint_interval", 1e3)
    run(binary, empty, cut, *deck.options, *common, "-restart", checkpoints(cut)[-1])
    mine, theirs = rows(cut), rows(whole)
    kept = [line for line in mine if line in theirs]
    assert kept == theirs, f"cut at step {at} of {step}: {len(theirs) - len(kept)} rows differ"
    last = [f for f in differences(cut, whole) if f.startswith(frames(whole)[-1].name)]
    assert frames(cut)[-1].name != frames(whole)[-1].name or not last, f"cut at step {at} of {step}: {last}"


def check_constant(binary, empty, base, deck, common, whole, dim):
    """The constants of a deck, and tables of one value in their place."""
    flat = lambda values: ",".join(":".join([t, *values.split(",")]) for t in ("0", "0.0731", "9"))  # noqa: E731
    options = [word for word in deck.options]
    constant, timed = [], []
    place = 0
    while place < len(options):
        name, value = options[place], options[place + 1]
        place += 2
        if name.endswith(("_table", "_table_interpolation")):
            continue
        constant += [name, value]
        timed += [f"{name}_table", flat(value)] if name == "-gravity" or name.endswith(("_velocity", "_force")) else [name, value]
    for name in [*deck.driven, *deck.placed]:
        if f"-{name}_velocity" not in constant:
            value = vector([0.0] * (dim - 1) + [-0.21])
            constant += [f"-{name}_velocity", value]
            timed += [f"-{name}_velocity_table", flat(value)]
    if "-gravity" not in constant:
        value = vector([0.0] * (dim - 1) + [-3.3])
        constant += ["-gravity", value]
        timed += ["-gravity_table", flat(value)]
    one, other = fresh(base / "constant"), fresh(base / "timed")
    run(binary, empty, one, *constant, *common)
    run(binary, empty, other, *timed, *common)
    assert not differences(one, other), f"tables of one value: {differences(one, other)[:5]}"


def main():
    given, base = read_arguments(__doc__, "loads")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        deck = Deck(draw, base, dim)
        common = ["-backend", draw.choice(["serial", "openmp"]), "-precision", draw.choice(given.precisions.split(",")), "-p2g", "tile"]
        try:
            whole = fresh(base / "whole")
            run(binary, empty, whole, *deck.options, *common)
            check_motion(deck, whole, dim)
            check_cut(binary, empty, base, deck, common, whole, draw)
            check_constant(binary, empty, base, deck, common, whole, dim)
            if draw.random() < 0.4:
                pair = fresh(base / "pair")
                run(binary, empty, pair, *deck.options, *common, prefix=("mpirun", "-n", "2", "--bind-to", "none"))
                check_motion(deck, pair, dim)
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, deck.options + common))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: motions are the integrals of their tables; cut runs and constant tables give the same bits")


main()
