"""What a slide does: its run-out, the stored curves beside it, and the velocity over its height. Needs numpy and h5py."""

import csv

import numpy as np

from results import CASES

NORMALS = {"gradient": "normals of the mass gradient", "flat": "the base's own normal"}


def slides(run):
    """Names of the bodies that run out over rigids of which none moves."""
    if not run.words("rigid_bodies") or run.moving_rigids():
        return []
    return [body for body in run.words("bodies") if f"{body}_xmax" in run.history]


def run_out(run, body, column="xmax"):
    """Run-out of a body's toe since the start [m] at each row of the history: of the furthest particle, or with
    column="xq999" of the 99.9th percentile of the particles' x."""
    toe = run.history[f"{body}_{column}"]
    return toe - toe[0]


def at_time(run, values, time):
    """A column of the history at one time [s], between rows linearly; NaN where the run has not come so far."""
    t = run.history["time"]
    return np.interp(time, t, values) if t[0] <= time <= t[-1] * (1 + 1e-9) else np.nan


def time_of_frame(run):
    """Time of the largest kinetic energy of all bodies [s]: when the most is to be seen."""
    energy = sum(run.history[f"{body}_kinetic_energy"] for body in run.words("bodies"))
    return run.history["time"][np.argmax(energy)]


def grid_velocity(fields):
    """Velocity of a body's particles [N, 3] as the nodes see it, m/s. Older frames hold the particles' own only."""
    return fields.get("grid_velocity", fields["velocity"])


def profile(fields, station, width, vertical, height):
    """Velocity in x over the height at x = station: middles of layers of `height` [m] and the mean grid velocity [m/s]
    in those that hold particles of the column of `width` [m]."""
    position = fields["position"]
    inside = np.abs(position[:, 0] - station) < width / 2
    layer = np.floor(position[inside, vertical] / height).astype(int)
    if not len(layer):
        return np.empty(0), np.empty(0)
    lowest = layer.min()
    count = np.bincount(layer - lowest)
    total = np.bincount(layer - lowest, grid_velocity(fields)[inside, 0])
    full = np.flatnonzero(count)
    return (full + lowest + 0.5) * height, total[full] / count[full]


# ---------------------------------------------------------------------------------------------- stored curves


def same_values(text, wanted):
    """Are two options' texts the same numbers?"""
    try:
        a, b = ([float(word) for word in words.split(",")] for words in (text, wanted))
    except ValueError:
        return False
    return len(a) == len(b) and np.allclose(a, b, rtol=1e-6, atol=1e-9)


def reference_runout(run):
    """Stored curves for the problem of this run: {kind of contact normal: {column: array}}, with columns time [s],
    toe and toe999 [m], speed of the centre of mass [m/s], shear of the base [N]; empty if there are none. A file says by
    its line "holds for:" which options the run must have."""
    for path in sorted(CASES.glob("landslide*/reference.csv")):
        lines = path.read_text().splitlines()
        wanted = next(line for line in lines if line.startswith("# holds for:")).split()[3:]
        if all(same_values(run.text(name), value) for name, value in (pair.split("=") for pair in wanted)):
            header, *rows = csv.reader(line for line in lines if not line.startswith("#"))
            columns = dict(zip(header, np.array(rows, dtype=float).T))
            return {normal: {"time": columns["time"], **{name.removesuffix(f"_{normal}"): values
                             for name, values in columns.items() if name.endswith(f"_{normal}")}} for normal in NORMALS}
    return {}
