#!/usr/bin/env python3
"""Random ground between sides of the free field.

    free_field.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

Two kinds of decks. *Level* ground of one to three elastic layers, on a base of a random kind that moves, or under gravity that
shakes: between sides of the free field it must move as between periodic sides, in 3D also where only one pair of sides is of the
free field. *Slopes* of a random law with weight, which come to rest before they are shaken: the momentum must be what gravity and the sides have made of it. In
both, a run that is cut in two by a checkpoint must give the same bits as the whole one, and a run on several ranks the same to round-off.
"""
import sys

import h5py
import numpy as np

from folders import frames, fresh, of_velocities, rows, run
from random_decks import draws_of, read_arguments
from sides import check_repeats, vector

H = 0.5  # m, edge of a cell
OFF_COLUMN = {"double": 1e-6, "single": 0.02}  # of the largest displacement
SPEED = {"double": 1e-6, "single": 1e-2}  # m/s; single precision would not see less


def table(draw, size, free, end):
    """A motion by components that ends at rest."""
    times = sorted(draw.uniform(0.01, 0.8 * end) for _ in range(3))
    points = [(0.0, [0.0] * len(free))] + [(t, [draw.uniform(-size, size) if f else 0.0 for f in free]) for t in times] + [(end, [0.0] * len(free))]
    return ",".join(":".join(repr(float(x)) for x in (t, *v)) for t, v in points)


def soil(name, draw):
    return (f"-{name}_model linear_elastic -{name}_density {draw.uniform(1400, 2200):.6g} -{name}_young {10 ** draw.uniform(6.5, 7.8):.6g} "
            f"-{name}_poisson {draw.choice([0, 0.2, 0.3, 0.45])} {draw.choice(['', f'-{name}_pore_stiffness 5e7'])}").split()


def base_motion(draw, dim, size, end):
    """What shakes the ground: its base, or gravity. The first component along the vertical is that of a roller."""
    axis = "xyz"[dim - 1]
    kind = draw.choice(["fixed", "absorbing", "absorbing", "roller", "gravity"])
    free = [kind != "roller"] * (dim - 1) + [True]
    if kind == "gravity":
        return [f"-mesh_{axis}min", draw.choice(["fixed", "absorbing"]), "-gravity_table", table(draw, 20 * size, [True] * dim, end)]
    options = [f"-mesh_{axis}min", kind, f"-mesh_{axis}min_velocity_table", table(draw, size, free, end)]
    if kind == "absorbing":
        options += draw.choice([[], [f"-mesh_{axis}min_dashpot_factor", "0.5"]])
        options += draw.choice([[], [f"-mesh_{axis}min_spring_length", "8"]])
    return options


def free_sides(draw, names):
    options = []
    for name in names:
        options += [f"-mesh_{name}", "free_field"]
        options += draw.choice([[], [f"-mesh_{name}_dashpot_factor", repr(draw.uniform(0.3, 2))]])
        options += draw.choice([[], [f"-mesh_{name}_spring_length", "20"]])
    return options


def numerics(draw):
    return (f"-velocity_update {draw.choice(['flip', 'flip', 'apic', 'xpic'])} -f_bar_fraction {draw.choice(['0', '0.98', '0.98'])} "
            f"-damping {draw.choice(['0', '0', '0.05'])} -time_courant {draw.choice(['0.2', '0.33'])} "
            f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch'])} -rebuild_margin {draw.choice(['0.5', '0.05'])}").split()


def level_deck(draw, dim, precision):
    """Options without those of the lateral sides, and these for a column and for the free field."""
    cells = [8] if dim == 2 else [4, 4]
    up, across = "xyz"[dim - 1], "xyz"[:dim - 1]
    layers = draw.randint(1, 3)
    heights = np.cumsum([H * draw.randint(2, 4) for _ in range(layers)])
    heights[-1] += draw.choice([0.25, 0.375]) * H if dim == 2 else 0.25 * H
    per_cell = 2 if heights[-1] % (H / 2) == 0 else 4
    end = 0.15
    width = [H * n for n in cells]
    options = f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector([*width, H * (np.ceil(heights[-1] / H) + 2)])} -mesh_spacing {H} -mesh_{up}max free".split()
    names = [f"layer{n}" for n in range(layers)]
    options += ["-materials", ",".join(f"{n}_soil" for n in names), "-bodies", ",".join(names), "-time_end", end]
    low = 0.0
    for name, high in zip(names, heights):
        options += soil(f"{name}_soil", draw)
        options += (f"-{name}_material {name}_soil -{name}_shape box -{name}_lower {vector([0] * (dim - 1) + [low])} "
                    f"-{name}_upper {vector([*width, high])} -{name}_particles_per_cell {per_cell}").split()
        low = high
    options += base_motion(draw, dim, SPEED[precision], end) + numerics(draw)
    options += ["-output_interval", end / 3, "-history_interval", "0.005"]
    pairs = {axis: [f"{axis}min", f"{axis}max"] for axis in across}
    periodic = {axis: [x for side in pairs[axis] for x in (f"-mesh_{side}", "periodic")] for axis in across}
    free = {axis: free_sides(draw, pairs[axis]) for axis in across}
    some = draw.choice([across, across[:1]]) if dim == 3 else across
    column = [x for axis in across for x in periodic[axis]]
    field = [x for axis in across for x in (free[axis] if axis in some else periodic[axis])]
    return options, column, field


