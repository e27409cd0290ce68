#!/usr/bin/env python3
"""Random probes and rasters.

    probes.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

A deck has soil that collapses or slides, with random probes of all kinds, and rasters. The mass that has passed a section must be the
change of the mass beyond it, which is found from the frames where nothing has left; a particle that is followed must be that of the frames;
the rasters must hold the volume of the soil at the end, and no raster may have more now than at its greatest. A run that is cut in two
by a checkpoint must give the same history and rasters bit by bit; runs on 2 and 3 ranks the same to round-off. Some decks have two
stages.
"""
import sys

import h5py
import numpy as np

from folders import checkpoints, differences, fresh, rows, run
from random_decks import draws_of, read_arguments

END = 0.12  # s
FEATURES = [[], [], ["-particle_domain", "stretch"], ["-particle_domain", "split"], ["-velocity_update", "apic"]]


def vector(values):
    return ",".join(repr(float(x)) for x in values)


def probe_options(draw, name, kind, dim, lower, upper):
    """Options of a probe, somewhere in the mesh."""
    inside = lambda d: draw.uniform(lower[d] + 0.1, upper[d] - 0.1)  # noqa: E731
    options = [f"-{name}_kind", kind]
    if kind == "section":
        axis = draw.randrange(dim)
        options += [f"-{name}_axis", "xyz"[axis], f"-{name}_at", repr(inside(axis))]
    elif kind == "gauge":
        options += [f"-{name}_at", vector(inside(d) for d in range(dim - 1))]
        options += draw.choice([[], [f"-{name}_width", draw.choice(["0", "0.1", "0.7"])]])
    else:
        options += [f"-{name}_at", vector([draw.uniform(lower[d] + 0.1, lower[d] + 0.9) for d in range(dim)])]
    return options + draw.choice([[], [], [f"-{name}_bodies", draw.choice(["one", "two", "one,two"])]])


def make_deck(draw, dim):
    """Options, and the names of the probes by kind."""
    lower = [draw.choice([0.0, -3.25, 100.0]) for _ in range(dim)]
    size = [3.0, 2.0] if dim == 2 else [2.5, 1.0, 1.5]
    upper = [a + b for a, b in zip(lower, size)]
    corner = lambda *x: vector(a + b for a, b in zip(lower, x))  # noqa: E731
    across = [] if dim == 2 else [1.0]
    options = (f"-dim {dim} -mesh_lower {vector(lower)} -mesh_upper {vector(upper)} -mesh_spacing 0.25 -materials sand "
               f"-sand_model mohr_coulomb -sand_density 1800 -sand_young 1e6 -sand_poisson 0.3 -sand_cohesion 200 -sand_friction_deg 25 "
               f"-bodies one,two -one_material sand -one_shape box -one_lower {corner(0, *[0] * (dim - 1))} -one_upper {corner(1, *across, 0.5)} "
               f"-two_material sand -two_shape box -two_lower {corner(0, *[0] * (dim - 2), 0.5)} -two_upper {corner(1, *across, 1)} "
               f"-one_velocity {vector([draw.uniform(0, 4)] + [0] * (dim - 1))} -two_velocity {vector([draw.uniform(0, 6)] + [0] * (dim - 1))} "
               f"-gravity {vector([0] * (dim - 1) + [-9.81])} -mesh_xmax free -mesh_{'xyz'[dim - 1]}max free "
               f"-history_interval {draw.choice(['0.01', '0.0037'])} -output_interval 0.04").split()
    options += draw.choice(FEATURES)
    kinds = [draw.choice(["point", "particle", "gauge", "section"]) for _ in range(draw.randint(1, 5))]
    kinds += ["particle", "section"]
    names = [f"p{k}" for k in range(len(kinds))]
    options += ["-probes", ",".join(names)]
    for name, kind in zip(names, kinds):
        options += probe_options(draw, name, kind, dim, lower, upper)
    options += ["-output_rasters", "on", "-raster_spacing", draw.choice(["0.25", "0.1", "0.4"])]
    options += draw.choice([[], ["-raster_interval", "0.007"], ["-raster_threshold_speed", "0.5"], ["-raster_bodies", "two"]])
    options += ["-time_end", str(END)] if draw.random() < 0.7 else ["-stages", "first,second", "-time_end", str(END / 2), *draw.choice(
        [[], ["-second_remove", "two"], ["-first_reset", "on"]])]
    return options, dict(zip(names, kinds))


def option(options, name, default=""):
    return options[options.index(name) + 1] if name in options else default


def table(folder):
    lines = rows(folder)
    return {name: np.array([float(line[k]) for line in lines[1:]]) for k, name in enumerate(lines[0])}


def soil_of(path, bodies):
    with h5py.File(path) as file:
        groups = [file[name] for name in bodies if name in file]
        return float(file.attrs["time"]), *(np.concatenate([group[key][()] for group in groups]) for key in ("position", "mass", "volume"))


def gap_of(path, bodies):
    """Volume strain by which particles have parted, 0 where their law has none."""
    with h5py.File(path) as file:
        groups = [file[name] for name in bodies if name in file]
        return np.concatenate([group["parted_volume"][()] if "parted_volume" in group else np.zeros(len(group["volume"])) for group in groups])


