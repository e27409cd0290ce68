"""Bearing capacity of circular footings on clay of one strength."""

import numpy as np

from mpm_regression.row import Row

EXACT = {"smooth": 5.689, "rough": 6.048}  # Shield (1955) 5.69, Eason & Shield (1960) 6.05; digits by slip lines
ROUGH = "-footing_shear_limit 3000"
LOWER, UPPER = 0.004, 0.012  # settlements over diameter between which the load is averaged


def curve(run):
    """Settlement over the diameter, and the load over the area and the strength."""
    radius, strength = 0.5, run.number("clay_su")
    return -run.history["footing_y"] / (2 * radius), run.history["footing_force_y"] / (np.pi * radius**2 * strength)


def factor(run):
    settlement, load = curve(run)
    return load[(settlement >= LOWER) & (settlement <= UPPER)].mean()


def check_factors(runs, cells, allowed):
    for base, exact in EXACT.items():
        source = "Shield (1955)" if base == "smooth" else "Eason & Shield (1960)"
        yield Row(f"q / su, {base}, d = D/{cells}", factor(runs[base]), exact, allowed, source, relative=True)


def draw_factors(axes, runs):
    for base, colour in (("smooth", "#0072b2"), ("rough", "#d55e00")):
        axes.plot(*curve(runs[base]), color=colour, lw=1, label=base)
        axes.axhline(EXACT[base], color=colour, lw=0.8, ls=":")
    axes.set(xlabel="settlement over the diameter", ylabel="load / (area x su)")
    axes.legend()
