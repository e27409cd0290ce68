"""Mandel's problem

A saturated block between two rigid smooth plates, under the load $2F$ with $F$ = 10 kN/m and drained at its flanks, $a$ = 1 m from the
middle (Mandel 1953; Abousleiman et al. 1996). As the flanks drain and soften, the middle takes more of the load: its pressure first
rises above the pressure $p_0$ that it had undrained, by 9 %, which a code that does not couple water and soil never shows. The block begins with the
stress and pressure of the undrained load, so the first waves are those of the water that leaves; local damping takes them.
Pressures are means over 20 ms, between the middles of cells. The time is $T = c_v t / a^2$.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, time_of

P0, CELL, HEIGHT, START, RATE = 4921.26, 0.025, 0.05, 6.2992e-4, 0.119457 * 3  # Pa, m, m, vertical strain, cv [m2/s] as scaled
# T: pressure over p0 in the middle and at a/2, vertical strain: series.
EXACT = {0.05: (1.08525, 0.96938, 6.8565e-4), 0.1: (1.07533, 0.84361, 7.1101e-4), 0.2: (0.93995, 0.68511, 7.4930e-4)}
RUNS = {"block": ""}
PRECISIONS = ("double",)
LONG = True


def pressures(run, time, start):
    """Mean pressure over p0 in the middle and at a/2."""
    found = []
    for path in run.frames:
        if abs(time_of(path) - time) > 0.0101:
            continue
        soil, cell = read_frame(path)[1]["soil"], np.floor(start / CELL)
        columns = [(soil["position"][cell == c, 0].mean(), soil["pore_pressure"][cell == c].mean()) for c in np.unique(cell)]
        x, p = zip(*columns)
        found.append((p[0] / P0, np.interp(0.5, x, p) / P0))
    return np.mean(found, axis=0)


def check(runs):
    run = runs["block"]
    history, start = run.history, read_frame(run.frames[0])[1]["soil"]["position"][:, 0]
    for t, (middle, half, strain) in EXACT.items():
        found = pressures(run, t / RATE, start)
        yield Row(f"pressure over p0 in the middle, T = {t:g}", found[0], middle, 0.02, "Mandel's series")
        yield Row(f"pressure over p0 at a/2, T = {t:g}", found[1], half, 0.02, "Mandel's series")
        near = np.abs(history["time"] - t / RATE) < 0.0101
        yield Row(f"vertical strain over the exact one, T = {t:g}", (START - history["plate_y"][near].mean() / HEIGHT) / strain, 1, 0.015,
                  "Mandel's series")
    overshoot = pressures(run, 0.068 / RATE, start)[0] - 1
    yield Row("pressure over p0 in the middle above 1, T = 0.068", overshoot, 0.06, 0, "series: 0.0905", at_least=True)
