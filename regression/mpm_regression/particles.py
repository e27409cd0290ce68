"""Initial particles for a body of shape `particles`: a lattice, and fields on it, in an HDF5 file written like a frame."""

import h5py
import numpy as np


def lattice(lower, upper, spacing):
    """Centres [N, dim] of the cubes of edge `spacing` [m] that fill the box from `lower` to `upper` [m]."""
    counts = [round((b - a) / spacing) for a, b in zip(lower, upper)]
    axes = [a + (np.arange(n) + 0.5) * spacing for a, n in zip(lower, counts)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(lower))


def write(path, body, position, spacing, **fields):
    """Writes particles, of volume spacing^dim unless `volume` [N], m3, is given, at `position` [N, dim], m. Fields: velocity [N, dim], m/s;
    stress [N, 6] (xx yy zz xy yz zx), Pa; plastic_strain [N]. Vectors are filled up with zeros to 3 components."""
    count, dim = position.shape
    with h5py.File(path, "w") as file:
        group = file.create_group(body)
        group["position"] = with_zeros(position)
        group["volume"] = fields.pop("volume", np.full(count, spacing**dim))
        for name, values in fields.items():
            group[name] = with_zeros(values) if name == "velocity" else values


def with_zeros(vectors):
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
