"""Soil at general positions: a lattice of particles that three shears have moved, 6 to 10 a cell. The particles of a lattice cross
their cells together, and their bins are all as full; these do neither."""

import re

import h5py
import numpy

from soil_mpm.tree import ROOT

K_SHEARS = (0.37, 0.23, 0.41)  # of x along y, of y along z, of z along x
K_LENGTH = 2.7                 # m, edge of the cube of soil of inputs/footing_square.opts


def positions(spacing, per_cell=2):
    """Positions [number, 3] of the particles of a cube [0, K_LENGTH]^3 with cells of `spacing`, all in m. What a shear moves out of the cube
    comes in at the other side."""
    count = round(per_cell * K_LENGTH / spacing)
    at = (numpy.arange(count) + 0.5) / count  # of the length
    x, y, z = numpy.meshgrid(at, at, at, indexing="ij")
    x = (x + K_SHEARS[0] * y) % 1
    y = (y + K_SHEARS[1] * z) % 1
    z = (z + K_SHEARS[2] * x) % 1
    return K_LENGTH * numpy.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def write_deck(path, spacing):
    """PATH.opts, the square footing with such soil, which is in PATH.h5. Returns the number of particles."""
    at = positions(spacing)
    with h5py.File(f"{path}.h5", "w") as file:
        file["soil/position"] = at
        file["soil/volume"] = numpy.full(len(at), K_LENGTH**3 / len(at))
    lines = (ROOT / "inputs" / "footing_square.opts").read_text().splitlines()
    lines = [line for line in lines if not re.match(r"-soil_(shape|lower|upper) ", line)]
    with open(f"{path}.opts", "w") as file:
        file.write("\n".join([*lines, "-soil_shape particles", f"-soil_file {path}.h5"]) + "\n")
    return len(at)
