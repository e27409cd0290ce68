#!/usr/bin/env python3
"""Energy balances of random decks: soil and fluids of several laws, that fall, are pushed, damped, carried by water, in 2D and 3D.

    energy.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

For each deck: the row balances; the work of gravity is the weight times the fall of the centre of mass, but for half a step, for
what a correction of positions raises and for what walls take from PIC; the work of rigids that move evenly is their force times
their way; damping takes energy; the share that is missing is small; the balance changes nothing else in the history; a run that is
cut in two by a checkpoint gives the same bits; a run on two ranks, by another strategy, the same to round-off; one in single
precision begins as that in double precision does.
"""
import csv
import sys

import numpy as np

from folders import fresh, rows, run
from random_decks import draws_of, read_arguments

END = 0.25  # s
LAWS = [f"-clay_young 1e6 -clay_poisson 0.3 -clay_model {law}" for law in (
        "von_mises -clay_su 800", "linear_elastic", "tresca -clay_su 1500", "mohr_coulomb -clay_friction_deg 30 -clay_cohesion 200",
        "drucker_prager -clay_friction_deg 25 -clay_cohesion 300 -clay_match plane_strain")]
FLUIDS = [f"-clay_bulk_modulus 8e5 -clay_model {law}" for law in (
          "newtonian -clay_viscosity 10", "yield_stress_fluid -clay_shear_modulus 5e4 -clay_yield_stress 300 -clay_consistency 20")]
MISSING = 0.1  # of the largest energy or work: a few steps of coarse soil that strikes a wall
AT_WALLS = 0.02  # likewise, of the work of gravity with PIC: each step, a wall stops what PIC has brought to its nodes, before forces act


def deck_of(draw, dim):
    """Options of a deck, its gravity, and what it is made of."""
    span = "4,3" if dim == 2 else "4,1.5,3"
    lower, upper = ("0.5,0", "2,1.75") if dim == 2 else ("0.5,0,0", "2,1.5,1.75")
    zeros = ["0"] * (dim - 1)
    about = {"water": draw.random() < 0.2, "rigid": draw.random() < 0.5, "damping": draw.choice([0, 0, 0.2]),
             "update": draw.choice(["flip", "apic", "xpic", "pic"])}
    law = draw.choice(LAWS if about["water"] else LAWS + FLUIDS)
    side = "xmax" if dim == 2 else "zmin"
    options = (f"-dim {dim} -mesh_lower {','.join(['0'] * dim)} -mesh_upper {span} -mesh_spacing 0.25 -materials clay "
               f"-clay_density 1800 {law} -bodies soil -soil_shape box "
               f"-soil_lower {lower} -soil_upper {upper} -gravity {','.join(zeros)},-9.81 -soil_material clay "
               f"-soil_velocity {draw.uniform(-1, 1):.3f},{','.join(['0'] * (dim - 1))} -mesh_{side} {draw.choice(['roller', 'fixed'])} "
               f"-velocity_update {about['update']} -damping {about['damping']} "
               f"-particle_domain {draw.choice(['fixed', 'stretch', 'split'])} -f_bar_fraction {draw.choice([0, 0.98])} "
               f"-position_correction {draw.choice(['none', 'delta'])} "
               f"-soil_particles_per_cell {draw.choice([1, 2, 3] if dim == 2 else [1, 2])} -time_end {END} -history_interval 0.01 "
               f"-time_courant {draw.choice([0.1, 0.2, 0.3])} -output_frames off").split()
    if about["water"]:
        options += ["-water_level", "3", "-water_density", "1000"]
    if about["rigid"]:
        low, high = ("0.75,1.75", "1.5,2.25") if dim == 2 else ("0.75,0.25,1.75", "1.5,1,2.25")
        down = f"{draw.uniform(-0.3, 0.3):.3f},{','.join(['0'] * (dim - 2) + ['-1'])}"
        options += (f"-rigid_bodies plate -plate_shape box -plate_lower {low} -plate_upper {high} -plate_motion prescribed "
                    f"-plate_velocity {down}").split() + draw.choice([[], ["-plate_friction", "0.4"]])
    return options, about


def history(folder):
    with open(folder / "history.csv") as file:
        lines = list(csv.DictReader(file))
    return {name: np.array([float(line[name]) for line in lines]) for name in lines[0] if name != "wall_time"}