def check_sections(folder, options, kinds, precision, stages):
    """Mass beyond sections by the frames, to the half width of a particle."""
    values = table(folder)
    if stages or any(values[f"{body}_lost_mass"][-1] > 0 for body in ("one", "two")):
        return
    frames = sorted(folder.glob("frames/*.h5"))
    for name, kind in kinds.items():
        bodies = option(options, f"-{name}_bodies", "one,two").split(",")
        if kind != "section":
            continue
        axis, place = "xyz".index(option(options, f"-{name}_axis")), float(option(options, f"-{name}_at"))
        bounds = []
        for path in (frames[0], frames[-1]):
            time, position, mass, _ = soil_of(path, bodies)
            x = position[:, axis]
            bounds.append((time, mass[x > place + 0.13].sum(), mass[x > place - 0.13].sum()))
        (_, least_then, most_then), (time, least, most) = bounds
        passed = np.interp(time, values["time"], values[f"{name}_mass"])
        slack = 1e-6 * max(most, 1)
        assert least - most_then - slack <= passed <= most - least_then + slack, \
            f"section {name}: {passed:.6g} kg have passed, and by the frames from {least - most_then:.6g} to {most - least_then:.6g}"
        assert abs(values[f"{name}_mass"] - values[f"{name}_volume"] * 1800).max() <= (1e-9 if precision == "double" else 1e-3) * 1800, \
            f"section {name}: mass and volume differ"


def check_particles(folder, kinds):
    """A particle that is followed is one of the frames, at each frame."""
    values = table(folder)
    for name, kind in kinds.items():
        if kind != "particle" or not np.isfinite(values[f"{name}_x"]).all():
            continue
        for path in sorted(folder.glob("frames/*.h5")):
            time, position, *_ = soil_of(path, ("one", "two"))
            row = np.flatnonzero(np.abs(values["time"] - time) < 1e-12)
            if len(row) == 0:
                continue
            place = [values[f"{name}_{axis}"][row[0]] for axis in "xyz" if f"{name}_{axis}" in values]
            assert np.abs(position[:, :len(place)] - place).max(axis=1).min() < 1e-5, f"{name} is not where a particle is at {time} s"


def raster_values(folder):
    """(max_depth, max_speed, arrival, final depth, area of a cell)"""
    if (folder / "rasters.csv").exists():
        data = np.genfromtxt(folder / "rasters.csv", delimiter=",", skip_header=1)
        return [*data.T[1:], data[1, 0] - data[0, 0]]
    values = []
    for name in ("max_depth", "max_speed", "arrival_time", "final_depth"):
        lines = (folder / f"raster_{name}.asc").read_text().splitlines()
        values.append(np.array([line.split() for line in lines[6:]], dtype=float))
    return [*values, float(lines[4].split()[1]) ** 2]


def check_rasters(folder, options):
    depth, speed, arrival, final, area = raster_values(folder)
    bodies, frame = option(options, "-raster_bodies", "one,two").split(","), sorted(folder.glob("frames/*.h5"))[-1]
    _, position, _, volume = soil_of(frame, bodies)
    volume = volume * np.exp(-np.minimum(gap_of(frame, bodies), 4))  # depths leave out the gaps of soil that has parted
    upper = float(option(options, "-mesh_upper").split(",")[0])
    if len(volume) and position[:, 0].max() < upper - 0.15:
        held = final.sum() * area
        assert abs(held - volume.sum()) <= 1e-5 * volume.sum(), f"the rasters hold {held:.9g} m3 of {volume.sum():.9g}"
    assert (final <= depth + 1e-9).all(), "the depth at the end is more than the greatest"
    assert ((np.nan_to_num(arrival, nan=-9999) >= 0) <= (depth > 0.025 - 1e-9)).all(), "soil arrived where none is deep enough"
    return depth, speed, arrival, final


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
    for path in whole.glob("raster*"):
        assert path.read_bytes() == (cut / path.name).read_bytes(), f"cut at step {at} of {step}: {path.name} differs"


def check_ranks(binary, empty, base, options, whole, draw, precision):
    ranks = draw.choice([2, 3])
    many = fresh(base / "many")
    run(binary, empty, many, *options, prefix=("mpirun", "-n", str(ranks), "--bind-to", "none"))
    mine, theirs = table(many), table(whole)
    bound = 1e-6 if precision == "double" else 0.02
    for name in (name for name in theirs if name.startswith("p") and name[1].isdigit()):
        scale = max(np.nanmax(np.abs(theirs[name]), initial=0), 1 if "stress" not in name and "pressure" not in name else 1e4)
        assert len(mine[name]) == len(theirs[name]), f"{ranks} ranks: other rows"
        both = np.isfinite(mine[name]) & np.isfinite(theirs[name])
        assert both.sum() >= len(both) * 0.97 or (np.isnan(mine[name]) == np.isnan(theirs[name])).all(), f"{ranks} ranks: {name} is elsewhere"
        off = np.abs(mine[name] - theirs[name])[both].max(initial=0) / scale
        assert off < bound, f"{ranks} ranks: {name} is {off:.3g} off"
    for got, wanted in zip(raster_values(many)[:2], raster_values(whole)[:2]):
        assert np.abs(got - wanted).max() < bound * max(wanted.max(), 1), f"{ranks} ranks: rasters differ by {np.abs(got - wanted).max():.3g}"


def main():
    given, base = read_arguments(__doc__, "probes")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        options, kinds = make_deck(draw, dim)
        precision = draw.choice(given.precisions.split(","))
        options += ["-backend", draw.choice(["serial", "openmp"]), "-precision", precision, "-p2g", draw.choice(["tile", "gather"])]
        try:
            whole = fresh(base / "whole")
            run(binary, empty, whole, *options)
            check_sections(whole, options, kinds, precision, "-stages" in options)
            check_particles(whole, kinds)
            check_rasters(whole, options)
            check_cut(binary, empty, base, options, whole, draw)
            if draw.random() < 0.5:
                check_ranks(binary, empty, base, options, whole, draw, precision)
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, options))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: sections, particles and rasters are those of the frames; cut runs give the same bits")


main()