def slope_deck(draw, dim):
    up, across = "xyz"[dim - 1], "xyz"[:dim - 1]
    wide = 10.0 if dim == 2 else 6.0
    low, high = H * draw.randint(3, 5), H * draw.randint(6, 8)
    outline = [0, 0, wide, 0, wide, high, 0.7 * wide, high, 0.3 * wide, low, 0, low]
    size = [wide, 5.0] if dim == 2 else [wide, 2.0, 5.0]
    laws = [f"von_mises -clay_su {draw.uniform(1e4, 3e4):.6g} -clay_young 1e7", "linear_elastic -clay_young 1e7",
            "mohr_coulomb -clay_cohesion 8e3 -clay_friction_deg 30 -clay_young 1e7"]
    options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(size)} -mesh_spacing {H} -mesh_{up}max free -materials clay -clay_model {draw.choice(laws)} "
               f"-clay_poisson 0.3 -clay_density 1800 -bodies soil -soil_material clay -soil_shape polygon -soil_polygon {vector(outline)} "
               f"-gravity {vector([0] * (dim - 1) + [-9.81])} -stages rest,shake -rest_damping 0.7 "
               f"-rest_time_end 0.3 -rest_mesh_{up}min fixed -shake_time_end 0.3 -history_interval 0.005 -output_interval 0.1 "
               f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -rebuild_margin {draw.choice(['0.5', '0.05'])} -time_courant 0.3").split()
    if dim == 3:
        options += ["-soil_width", "0,2"]
        options += draw.choice([[], ["-shake_mesh_ymin", "free_field"], ["-mesh_ymin", "periodic", "-mesh_ymax", "periodic"]])
    options += [f"-rest_mesh_{across[0]}min", draw.choice(["roller", "fixed"])]
    kind = draw.choice(["fixed", "absorbing"])
    options += [f"-shake_mesh_{up}min", kind, f"-shake_mesh_{up}min_velocity_table", table(draw, 0.1, [True] + [False] * (dim - 1), 0.3)]
    options += [f"-shake_{x[1:]}" if x.startswith("-mesh") else x for x in free_sides(draw, ["xmin", "xmax"])]
    return options


def displacement(folder, first):
    """Of all particles, m."""
    with h5py.File(frames(folder)[-1]) as file:
        return np.concatenate([file[name]["position"][()].astype(float) for name in file if "position" in file[name]]) - first


def check_column(binary, empty, base, options, column, precision):
    whole, alone = base / "whole", fresh(base / "column")
    run(binary, empty, alone, *options, *column)
    with h5py.File(frames(alone)[0]) as file:
        first = np.concatenate([file[name]["position"][()].astype(float) for name in file if "position" in file[name]])
    exact, got = displacement(alone, first), displacement(whole, first)
    apart = np.abs(got - exact).max() / np.abs(exact).max()
    assert apart < OFF_COLUMN[precision], f"the ground is {apart:.3g} of its displacement off the column"
    return apart


def check_momentum(folder, dim, precision):
    """Along x and the vertical, since the ground is shaken and no damping acts."""
    lines = rows(folder)
    values = {name: np.array([float(line[k]) for line in lines[1:]]) for k, name in enumerate(lines[0])}
    shaken = np.flatnonzero(values["stage"] == 2)
    steps = np.diff(values["time"])[shaken - 1]
    kicks = np.diff(of_velocities(values["time"], values["dt"]))[shaken - 1]
    sides = [name[:-len("_force_x")] for name in lines[0] if name.startswith("wall_") and name.endswith("_force_x")]
    weight = 9.81 * values["soil_mass"][0]
    for axis in ("x", "xyz"[dim - 1]):
        force = sum(values[f"{side}_force_{axis}"] for side in sides)[shaken]
        gained = np.cumsum(kicks * (-weight if axis != "x" else 0) - steps * force)
        momentum = values[f"soil_momentum_{axis}"]
        error = np.abs(momentum[shaken] - momentum[shaken[0] - 1] - gained).max() / (weight * 0.3)
        assert error < (1e-10 if precision == "double" else 1e-4), f"the momentum along {axis} is {error:.3g} off"


def main():
    given, base = read_arguments(__doc__, "free_field")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    off, ranks = {"double": 0.0, "single": 0.0}, {"double": 0.0, "single": 0.0}
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        precision = draw.choice(given.precisions.split(","))
        level = draw.random() < 0.6
        options, column, sides = level_deck(draw, dim, precision) if level else (slope_deck(draw, dim), [], [])
        options += ["-precision", precision, "-p2g", draw.choice(["sequential", "atomic", "mosaic", "gather", "tile"])]
        try:
            whole = fresh(base / "whole")
            run(binary, empty, whole, *options, *sides)
            if level:
                off[precision] = max(off[precision], check_column(binary, empty, base, options, column, precision))
            else:
                check_momentum(whole, dim, precision)
            ranks[precision] = max(ranks[precision], check_repeats(binary, empty, base, options + sides, whole, draw, precision))
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, options + sides))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: level ground moves as a column but for {off['double']:.2g} of its displacement (single {off['single']:.2g}); "
          f"cut runs give the same bits; several ranks are {ranks['double']:.2g} apart from one (single {ranks['single']:.2g})")


if __name__ == "__main__":
    main()
