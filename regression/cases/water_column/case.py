"""Level ground under water, at rest

Level ground in two layers: 2 m of 18 kN/m3 ($K_0$ = 0.5) on 4 m of 20 kN/m3 ($K_0$ = 0.6), $\\gamma_w$ = 10 kN/m3. The water
stands above the ground, at the boundary of the layers, within a cell, or within a row of particles. Effective stress that
carries the soil above, less the water that it displaces, is in equilibrium: nothing moves in 1000 steps. The total stress is
the effective one less the pore pressure $\\gamma_w$ times the depth below the level, and at the seabed it is that pressure
alone. The force on the base in excess of the hydrostatic pressure is the buoyant weight.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row

SPACING, TOP, BOUNDARY, G = 0.25, 6.0, 4.0, 10.0  # m, m, m, m/s2
DENSITY, K0, WATER = {"top": 1800.0, "ground": 2000.0}, {"top": 0.5, "ground": 0.6}, 1000.0
WAVE = 120.0  # m/s, about
LEVELS = {"seabed": 9.0, "layers": 4.0, "cell": 2.7, "row": 4.93, "dry": -5.0}
IN_3D = (" -dim 3 -mesh_lower 0,0,0 -mesh_upper 1,1,7 -gravity 0,0,-10 -mesh_ymax roller -mesh_zmin roller -mesh_zmax free")
RUNS = {name: f"-water_level {level} -top_file {{start}} -ground_file {{start}}" for name, level in LEVELS.items()}
RUNS |= {"layers_3D": RUNS["layers"] + IN_3D, "undrained": RUNS["cell"] + " -upper_pore_stiffness 1e9 -lower_pore_stiffness 1e9"}


def level_of(run):
    return LEVELS[run.split("_")[0] if run.split("_")[0] in LEVELS else "cell"]


def submerged(y, level):
    """Share of a particle at height y that is below the level."""
    return np.clip((level - y) / SPACING + 0.5, 0, 1)


def rows(level):
    """Heights of the rows of particles from the top down, m, their body, and effective vertical stress, Pa."""
    y = TOP - SPACING * (np.arange(round(TOP / SPACING)) + 0.5)
    body = np.where(y > BOUNDARY, "top", "ground")
    weight = (np.array([DENSITY[b] for b in body]) - WATER * submerged(y, level)) * G * SPACING
    return y, body, -(np.cumsum(weight) - weight / 2)


def prepare(run, path, options):
    import h5py

    dim = 3 if "3D" in run else 2
    y, body, vertical = rows(level_of(run))
    path.unlink(missing_ok=True)
    with h5py.File(path, "w") as file:
        for name, low, high in (("top", BOUNDARY, TOP), ("ground", 0.0, BOUNDARY)):
            place = particles.lattice((*[0.0] * (dim - 1), low), (*[1.0] * (dim - 1), high), SPACING)
            at = np.round((TOP - place[:, -1]) / SPACING - 0.5).astype(int)
            stress = np.zeros((len(place), 6))
            stress[:, :3] = K0[name] * vertical[at, None]
            stress[:, dim - 1] = vertical[at]
            group = file.create_group(name)
            group["position"], group["stress"] = particles.with_zeros(place), stress
            group["volume"] = np.full(len(place), SPACING**dim)


def at_depth(run, depth, name):
    """Total vertical and horizontal stress and pore pressure [Pa] at a depth below the ground, between rows."""
    frame = last_frame(run, name)
    up = int(run.number("dim", 2)) - 1
    y = frame["position"][:, up]
    near = np.abs(y - (TOP - depth)) < 0.51 * SPACING
    pore = frame["pore_pressure"][near].mean()
    return frame["stress"][near, up].mean(), frame["stress"][near, 0].mean(), pore


def check(runs):
    for name, run in runs.items():
        level, speed = level_of(name), 0.0
        for body in ("top", "ground"):
            speed = max(speed, np.abs(last_frame(run, body)["velocity"]).max())
        yield Row(f"largest speed over that of the waves, {name}", speed / WAVE, 0, 1e-12, "equilibrium", single=1e-5)
        y, body, vertical = rows(level)
        weight = sum((DENSITY[b] - WATER * s) * G * SPACING for b, s in zip(body, submerged(y, level)))
        side = "z" if "3D" in name else "y"
        force = run.history[f"wall_{side}min_force_{side}"][-1]
        yield Row(f"force on the base over the buoyant weight, {name}", -force / weight, 1, 1e-10, "equilibrium", single=1e-5)
    total, _, pore = at_depth(runs["layers"], 4.0, "ground")
    sideways = at_depth(runs["layers"], 4.0, "ground")[1]
    yield Row("effective vertical stress at 4 m, level at 2 m (kPa)", -(total + pore) / 1e3, 56, 1e-6, "2 m of 18 and 2 m of 10 kN/m3",
              relative=True, single=1e-5)
    yield Row("effective horizontal stress at 4 m (kPa)", -(sideways + pore) / 1e3, 33.6, 1e-6, "0.6 times it", relative=True,
              single=1e-5)
    yield Row("pore pressure at 4 m (kPa)", pore / 1e3, 20, 1e-9, "10 kN/m3 times 2 m", relative=True, single=1e-5)
    total, _, pore = at_depth(runs["seabed"], 0.25, "top")
    yield Row("total vertical stress 0.25 m below the seabed under 3 m of water (kPa)", -total / 1e3, 30 + 0.25 * 18, 1e-9,
              "water and soil above", relative=True, single=1e-5)
    excess = max(np.abs(last_frame(runs["undrained"], body)["excess_pore_pressure"]).max() for body in ("top", "ground"))
    yield Row("largest excess pore pressure at rest, undrained (Pa)", excess, 0, 1e-6, "nothing strains", single=50)
