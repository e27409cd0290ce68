"""Vertical cut in soil with cohesion and friction

A vertical cut in soil with $c$, $\\phi$ and $\\psi = \\phi$ stands up to $N = \\gamma H / c$. The log spiral through
the toe gives an upper bound (Chen 1975), 3.8314 for $\\phi$ = 0, where the exact number is 1.4 % less; it is therefore
taken as 0 to 1.5 % below the bound. The answer is found as in the case `cut`: the number at which the bank's mean speed
from 0.3 s to 0.6 s is zero, on the line through the runs that slide. The soil takes tension up to the apex. A cell has
one particle, because four lock in dilatant flow (`footing_cohesion`).
"""

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row
from mpm_regression.size import Size

BOUND = {5: 4.190, 10: 4.583, 20: 5.505, 30: 6.687}
STANDS, SLIDE = 0.93, (1.06, 1.12, 1.18)  # times the bound
BENT = {"shortfall": "The line through the runs that slide is bent here: it meets zero below 0.93, where the bank stands.", "bound": 0.1}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def runs_of(angles, more=""):
    return {f"{phi}_{share}": f"-loam_friction_deg {phi} -loam_dilation_deg {phi} -gravity 0,{-share * BOUND[phi] / 0.4:.6g}" + more
            for phi in angles for share in (STANDS, *SLIDE)}


RUNS = runs_of(BOUND)


def speed(run):
    """Mean speed at which the bank sinks from 0.3 s on, m/s."""
    return -slope(run.history["time"], run.history["bank_centre_y"], 0.3)


def line(runs, phi):
    """Slope of the speed over the number's share of the bound, m/s, and the share at which the speed is zero."""
    rise, value = np.polyfit(SLIDE, [speed(runs[f"{phi}_{share}"]) for share in SLIDE], 1)
    return rise, -value / rise


def rows(runs, angles, cells, **shortfall):
    for phi in angles:
        yield Row(f"gamma H/c at failure over the bound, phi = {phi}, d = H/{cells}", line(runs, phi)[1], 0.99, 0.04,
                  "log spiral, Chen (1975)", **shortfall)
        yield Row(f"speed of the bank at {STANDS} of the bound, phi = {phi} (m/s)", speed(runs[f"{phi}_{STANDS}"]), 0, 1e-3,
                  "below the limit it stands")
        yield Row(f"speed of the bank at {SLIDE[-1]} of the bound, phi = {phi} (m/s)", speed(runs[f"{phi}_{SLIDE[-1]}"]), 1e-3, 0,
                  "above the limit it slides", at_least=True)


def check(runs):
    for phi in BOUND:
        yield from rows(runs, (phi,), 40, **(BENT if phi <= 10 else {}))


def draw(axes, runs):
    for phi, colour in zip(BOUND, ("#0072b2", "#009e73", "#e69f00", "#d55e00")):
        shares = [share for share in (STANDS, *SLIDE) if f"{phi}_{share}" in runs]
        axes.plot(shares, [speed(runs[f"{phi}_{share}"]) for share in shares], "o", color=colour, label=f"$\\phi$ = {phi}")
        rise, limit = line(runs, phi)
        axes.plot([limit, SLIDE[-1]], [0, rise * (SLIDE[-1] - limit)], color=colour, lw=0.8)
    axes.axvspan(0.985, 1, color="0.8", label="exact")
    axes.set(xlabel="$\\gamma H / c$ over the log-spiral bound", ylabel="mean speed of the bank (m/s)")
    axes.legend()


class Coarse(Size):
    """Vertical cut in soil with cohesion and friction, coarse

    The case `cut_friction` for $\\phi$ = 20° with 20 cells over the height instead of 40.
    """

    RUNS = runs_of((20,), " -mesh_spacing 0.05")
    LONG = False

    def check(runs):
        yield from rows(runs, (20,), 20)
