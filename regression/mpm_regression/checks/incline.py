"""Shared by the cases of a block on an incline: the block with the stress of its weight, and its acceleration."""

import numpy as np

from mpm_regression import particles

LENGTH, HEIGHT, DEPTH = 2.0, 0.5, 0.4  # m; the depth in 3D
DENSITY, POISSON = 2000.0, 0.3


def write_block(path, origin, spacing, push, dim=2, angle=0.0):
    """Writes the block with its lower back corner at `origin` [dim], m, on a plane that climbs by `angle`, rad. `push` is
    the part of the gravity that acts into the plane, m/s2. `spacing` of the particles, m."""
    size = (LENGTH, HEIGHT) if dim == 2 else (LENGTH, DEPTH, HEIGHT)
    place = particles.lattice([0] * dim, size, spacing)
    up = dim - 1
    normal = -DENSITY * push * (HEIGHT - place[:, up])  # Pa; nothing along the block, plane strain across it
    c, s = np.cos(angle), np.sin(angle)
    stress = np.zeros((len(place), 6))
    xx, yy, zz, shear = (0, 1, 2, 3) if dim == 2 else (0, 2, 1, 5)
    stress[:, xx], stress[:, yy], stress[:, shear] = normal * s * s, normal * c * c, -normal * s * c
    stress[:, zz] = POISSON * normal
    position = place.copy()
    position[:, 0], position[:, up] = c * place[:, 0] - s * place[:, up], s * place[:, 0] + c * place[:, up]
    particles.write(path, "block", position + origin, spacing, stress=stress)


def centre(run, angle=0.0):
    """Movement of the centre of mass along the plane, m, at each row."""
    place = run.columns("block_centre_")
    return (place[:, 0] - place[0, 0]) * np.cos(angle) + (place[:, -1] - place[0, -1]) * np.sin(angle)


def acceleration(run, angle=0.0, start=0.2):
    """Acceleration along the plane from `start` on, m/s2: twice the leading coefficient of a parabola."""
    t = run.history["time"]
    late = t > start
    return 2 * np.polyfit(t[late], centre(run, angle)[late], 2)[0]


def final_speed(run, angle=0.0):
    """Speed along the plane, m/s: mean over the last 0.1 s."""
    t = run.history["time"]
    late = t > t[-1] - 0.1
    return np.polyfit(t[late], centre(run, angle)[late], 1)[0]
