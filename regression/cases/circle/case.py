"""Circular footing on clay of one strength

A circular footing on weightless Tresca clay fails at $q = 5.69 s_u$ where its base is smooth (Shield 1955) and at $6.05 s_u$ where it is
rough (Eason & Shield 1960). The section of the body of revolution (`-geometry axisymmetric`) is 1.5 $D$ wide and deep. The stiffness is 5000
$s_u$, so that the clay has failed at a settlement of 0.004 $D$; the mean up to 0.012 $D$ is compared. There the footing has sunk by less than half a
cell, so that the row of nodes at its base is the same. The case `circle_fine` has cells half as large.
"""

import numpy as np

from mpm_regression.row import Row
from mpm_regression.size import Size

EXACT = {"smooth": 5.689, "rough": 6.048}  # Shield (1955) 5.69, Eason & Shield (1960) 6.05; digits by slip lines
ROUGH = "-footing_shear_limit 3000"
LOWER, UPPER = 0.004, 0.012  # settlements over diameter between which the load is averaged
LONG = True
RUNS = {"smooth": "", "rough": ROUGH}


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


def check(runs):
    yield from check_factors(runs, cells=20, allowed=0.06)


def draw(axes, runs):
    for base, colour in (("smooth", "#0072b2"), ("rough", "#d55e00")):
        axes.plot(*curve(runs[base]), color=colour, lw=1, label=base)
        axes.axhline(EXACT[base], color=colour, lw=0.8, ls=":")
    axes.set(xlabel="settlement over the diameter", ylabel="load / (area x su)")
    axes.legend()


class Fine(Size):
    """Circular footing on clay of one strength, cells of D/40

    The same problem on cells half as large.
    """

    RUNS = {name: f"-mesh_spacing 0.025 {options}" for name, options in RUNS.items()}

    def check(runs):
        yield from check_factors(runs, cells=40, allowed=0.03)

    draw = draw
