"""Vibrating elastic bar

A bar of 25 m, fixed at one end, starts with the velocity of its first mode, $v_0 \\sin(\\pi x / 2L)$ with
$v_0 = 0.1$ m/s. The bar is stress-free at the start, $\\nu = 0$, and rollers hold its sides, so the bar stretches along its axis only.
Its centre of mass must move as $v = (2 v_0/\\pi) \\cos \\omega t$ with $\\omega = \\pi c / 2L$, $c = \\sqrt{E/\\rho}$, period
10 s, and keep its energy. Halving the cells must quarter the error of the period. The strain reaches 0.8 %; its effect on
the period of the linear theory (about $10^{-5}$) is neglected. The Courant number is 0.1, so that the mesh causes the error.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row

LENGTH, SPEED, PERIOD, PERIODS = 25.0, 0.05, 10.0, 10
ORIGIN = (3.7, -1.3, 0.9)
CELLS = {"10 cells": (10, 2), "20 cells": (20, 2), "40 cells": (40, 2), "20 cells in 3D": (20, 3)}
SOURCE = "linear wave equation"


def options(cells, dim):
    """The mesh of a bar of `cells` cells and one row, with two cells of room ahead of it."""
    h = LENGTH / cells
    lower, upper = ORIGIN[:dim], [ORIGIN[0] + LENGTH + 2 * h, *(x + h for x in ORIGIN[1:dim])]
    text = {name: ",".join(map(repr, corner)) for name, corner in (("lower", lower), ("upper", upper))}
    return (f"-dim {dim} -mesh_spacing {h!r} -mesh_lower {text['lower']} -mesh_upper {text['upper']}"
            " -bar_file {start}")


RUNS = {name.replace(" ", "_"): options(*size) for name, size in CELLS.items()}


def prepare(run, path, options):
    cells, dim = CELLS[run.replace("_", " ")]
    h = LENGTH / cells
    position = particles.lattice(ORIGIN[:dim], (ORIGIN[0] + LENGTH, *(x + h for x in ORIGIN[1:dim])), h / 2)
    velocity = np.zeros_like(position)
    velocity[:, 0] = SPEED * np.sin(np.pi * (position[:, 0] - ORIGIN[0]) / (2 * LENGTH))
    particles.write(path, "bar", position, h / 2, velocity=velocity)


def period(run):
    """Mean period, s: twice the mean distance of the zeros of the momentum, by linear interpolation."""
    t, p = run.history["time"], run.history["bar_momentum_x"]
    k = np.flatnonzero(p[1:] * p[:-1] < 0)
    zeros = t[k] - p[k] * (t[k + 1] - t[k]) / (p[k + 1] - p[k])
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def energy_kept(run):
    """Kinetic energy at its last maximum over that at the start."""
    energy = run.history["bar_kinetic_energy"]
    return energy[run.history["time"] > (PERIODS - 0.75) * PERIOD].max() / energy[0]


def amplitude(run):
    """Largest velocity of the centre of mass over v0 in the first half period."""
    mass = run.number("elastic_density") * LENGTH * run.number("mesh_spacing") ** (run.number("dim") - 1)
    return -run.history["bar_momentum_x"][run.history["time"] < PERIOD].min() / mass / SPEED


def check(runs):
    for name in CELLS:
        run = runs[name.replace(" ", "_")]
        if "10" not in name:
            yield Row(f"period, {name} (s)", period(run), PERIOD, 0.005, SOURCE, relative=True)
            yield Row(f"energy kept over {PERIODS} periods, {name}", energy_kept(run), 1, 0.01, "energy is conserved")
            yield Row(f"peak speed of the centre of mass over v0, {name}", amplitude(run), 2 / np.pi, 0.005, SOURCE, relative=True)
    errors = [abs(period(runs[name]) / PERIOD - 1) for name in ("10_cells", "20_cells", "40_cells")]
    for k, pair in enumerate(("10 to 20", "20 to 40")):
        yield Row(f"order of the period, {pair} cells", np.log2(errors[k] / errors[k + 1]), 2, 0.2, "second order",
                  at_least=True)


def draw(axes, runs):
    for name in ("10_cells", "40_cells"):
        run = runs[name]
        mass = LENGTH * run.number("mesh_spacing")
        axes.plot(run.history["time"], run.history["bar_momentum_x"] / mass, lw=1.2, label=name.replace("_", " "))
    t = np.linspace(0, PERIOD * PERIODS, 1000)
    axes.plot(t, 2 * SPEED / np.pi * np.cos(2 * np.pi * t / PERIOD), "k--", lw=0.8, label="exact")
    axes.set(xlabel="time (s)", ylabel="speed of the centre of mass (m/s)", xlim=(70, 100))
    axes.legend()
