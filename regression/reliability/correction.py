#!/usr/bin/env python3
"""Random soil that flows, whose positions are corrected.

    correction.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single] [--backends serial,openmp]

Columns and heaps of fluid, mud, clay and sand, with random updates, domains, strategies and back ends, fall apart between smooth sides,
some against a rigid block. At every row the momentum of the soil must be what gravity and the forces on the sides have made of it, so that the
correction keeps it to round-off; no particle is in the block; mass stays. A run that is cut in two by a checkpoint must give the same bits
as the whole one, and a short run on two ranks the same to round-off. Elastic soil that is thrown must move as without the correction, to
the bit.
"""
import sys

import h5py
import numpy as np

from folders import fresh, frames, rows, run
from random_decks import draws_of, read_arguments
from sides import check_cut, check_momentum, vector

END = 0.3  # s
LAWS = {"fluid": "newtonian -soil_bulk_modulus 2e5 -soil_viscosity 0.1",
        "mud": "yield_stress_fluid -soil_bulk_modulus 2e5 -soil_shear_modulus 2e4 -soil_yield_stress 50 -soil_consistency 5",
        "clay": "von_mises -soil_su 300 -soil_young 3e5 -soil_poisson 0.3",
        "sand": "mohr_coulomb -soil_cohesion 0 -soil_friction_deg 30 -soil_young 3e5 -soil_poisson 0.3",
        "elastic": "linear_elastic -soil_young 3e5 -soil_poisson 0.3"}


def make_deck(draw, dim, law):
    across = [2.0, 1.5] if dim == 2 else [2.0, 0.5, 1.5]
    filled = [draw.choice([0.6, 1.0]), *([0.5] if dim == 3 else []), draw.choice([0.7, 1.0, 1.13])]
    sides = [f"{'xyz'[d]}{side}" for d in range(dim) for side in ("min", "max") if (d, side) != (dim - 1, "max")]
    gravity = [draw.uniform(-2, 2) if law != "elastic" else 0.0, *([0.0] * (dim - 2)), -9.81]
    domain = draw.choice(["fixed", "stretch", "split"])
    options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.125 -materials soil "
               f"-soil_model {LAWS[law]} -soil_density 1500 -bodies heap -heap_material soil -heap_shape box "
               f"-heap_lower {vector([0] * dim)} -heap_upper {vector(filled)} -gravity {vector(gravity)} -mesh_{'xyz'[dim - 1]}max free "
               f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -particle_domain {domain} -position_correction delta "
               f"-position_correction_rate {draw.choice(['5', '20', '60'])} -history_interval 0.01 -output_interval 0.1 -time_end {END}").split()
    for name in sides:
        options += [f"-mesh_{name}", "friction", f"-mesh_{name}_friction", "0"]
    block = law != "elastic" and draw.random() < 0.3
    if block:
        lower, upper = [1.25, *([0.0] if dim == 3 else []), 0.0], [1.5, *([0.5] if dim == 3 else []), 0.25]
        options += (f"-rigid_bodies block -block_shape box -block_lower {vector(lower)} -block_upper {vector(upper)} -block_motion fixed").split()
    return options, np.array(gravity), block


def check_block(folder, dim):
    """The block's corners count as rounded, and nodes stop soil a part of a cell late."""
    for path in frames(folder):
        with h5py.File(path) as file:
            place = file["heap/position"][()]
        deep = (place[:, 0] > 1.25 + 0.06) & (place[:, 0] < 1.5 - 0.06) & (place[:, dim - 1] < 0.25 - 0.06)
        assert not deep.any(), f"{deep.sum()} particles are in the block in {path.name}"


def check_mass(folder):
    lines = rows(folder)
    kept, lost = (np.array([float(line[lines[0].index(f"heap_{name}")]) for line in lines[1:]]) for name in ("mass", "lost_mass"))
    assert np.abs(kept + lost - kept[0]).max() < 1e-5 * kept[0], "mass is missing"


def check_ranks(binary, empty, base, options, precision):
    """A few rebuilds, before round-off grows: the history of two ranks and of one."""
    short = [*options, "-time_end", "0.1"]
    one, two = fresh(base / "one"), fresh(base / "two")
    run(binary, empty, one, *short)
    run(binary, empty, two, *short, prefix=("mpirun", "-n", "2", "--bind-to", "none"))
    names = rows(one)[0]
    a, b = (np.array(rows(folder)[1:], dtype=float) for folder in (one, two))
    assert a.shape == b.shape, "other rows on two ranks"
    for name in ("heap_centre_x", "heap_kinetic_energy", "heap_corrected_energy"):
        k = names.index(name)
        scale = np.abs(a[:, names.index("heap_kinetic_energy")]).max() if "energy" in name else 1.0
        error = np.abs(a[:, k] - b[:, k]).max() / scale
        assert error < (1e-8 if precision == "double" else 2e-3), f"{name} differs by {error:.3g} on two ranks"


def check_elastic(binary, empty, base, options, whole):
    """What the correction leaves alone goes on to the same bits."""
    none = fresh(base / "none")
    cut = options.index("-position_correction")
    run(binary, empty, none, *options[:cut], *options[cut + 4:], "-rebuild_margin", "0.45")
    lines, plain = rows(whole), rows(none)
    kept = [k for k, name in enumerate(lines[0]) if name in plain[0]]
    assert [[line[k] for k in kept] for line in lines] == plain, "elastic soil moves otherwise than without the correction"


def main():
    given, base = read_arguments(__doc__, "correction", backends="serial,openmp")
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    for number in range(given.count):
        draw = draws_of(given, number)
        dim, law = int(draw.choice(given.dims.split(","))), draw.choice(["fluid", "fluid", "mud", "clay", "sand", "elastic"])
        options, gravity, block = make_deck(draw, dim, law)
        precision = draw.choice(given.precisions.split(","))
        options += ["-backend", draw.choice(given.backends.split(",")), "-precision", precision,
                    "-p2g", draw.choice(["tile", "gather", "sequential"])]
        try:
            whole = fresh(base / "whole")
            run(given.binary, empty, whole, *options)
            check_mass(whole)
            if block:
                check_block(whole, dim)
            else:
                check_momentum(whole, gravity, dim, precision, body="heap")
            if law == "elastic":
                check_elastic(given.binary, empty, base, options, whole)
            if draw.random() < 0.5:
                check_cut(given.binary, empty, base, options, whole, draw)
            if draw.random() < 0.3:
                check_ranks(given.binary, empty, base, options, precision)
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, options))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: the correction keeps momentum and mass, restarts and ranks agree, elastic soil is left alone")


if __name__ == "__main__":
    main()
