"""A wave along a saturated column

The closed lower end of a column of 20 m is moved as a sine of 100 Hz, $k = 10^{-2}$ m/s: a fast wave with the speed and the
attenuation of Biot (1956), by the complex wave numbers of the u-w equations. The speed is that between 2 m and 7 m, by the phases
between 33 ms and 60 ms, before the free end reflects the wave.
"""

import numpy as np

from mpm_regression.row import Row

FREQUENCY, AWAY = 100.0, 5.0  # Hz, m
SPEED, ATTENUATION = 543.48, 0.0563  # m/s, 1/m
TIMES = np.arange(0, 0.0601, 0.0005)
TABLE = ",".join(f"{t:.4f}:0:{1e-4 * np.sin(2 * np.pi * FREQUENCY * t):.6e}" for t in TIMES)
RUNS = {"column": f"-mesh_ymin_velocity_table {TABLE}"}
PRECISIONS = ("double",)


def fit(history, name, late):
    """Amplitude and phase of the velocity of a particle."""
    angle = 2 * np.pi * FREQUENCY * history["time"][late]
    a, b, _ = np.linalg.lstsq(np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle)]), history[f"{name}_velocity_y"][late],
                              rcond=None)[0]
    return np.hypot(a, b), np.arctan2(a, b)


def check(runs):
    history = runs["column"].history
    late = history["time"] >= 0.033
    (near, first), (far, second) = (fit(history, name, late) for name in ("near", "far"))
    angle = 2 * np.pi * FREQUENCY * AWAY / SPEED  # less than a whole turn
    yield Row("speed of the fast wave over Biot's", angle / ((first - second) % (2 * np.pi)), 1, 0.01, "Biot 1956")
    yield Row("amplitude over that 5 m before, over Biot's", far / near / np.exp(-ATTENUATION * AWAY), 1, 0.03, "Biot 1956")
