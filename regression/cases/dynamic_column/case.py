"""A load at once on a saturated column

A column of 10 m, 1 kPa at once on its drained top (de Boer, Ehlers and Liu 1993): with water that cannot be compressed, a half space
settles by $u_0 = q t e^{-x}(I_0 + I_1)(x)/\\sqrt{M\\rho^\\ast}$, $x = \\gamma_w t/(2 k \\rho^\\ast)$. Water of 2.2 GPa and a column
of 10 m settle by 0.5 % more (Laplace transform). The settlement is the mean over a period of the fast wave, $4H/c$.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, time_of

LOAD, MODULUS, CELL, PERIOD = 1e3, 12e6, 0.1, 0.024  # Pa, Pa, m, s
EXACT = {0.1: 1.04813e-4, 0.5: 2.33311e-4}  # s: m
RUNS = {"column": ""}
PRECISIONS = ("double",)
LONG = True


def check(runs):
    run = runs["column"]
    start = read_frame(run.frames[0])[1]["column"]["position"][:, 1].max()
    times = np.array([time_of(path) for path in run.frames])
    for time, exact in EXACT.items():
        # The mean over an even share of both sides of the time: a period of the fast wave, where the run is long enough.
        half = min(PERIOD / 2, times[-1] - time)
        chosen = [path for path, at in zip(run.frames, times) if abs(at - time) <= half]
        found = np.mean([start - read_frame(path)[1]["column"]["position"][:, 1].max() for path in chosen])
        yield Row(f"settlement over the exact one, {time:g} s", (found + LOAD / MODULUS * CELL / 4) / exact, 1, 0.01,
                  "Laplace transform", relative=True)
