"""Shared by the cases of the strip footing: its curve, and the distance of two curves."""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import bearing_curve, mean_over, reference_curve, window_means

EXACT = 2 + np.pi  # Nc of a strip footing at small strain (Prandtl)


def curve(run):
    """Middles of windows of 0.01 B and the mean Nc in them, over 0.03-0.20 B."""
    middle, nc = window_means(*bearing_curve(run, "plate"))
    inside = (middle > 0.03) & (middle < 0.20)
    return middle[inside], nc[inside]


def mean(run):
    return mean_over(*bearing_curve(run, "plate"))


def distance(run, other):
    """Largest relative difference of two curves in windows of 0.01 B."""
    return np.max(np.abs(curve(run)[1] / curve(other)[1] - 1))


def against_reference(run, spacing, allowed):
    """Rows that hold a run's curve against the stored one and the exact value."""
    middle, nc = reference_curve(spacing, fillet=False)
    expected = window_means(middle, nc, np.full_like(nc, middle[1] - middle[0]))[1][3:20]
    yield Row("mean Nc over 0.03-0.20 B", mean(run), expected.mean(), allowed, "independent sequential solver")
    yield Row("largest difference of Nc in windows of 0.01 B", np.max(np.abs(curve(run)[1] - expected)), 0, allowed,
              "independent sequential solver")


def draw_curve(axes, run, spacing):
    """Nc in windows of 0.01 B against the penetration, beside the stored curve and the exact value."""
    axes.plot(*curve(run), "o-", ms=3, label="mpm")
    axes.plot(*reference_curve(spacing, fillet=False), "k.-", lw=0.8, ms=3, label="independent solver")
    axes.axhline(EXACT, color="0.4", ls="--", label="exact at small strain")
    axes.set(xlabel="penetration $w/B$", ylabel="$N_c = F / (s_u B)$", ylim=(0, None))
    axes.legend()
