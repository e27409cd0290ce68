"""Loads and motions in time

Tables give gravity, the velocity of one rigid body, the displacement of another, and the force on a third. Nothing touches
anything, and no corner of a table falls on a step. At every row, velocities and displacements must be the integrals of the
tables, for linear and for smooth tables: a step takes the mean of a table over the step, so that impulse and travel are exact.
The velocity of the soil is that in the middle of the last step.
The velocity through (0, 0), (1, 1), (2, -1), (3, 0) has the travel 0.5, 0.75, 0.5 and 0 m at 1, 1.5, 2 and 3 s. The position of
the body that forces move has an error of the order of the step squared, because a step takes its force as constant.
"""

import numpy as np

from mpm_regression.row import Row

RUNS = {"linear": "", "smooth": " ".join(f"-{name}_table_interpolation smooth" for name in (
    "gravity", "driven_velocity", "placed_displacement", "pushed_force"))}


class Table:
    """A table as the program has it: its values, and their integral since 0 s, at any times."""

    def __init__(self, run, option):
        points = [[float(x) for x in point.split(":")] for point in run.text(option).split(",")]
        self.times, self.values = np.array(points)[:, 0], np.array(points)[:, 1:]
        self.smooth = run.text(f"{option}_interpolation") == "smooth"

    def parts(self, t):
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        length = np.diff(self.times)[k]
        return k, length, np.clip((t - self.times[k]) / length, 0, 1)

    def value(self, t):
        k, _, x = self.parts(t)
        way = x**2 * (3 - 2 * x) if self.smooth else x
        return self.values[k] + np.diff(self.values, axis=0)[k] * way[:, None]

    def integral(self, t):
        k, length, x = self.parts(t)
        whole = np.concatenate([np.zeros((1, 2)), np.cumsum(np.diff(self.times)[:, None] * (self.values[1:] + self.values[:-1]) / 2,
                                                            axis=0)])
        way = x**3 - x**4 / 2 if self.smooth else x**2 / 2
        return whole[k] + length[:, None] * (self.values[k] * x[:, None] + np.diff(self.values, axis=0)[k] * way[:, None])


def gap(answer, exact):
    return np.abs(answer - exact).max() / np.abs(exact).max()


def check(runs):
    for name, run in runs.items():
        t = run.history["time"]
        middle = t - np.where(t > 0, run.history["dt"] / 2, 0)
        gravity, velocity, placed, force = (Table(run, option) for option in (
            "gravity_table", "driven_velocity_table", "placed_displacement_table", "pushed_force_table"))
        mass = run.history["block_mass"][:, None]
        yield Row(f"velocity of the block: largest error over the largest velocity, {name}",
                  gap(run.columns("block_momentum_") / mass, gravity.integral(middle)), 0, 1e-12, "integral of the table", single=2e-5)
        yield Row(f"driven body: largest error of the displacement over the largest, {name}",
                  gap(run.columns("driven_"), velocity.integral(t)), 0, 1e-12, "integral of the table")
        yield Row(f"driven body: largest error of the velocity over the largest, {name}",
                  gap(run.columns("driven_velocity_"), velocity.value(t)), 0, 1e-12, "the table")
        if name == "linear":
            for at, travel in ((1, 0.5), (1.5, 0.75), (2, 0.5)):
                row = np.searchsorted(t, at)  # the first row at or after this time
                rest = velocity.integral(t[[row]])[0, 1] - travel
                yield Row(f"driven body: travel along y at {at} s, m", run.history["driven_y"][row] - rest, travel, 1e-12, "closed form")
        yield Row(f"driven body: travel along y at the end, m, {name}", run.history["driven_y"][-1], 0, 1e-12, "closed form")
        yield Row(f"placed body: largest error of the displacement over the largest, {name}",
                  gap(run.columns("placed_"), placed.value(t)), 0, 1e-12, "the table")
        of_mass = run.number("pushed_density") * 1.0  # a square of 1 m
        yield Row(f"pushed body: largest error of the velocity over the largest, {name}",
                  gap(run.columns("pushed_velocity_"), force.integral(t) / of_mass + gravity.integral(t)), 0, 1e-12,
                  "integral of the tables")


def draw(axes, runs):
    for name, run in runs.items():
        axes.plot(run.history["time"], run.history["driven_velocity_y"], label=f"{name}: velocity (m/s)")
        axes.plot(run.history["time"], run.history["driven_y"], "--", label=f"{name}: displacement (m)")
    axes.set(xlabel="time (s)", ylabel="driven body, along y")
    axes.legend()
