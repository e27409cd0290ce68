"""Plate that starts to move in a fluid

A plate starts to move along itself at $U$ = 0.1 m/s in a fluid at rest of the kinematic viscosity $\\nu$ = 0.005 m2/s. At the distance
$y$ the velocity is $U\\, \\mathrm{erfc}(y / 2 \\sqrt{\\nu t})$ (Stokes 1851), without inertia of another kind. Here the fluid moves and the wall
is at rest; the difference is the answer. The velocity is that of the nodes, after 1 s, in the middle half metre of 3 m of fluid.
"""

from math import erf

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

U, NU = 0.1, 0.005
LONG = True
DISTANCES = (0.05, 0.1, 0.15)
RUNS = {"d_20mm": "", "d_10mm": "-mesh_spacing 0.01"}


def profile(run):
    """Distances from the wall, m, and velocity of the wall's frame less that of the fluid, m/s."""
    frame = last_frame(run, "layer")
    x, y = frame["position"][:, 0], frame["position"][:, 1]
    middle = np.abs(x - np.median(x)) < 0.25
    rows = np.floor(y / (run.number("mesh_spacing") / 2)).astype(int)
    inside = [middle & (rows == row) for row in np.unique(rows[middle])]
    return (np.array([field[row].mean() for row in inside]) for field in (y, U - frame["grid_velocity"][:, 0]))


def exact(y):
    return U * (1 - erf(y / (2 * np.sqrt(NU))))


def check(runs):
    for name in RUNS:
        y, velocity = profile(runs[name])
        for distance in DISTANCES:
            yield Row(f"velocity at {distance:g} m, {name} (m/s)", np.interp(distance, y, velocity), exact(distance), 0.02, "Stokes 1851",
                      relative=True)


def draw(axes, runs):
    for name in RUNS:
        y, velocity = profile(runs[name])
        axes.plot(velocity, y, ".", ms=4, label=name)
    heights = np.linspace(0, 0.52, 100)
    axes.plot([exact(y) for y in heights], heights, "k--", lw=0.8, label="exact")
    axes.set(xlabel="velocity (m/s)", ylabel="distance from the plate (m)")
    axes.legend()
