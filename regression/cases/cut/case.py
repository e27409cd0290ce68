"""Vertical cut

A vertical cut of height $H$ in clay of strength $s_u$ stands up to $\\gamma H / s_u = 3.78$ (limit analysis: between the
bounds 3.772 and 3.786). The gravity is raised from run to run. Below the limit the bank comes to rest within 0.3 s.
Above the limit the bank slides on, and faster with increasing excess over the limit. The answer is the number at which the mean speed
of the bank from 0.3 s to 0.6 s is zero, on the straight line of least squares through the runs that slide. Later the bank has
sunk so far that it stands again, at a lower height. Local damping removes a fraction of the unbalanced force; it changes
neither balanced forces nor the sign of the unbalanced force. Walls are 2 H from the face, the ground below is 1 H deep; the
mechanism is a wedge of about 45° through the toe.
"""

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row
from mpm_regression.size import Size

STANDS, SLIDE = 3.5, (4.0, 4.2, 4.4)
RUNS = {f"n_{n}": f"-gravity 0,{-n / 0.4:.6g}" for n in (STANDS, *SLIDE)}
COARSE = "Forty cells over the height; the case `cut_fine` has eighty."
LONG = True


def speed(run):
    """Mean speed at which the bank sinks from 0.3 s on, m/s."""
    return -slope(run.history["time"], run.history["bank_centre_y"], 0.3)


def line(runs):
    """Slope of the speed over gamma H / su, m/s, and gamma H / su at which it is zero."""
    rise, value = np.polyfit(SLIDE, [speed(runs[f"n_{n}"]) for n in SLIDE], 1)
    return rise, -value / rise


def check(runs):
    yield Row("gamma H/su at failure", line(runs)[1], 3.78, 0.03, "limit analysis", relative=True, shortfall=COARSE, bound=0.045)
    yield Row(f"speed of the bank at gamma H/su = {STANDS} (m/s)", speed(runs[f"n_{STANDS}"]), 0, 1e-3, "below the limit it stands")
    yield Row("speed of the bank at gamma H/su = 4.4 (m/s)", speed(runs["n_4.4"]), 1e-2, 0, "above the limit it slides",
              at_least=True)


def draw(axes, runs):
    rise, limit = line(runs)
    axes.plot((STANDS, *SLIDE), [speed(runs[f"n_{n}"]) for n in (STANDS, *SLIDE)], "o", label="mean speed of the bank")
    axes.plot([limit, SLIDE[-1]], [0, rise * (SLIDE[-1] - limit)], lw=0.8, label="line through the runs that slide")
    axes.axvline(3.78, color="k", ls="--", lw=0.8, label="exact limit")
    axes.set(xlabel="$\\gamma H / s_u$", ylabel="speed (m/s)")
    axes.legend()


class Fine(Size):
    """Vertical cut, finer

    The case `cut` with 80 cells over the height instead of 40: eight times the work, so the case runs on a GPU or on all cores, in
    double precision.
    """

    RUNS = {name: f"{options} -mesh_spacing 0.0125" for name, options in RUNS.items()}
    BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)

    def check(runs):
        yield Row("gamma H/su at failure, d = H/80", line(runs)[1], 3.78, 0.03, "limit analysis", relative=True)