def check_row(h, about, dim, single):
    column = {name.split("_", 1)[1]: h[name] for name in h if name.startswith(("energy_", "work_"))}
    works = column["gravity"] + column["rigids"] + column["contact"] + column["damping"] + column["update"]
    scale = max(np.abs(column[name]).max() for name in ("kinetic", "internal", "gravity", "rigids"))
    left = column["kinetic"] - column["kinetic"][0] + column["internal"] + column["lost"] - works - column["error"]
    assert np.abs(left).max() < 1e-9 * scale, f"the row does not balance by {np.abs(left).max() / scale:.3g}"
    assert np.abs(column["error"]).max() < MISSING * scale, f"{np.abs(column['error']).max() / scale:.3g} are missing"
    up = "xyz"[dim - 1]
    if not about["water"] and h["soil_lost_mass"].max() == 0:
        exact = -9.81 * h["soil_mass"] * (h[f"soil_centre_{up}"] - h[f"soil_centre_{up}"][0]) + h.get("soil_raised_energy", 0)
        slack = 2 * 9.81 * h["dt"].max() * np.abs(h[f"soil_momentum_{up}"]).max()
        slack += ((1e-3 if single else 1e-9) + (AT_WALLS if about["update"] == "pic" else 0)) * scale
        assert np.abs(column["gravity"] - exact).max() < slack, "the work of gravity is not that of the centre"
    if about["rigid"]:
        exact = -sum(np.cumsum(h[f"plate_force_{a}"][1:] * np.diff(h[f"plate_{a}"])) for a in "xyz"[:dim])
        assert np.abs(column["rigids"][1:] - exact).max() < 1e-6 * scale, "the work of the rigid is not its force times its way"
    assert column["damping"].max() <= 0 and (about["damping"] == 0) == (column["damping"].min() == 0)
    assert (column["elastic"] >= 0).all() and column["dissipated"].min() > -0.02 * scale, "the soil gives energy from nothing"
    return column, scale


def without_energy(folder):
    head, *lines = rows(folder)
    kept = [k for k, name in enumerate(head) if not name.startswith(("energy_", "work_"))]
    return np.array([[float(line[k]) for k in kept] for line in lines])


def check_same(column, theirs, scale, bound, whose):
    """The first rows of two balances, before round-off grows."""
    for name, values in column.items():
        far = np.abs(values[:6] - theirs[name][:6]).max() / scale
        assert far < bound, f"{name} of {whose} is {far:.3g} off"


def check_deck(draw, do, about, dim, single, both):
    """do(name, option, ...) runs the deck into a folder of this name and returns it; both: the program has both precisions. Returns the
    share of the energy that is missing."""
    balance, serial = ["-output_energy", "on"], ["-backend", "serial", "-p2g", "tile"]
    whole = do("whole", *balance, *serial)
    column, scale = check_row(history(whole), about, dim, single)
    off, on = without_energy(do("off", *serial)), without_energy(whole)
    size = np.abs(on).max(axis=0) + 1e-9
    assert off.shape == on.shape and np.abs(off - on).max(axis=0).max() <= (1e-3 if single else 1e-7) * size.max()
    step = draw.randint(1, int(rows(whole)[-1][0]) - 1)
    do("cut", *balance, *serial, "-time_max_steps", step, "-checkpoint_interval", 1e3)
    cut = do("cut", *balance, *serial, "-restart", "latest")
    kept = [line for line in rows(cut) if line in rows(whole)]
    assert kept == rows(whole), f"cut at step {step}: {len(rows(whole)) - len(kept)} rows differ"
    other = [*balance, "-backend", draw.choice(["serial", "openmp"]), "-p2g", draw.choice(["tile", "gather", "atomic"])]
    pair = do("pair", *other, prefix=("mpirun", "-n", "2", "--bind-to", "none"))
    check_same(column, check_row(history(pair), about, dim, single)[0], scale, 1e-3 if single else 1e-8, "two ranks")
    if single and both:
        exact = do("double", *balance, *serial, "-precision", "double")
        check_same(column, check_row(history(exact), about, dim, False)[0], scale, 1e-3, "the run in double precision")
    return np.abs(column["error"]).max() / scale


def main():
    given, base = read_arguments(__doc__, "energy")
    empty = base / "empty.opts"
    empty.write_text("\n")
    missing = []
    for number in range(given.count):
        draw = draws_of(given, number)
        dim, precision = int(draw.choice(given.dims.split(","))), draw.choice(given.precisions.split(","))
        options, about = deck_of(draw, dim)
        common = [*options, "-precision", precision]

        def do(name, *more, **how):
            folder = base / name if "-restart" in more else fresh(base / name)
            run(given.binary, empty, folder, *common, *more, **how)
            return folder

        try:
            missing.append(check_deck(draw, do, about, dim, precision == "single", "double" in given.precisions))
        except AssertionError as error:
            (base / "failed.txt").write_text(f"{error}\n\n{' '.join(map(str, common))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {base / 'failed.txt'}")
    print(f"{given.count} decks: the rows balance, gravity and rigids do the work that they do; cut runs give the same bits; "
          f"at most {100 * max(missing):.2g} % of the energy is missing, {100 * np.median(missing):.2g} % in half of the decks")


main()
