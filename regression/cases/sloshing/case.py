"""Sloshing

Water of the depth $h$ = 0.5 m in a basin of the length $L$ = 1 m sloshes in its first mode, with the wave number $k =
\\pi/L$. The period of small waves is $T = 2\\pi / \\sqrt{g k \\tanh k h}$ = 1.182 s. The water starts with a level surface
and the velocity of the mode, $(\\sin k x \\cosh k y, -\\cos k x \\sinh k y)$ times an amplitude for which the surface rises
by 10 mm. The period is that between the zeros of the momentum.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row

DENSITY, G, DEPTH, LENGTH = 1000.0, 9.81, 0.5, 1.0
WAVE = np.pi / LENGTH
RATE = np.sqrt(G * WAVE * np.tanh(WAVE * DEPTH))  # 1/s, angular
RISE = 0.01  # m
RUNS = {"d_50mm": "-basin_file {start}", "d_25mm": "-basin_file {start} -mesh_spacing 0.025"}


def prepare(run, path, options):
    spacing = 0.025 if run == "d_50mm" else 0.0125
    place = particles.lattice((0, 0), (LENGTH, DEPTH), spacing)
    x, y = place.T
    stress = np.zeros((len(place), 6))
    stress[:, :3] = (-DENSITY * G * (DEPTH - y))[:, None]
    scale = RISE * RATE / np.sinh(WAVE * DEPTH)
    velocity = scale * np.column_stack([np.sin(WAVE * x) * np.cosh(WAVE * y), -np.cos(WAVE * x) * np.sinh(WAVE * y)])
    particles.write(path, "basin", place, spacing, stress=stress, velocity=velocity)


def period(run):
    """Twice the mean time between the zeros of the momentum along the basin, s."""
    t, p = run.history["time"], run.history["basin_momentum_x"]
    before = np.flatnonzero(p[:-1] * p[1:] < 0)
    zeros = t[before] - p[before] * (t[before + 1] - t[before]) / (p[before + 1] - p[before])
    return 2 * np.diff(zeros).mean()


def check(runs):
    for name in RUNS:
        yield Row(f"period, {name} (s)", period(runs[name]), 2 * np.pi / RATE, 0.02, "small waves of an ideal fluid", relative=True)


def draw(axes, runs):
    for name in RUNS:
        t, p = runs[name].history["time"], runs[name].history["basin_momentum_x"]
        axes.plot(t, p / p[0], lw=1, label=name)
    axes.plot(t, np.cos(RATE * t), "k--", lw=0.8, label="exact")
    axes.set(xlabel="time (s)", ylabel="momentum along the basin over that at the start")
    axes.legend()
