"""Level ground that starts with the stress of its weight, as a file of particles."""

import numpy as np

from mpm_regression import particles


def write_level(path, body, lower, upper, spacing, weight, k0):
    """Writes the box of ground from `lower` to `upper` [m] whose upper side is the surface: vertical stress of the unit weight
    `weight`, N/m3, horizontal stress `k0` times it. `spacing` of the particles, m; they must fill whole cells of the mesh, so
    that the weight is in balance to round-off."""
    place = particles.lattice(lower, upper, spacing)
    up = len(lower) - 1
    vertical = -weight * (upper[up] - place[:, up])
    stress = np.zeros((len(place), 6))
    stress[:, :3] = k0 * vertical[:, None]
    stress[:, up] = vertical
    particles.write(path, body, place, spacing, stress=stress)


def spacing_of(options, default):
    """Edge of the cells that a run's options name, m, or that of the deck."""
    return float(options[options.index("-mesh_spacing") + 1]) if "-mesh_spacing" in options else default
