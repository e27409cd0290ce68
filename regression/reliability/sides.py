#!/usr/bin/env python3
"""Random sides of the mesh: friction, dashpots, velocities in time.

    sides.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

A deck has soil in a mesh whose sides, but the top, are of random kinds that act on the soil, under gravity that may be inclined. At every row the momentum of
the soil must be what gravity and the forces on the sides have made of it.
A run that is cut in two by a checkpoint must give the same bits as the whole one; a run on two ranks the same to
round-off. Half of the decks rebuild their lists often. Some decks have two stages, in which the kinds differ.
"""
import sys
from pathlib import Path

import numpy as np

from folders import checkpoints, differences, fresh, of_velocities, rows, run
from random_decks import draws_of, read_arguments

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2] / "scripts"), str(HERE.parents[1])]

from differences import largest  # noqa: E402
from results import Run  # noqa: E402

END = 0.15  # s
APART = {"double": 1e-9, "single": 0.05}  # of one and two ranks, as compare.py has it


def vector(values):
    return ",".join(repr(float(x)) for x in values)


def side_options(draw, name, axis, dim, prefix=""):
    kind = draw.choice(["friction", "friction", "absorbing", "absorbing", "fixed", "roller"])
    options = [f"-{prefix}mesh_{name}", kind]
    if kind == "friction":
        options += [f"-{prefix}mesh_{name}_friction", draw.choice(["0", "0.3", "2"])]
        options += draw.choice([[], [f"-{prefix}mesh_{name}_shear_limit", "500"]])
    if kind == "absorbing":
        options += draw.choice([[], [f"-{prefix}mesh_{name}_dashpot_factor", "0.4"]])
        options += draw.choice([[], [f"-{prefix}mesh_{name}_spring_length", "20"]])
    free = [True] * dim if kind != "roller" else [k == axis for k in range(dim)]
    size = [0.02 if k == axis else 0.2 for k in range(dim)]
    speed = lambda: [draw.uniform(-s, s) if f else 0.0 for f, s in zip(free, size)]  # noqa: E731
    if draw.random() < 0.5:
        points = [":".join(repr(float(x)) for x in (t, *speed())) for t in (0, draw.uniform(0.01, 0.14), 9)]
        options += [f"-{prefix}mesh_{name}_velocity_table", ",".join(points)]
        options += draw.choice([[], [f"-{prefix}mesh_{name}_velocity_table_interpolation", "smooth"]])
    elif kind in ("fixed", "roller") or draw.random() < 0.4:
        options += [f"-{prefix}mesh_{name}_velocity", vector(speed())]
    return options


def make_deck(draw, dim):
    """Options, and whether there are two stages."""
    across = [2.0, 3.0] if dim == 2 else [2.0, 1.0, 2.0]
    filled = [*across[:-1], draw.choice([0.5, 1.0, 1.13])]
    gravity = [draw.uniform(-3, 3) for _ in range(dim - 1)] + [-9.81]
    options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.25 -materials clay "
               f"-clay_model {draw.choice(['von_mises -clay_su 3000', 'linear_elastic'])} -clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 "
               f"-bodies soil -soil_material clay -soil_shape box -soil_lower {vector([0] * dim)} -soil_upper {vector(filled)} "
               f"-gravity {vector(gravity)} -velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -mesh_{'xyz'[dim - 1]}max free "
               f"-time_courant {draw.choice(['0.2', '0.33'])} -history_interval 0.003 -output_interval 0.1").split()
    options += ["-rebuild_margin", draw.choice(["0.5", "0.01"])]  # seldom, and again and again
    staged = draw.random() < 0.3
    names = [(f"{'xyz'[d]}{side}", d) for d in range(dim) for side in ("min", "max") if (d, side) != (dim - 1, "max")]
    for name, axis in names:
        for prefix in ("first_", "second_") if staged else ("",):
            options += side_options(draw, name, axis, dim, prefix)
    options += ["-stages", "first,second", "-time_end", str(END / 2)] if staged else ["-time_end", str(END)]
    return options, np.array(gravity), staged


