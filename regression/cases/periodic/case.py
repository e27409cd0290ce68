"""Periodic sides

A block that carries a random stress flies along x at 5 m/s, twice through the sides, while it vibrates freely. A second run
starts with the block shifted by 11 of the 32 cells, so that the sides cut it from the start: its particles must move as in
the first run, to round-off. Its momentum must stay what it was.

A wave of velocity $v_0 \\sin k(x - ct)$ and stress $-\\rho c v$ runs along a bar of the length $L = 2\\pi/k$ whose ends
are one place, five times round. The phase of its first mode gives its speed, which must be $c = \\sqrt{E/\\rho}$; halving the
cells must quarter the error. Two such waves, one each way, make a standing wave.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import first_frame, last_frame, mesh_options, order
from mpm_regression.row import Row

LOWER = (-1.3, 0.7)
CELLS, HEIGHT, EDGE, SHIFT = 32, 12, 0.25, 11  # of the mesh of the block
LENGTH, DENSITY, SPEED, PEAK = 8.0, 1000.0, np.sqrt(1000.0), 1e-3  # m, kg/m3, m/s, m/s
TURNS = 5
BARS = {"16 cells": (0.025, 0.04), "32 cells": (0.006, 0.006), "64 cells": (0.0015, 0.0015)}  # errors of speed and amplitude


def mesh(cells, height, edge):
    return mesh_options(2, edge, LOWER, (LOWER[0] + cells * edge, LOWER[1] + height * edge)) + " -soil_file {start}"


BLOCK = mesh(CELLS, HEIGHT, EDGE) + " -time_end 3.5 -time_courant 0.4 -output_interval 3.5 -history_interval 0.1"


def cells_of(name):
    return 32 if name == "standing" else int(name.replace("_", " ").split()[0])


def bar(cells):
    end = TURNS * LENGTH / SPEED
    return mesh(cells, 1, LENGTH / cells) + f" -time_courant 0.1 -time_end {end:.12g} -output_interval {end:.12g} -history_interval {end / 1000:.12g}"


RUNS = {"block": BLOCK, "shifted": BLOCK, "standing": bar(32)} | {name.replace(" ", "_"): bar(cells_of(name)) for name in BARS}


def prepare(run, path, options):
    if run in ("block", "shifted"):
        return write_block(path, SHIFT if run == "shifted" else 0)
    h = LENGTH / cells_of(run)
    position = particles.lattice(LOWER, (LOWER[0] + LENGTH, LOWER[1] + h), h / 2)
    wave = PEAK * np.sin(2 * np.pi * (position[:, 0] - LOWER[0]) / LENGTH)
    velocity, stress = np.zeros_like(position), np.zeros((len(position), 6))
    velocity[:, 0] = 2 * wave if run == "standing" else wave
    stress[:, 0] = 0 if run == "standing" else -DENSITY * SPEED * wave
    particles.write(path, "soil", position, h / 2, velocity=velocity, stress=stress)


def write_block(path, shift):
    """A block of 13 by 6 cells in cells 3 ... 15 of the mesh, shifted round it by so many cells."""
    dice = np.random.default_rng(5)
    cell = particles.lattice((3, 3), (16, 9), 0.5)
    cell[:, 0] = (cell[:, 0] + shift) % CELLS
    velocity = np.tile([5.0, 0.0], (len(cell), 1))
    stress = np.zeros((len(cell), 6))
    stress[:, [0, 1, 3]] = dice.uniform(-1e3, 1e3, (len(cell), 3))
    particles.write(path, "soil", np.array(LOWER) + EDGE * cell, EDGE / 2, velocity=velocity, stress=stress)


def ways(run):
    """How far the particles have come, m."""
    first, last = first_frame(run, "soil"), last_frame(run, "soil")
    way = last["position"] - first["position"]
    way[:, 0] += (last["periods_x"] - first["periods_x"]) * CELLS * EDGE
    return way


def mode(run):
    """First mode of the velocity at the end: the amplitude, m/s, and the part of a turn by which it lags behind whole turns."""
    frame = last_frame(run, "soil")
    k = 2 * np.pi / LENGTH
    wave = 2j * np.mean(frame["velocity"][:, 0] * np.exp(-1j * k * (frame["position"][:, 0] - LOWER[0])))
    return abs(wave), np.angle(wave) / (2 * np.pi)


def period(run):
    """Four times the mean distance of the largest and least kinetic energies, s, by parabolas."""
    t, energy = run.history["time"], run.history["soil_kinetic_energy"]
    k = 1 + np.flatnonzero((energy[1:-1] - energy[:-2]) * (energy[2:] - energy[1:-1]) < 0)
    k = k[(t[k] > 0.01 * t[-1]) & (t[k] < 0.99 * t[-1])]
    before, at, behind = energy[k - 1], energy[k], energy[k + 1]
    times = t[k] + (t[k + 1] - t[k]) * (before - behind) / (before - 2 * at + behind) / 2
    return 4 * (times[-1] - times[0]) / (len(times) - 1)


def check(runs):
    block, shifted = runs["block"], runs["shifted"]
    way = ways(block)
    yield Row("the block goes through the sides (times)", way[:, 0].mean() / (CELLS * EDGE), 3.5 * 5 / (CELLS * EDGE), 1e-6,
              "free flight", single=1e-4)
    yield Row("difference of the particles' ways, shifted (of the way)", abs(ways(shifted) - way).max() / abs(way).max(), 0, 1e-12,
              "translation", single=1e-3)
    a, b = (last_frame(run, "soil")["stress"] for run in (block, shifted))
    yield Row("difference of their stresses, shifted (of the largest)", abs(a - b).max() / abs(a).max(), 0, 1e-10, "translation",
              single=2e-2)
    momentum = block.history["soil_momentum_x"]
    yield Row("change of the momentum (of itself)", abs(momentum / momentum[0] - 1).max(), 0, 1e-12, "conservation", single=1e-4)
    centre = block.history["soil_centre_x"]
    yield Row("movement of the centre (m)", centre[-1] - centre[0], 17.5, 1e-6, "free flight: it does not jump at a side", single=2e-3)
    lags = []
    for name, (speed, loss) in BARS.items():
        amplitude, behind = mode(runs[name.replace(" ", "_")])
        lags.append(behind / TURNS)
        yield Row(f"speed of the wave over c, {name}", 1 - lags[-1], 1, speed, "linear wave equation")
        yield Row(f"its amplitude behind {TURNS} turns over that at the start, {name}", amplitude / PEAK, 1, loss, "linear wave equation")
    yield Row("order of the error of the speed", order([LENGTH / cells_of(name) for name in BARS], np.abs(lags)), 2, 0.2,
              "linear elements", at_least=True)
    yield Row("period of the standing wave over L / c, 32 cells", period(runs["standing"]) * SPEED / LENGTH, 1, 0.006,
              "linear wave equation")


def draw(axes, runs):
    for name in BARS:
        frame = last_frame(runs[name.replace(" ", "_")], "soil")
        axes.plot(frame["position"][:, 0] - LOWER[0], frame["velocity"][:, 0] / PEAK, ".", ms=3, label=name)
    x = np.linspace(0, LENGTH, 200)
    axes.plot(x, np.sin(2 * np.pi * x / LENGTH), "k--", lw=0.8)
    axes.set(xlabel="x (m)", ylabel=f"velocity over $v_0$ behind {TURNS} turns (dashed: exact)")
    axes.legend()
