"""Circular footing on clay of one strength

A circular footing on weightless Tresca clay fails at $q = 5.69 s_u$ where its base is smooth (Shield 1955) and at $6.05 s_u$ where it is
rough (Eason & Shield 1960). The section of the body of revolution (`-geometry axisymmetric`) is 1.5 $D$ wide and deep. The stiffness is 5000
$s_u$, so that the clay has failed at a settlement of 0.004 $D$; the mean up to 0.012 $D$ is compared. There the footing has sunk by less than half a
cell, so that the row of nodes at its base is the same. The case `circle_fine` has cells half as large.
"""

from mpm_regression.checks.circle import ROUGH, check_factors, draw_factors

LONG = True
RUNS = {"smooth": "", "rough": ROUGH}


def check(runs):
    yield from check_factors(runs, cells=20, allowed=0.06)


def draw(axes, runs):
    draw_factors(axes, runs)