def check_momentum(folder, gravity, dim, precision, body="soil"):
    lines = rows(folder)
    values = {name: np.array([float(line[k]) for line in lines[1:]]) for k, name in enumerate(lines[0])}
    t = values["time"]
    scale = values[f"{body}_mass"][0] * (np.abs(gravity).max() * t[-1] + 0.2)
    sides = [name[:-len("_force_x")] for name in lines[0] if name.startswith("wall_") and name.endswith("_force_x")]
    for d in range(dim):
        axis = "xyz"[d]
        force = sum(values[f"{side}_force_{axis}"] for side in sides)
        weights = np.diff(of_velocities(t, values["dt"])) * values[f"{body}_mass"][1:] * gravity[d]
        gained = np.cumsum(weights - np.diff(t) * force[1:])
        error = np.abs(values[f"{body}_momentum_{axis}"][1:] - values[f"{body}_momentum_{axis}"][0] - gained).max() / scale
        assert error < (1e-10 if precision == "double" else 1e-4), f"the momentum along {axis} is {error:.3g} off"


def check_cut(binary, empty, base, options, whole, draw):
    cut = fresh(base / "cut")
    step = int(rows(whole)[-1][0])
    at = draw.randint(1, step - 1)
    run(binary, empty, cut, *options, "-time_max_steps", at, "-checkpoint_interval", 1e3)
    run(binary, empty, cut, *options, "-restart", checkpoints(cut)[-1])
    mine, theirs = rows(cut), rows(whole)
    kept = [line for line in mine if line in theirs]
    assert kept == theirs, f"cut at step {at} of {step}: {len(theirs) - len(kept)} rows differ"
    assert not [f for f in differences(cut, whole) if "history" not in f], f"cut at step {at} of {step}: frames differ"


def check_repeats(binary, empty, base, options, whole, draw, precision):
    """A run that a checkpoint cuts gives the same bits as `whole`, and two or three ranks, which half of the decks draw, the same
    answers. Returns how far these are from those of one rank; 0 where one rank is drawn."""
    if "atomic" not in options:
        check_cut(binary, empty, base, options, whole, draw)
    if draw.random() >= 0.5:
        return 0.0
    several = fresh(base / "several")
    run(binary, empty, several, *options, prefix=("mpirun", "--oversubscribe", "-n", draw.choice(["2", "3"]), "--bind-to", "none"))
    apart, where = largest(Run(several), Run(whole))
    assert apart <= APART[precision], f"several ranks are {apart:.3g} apart from one at {where}"
    return apart


def main():
    given, base = read_arguments(__doc__, "sides")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    furthest = {"double": 0.0, "single": 0.0}
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        options, gravity, staged = make_deck(draw, dim)
        precision = draw.choice(given.precisions.split(","))
        options += ["-backend", draw.choice(["serial", "openmp"]), "-precision", precision,
                    "-p2g", draw.choice(["tile", "gather"])]
        try:
            whole = fresh(base / "whole")
            run(binary, empty, whole, *options)
            check_momentum(whole, gravity, dim, precision)
            check_cut(binary, empty, base, options, whole, draw)
            if draw.random() < 0.4:
                pair = fresh(base / "pair")
                run(binary, empty, pair, *options, prefix=("mpirun", "-n", "2", "--bind-to", "none"))
                check_momentum(pair, gravity, dim, precision)
                apart, where = largest(Run(pair), Run(whole))
                furthest[precision] = max(furthest[precision], apart)
                assert apart <= APART[precision], f"two ranks are {apart:.3g} apart from one at {where}"
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, options))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: gravity and the forces on the sides make the momentum; cut runs give the same bits; "
          f"two ranks are {furthest['double']:.2g} apart from one (single {furthest['single']:.2g})")


if __name__ == "__main__":
    main()
