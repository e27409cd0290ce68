"""An infinite slope with seepage parallel to it

A layer of 3 m (vertically) at 22 degrees, saturated up to its surface, unit weight 19.5 kN/m³, $c$ = 5 kPa, $\\varphi$ = 32 degrees: the
factor of safety is $(c + (\\gamma z \\cos^2\\beta - u) \\tan\\varphi) / (\\gamma z \\sin\\beta \\cos\\beta)$ = 1.0146 with
$u = \\gamma_w z \\cos^2\\beta$, while the dry slope has 1.79. With strengths by which it is 1/0.98 the layer stays, with 1/1.05 it moves.
The water seeps at the rate $k \\sin\\beta$. Periodic sides; the layer begins in equilibrium, with water at rest.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row
from soil_mpm.results import read_frame

SLOPE, WEIGHT, WATER, DEPTH = np.radians(22), 19.5e3, 9.81e3, 3 * np.cos(np.radians(22))  # -, N/m3, N/m3, m normal to the slope
COHESION, FRICTION, SAFETY, CELL = 5e3, np.tan(np.radians(32)), 1.01462, 0.23179594  # Pa, -, -, m
PRECISIONS = ("double",)
LONG = True


def strength(share):
    """Options of strengths, with the factor of safety 1/share."""
    less = SAFETY * share
    return f"-layer_file {{start}} -soil_cohesion {COHESION / less} -soil_friction_deg {np.degrees(np.arctan(FRICTION / less))}"


SHARES = {"stays": 0.98, "moves": 1.05}
RUNS = {name: strength(share) for name, share in SHARES.items()}


def prepare(run, path, options):
    place = particles.lattice((0, 0), (8 * CELL, 12 * CELL), CELL / 2)
    depth = DEPTH - place[:, 1]
    stress = np.zeros((len(place), 6))
    normal, shear = (WEIGHT - WATER) * np.cos(SLOPE) * depth, WEIGHT * np.sin(SLOPE) * depth  # Pa
    # Along the slope as much as the circle of the stress at failure has there.
    stress[:, 1], stress[:, 3] = -normal, shear
    stress[:, 0] = -normal - 2 * shear * FRICTION / (SAFETY * SHARES[run])
    stress[:, 2] = (stress[:, 0] + stress[:, 1]) / 2
    particles.write(path, "layer", place, CELL / 2, stress=stress, excess_pore_pressure=WATER * np.cos(SLOPE) * depth)


def check(runs):
    for name, run in runs.items():
        groups = [read_frame(path)[1]["layer"] for path in (run.frames[0], run.frame)]
        speed = groups[1]["velocity"][:, 0].mean()
        if name == "moves":
            free = 9.81 * np.sin(SLOPE)  # m/s2
            yield Row("speed of the layer after 1 s over that of free fall along the slope, moves", speed / (1.0 * free), 0.01, 0, "limit equilibrium",
                      at_least=True)
            continue
        yield Row("movement of the layer in 1 s (m), stays", (groups[1]["position"] - groups[0]["position"])[:, 0].max(), 0, 2e-3,
                  "limit equilibrium")
        y, pressure = groups[1]["position"][:, 1], groups[1]["pore_pressure"]
        lowest = y < CELL
        exact = WATER * np.cos(SLOPE) * (DEPTH - y[lowest].mean())
        yield Row("pressure in the lowest cells over that of seepage", pressure[lowest].mean() / exact, 1, 0.01, "seepage along the slope")
        yield Row("flux along the slope over k sin(slope)", groups[1]["darcy_flux"][:, 0].mean() / (1e-2 * np.sin(SLOPE)), 1, 0.01,
                  "Darcy's law")
