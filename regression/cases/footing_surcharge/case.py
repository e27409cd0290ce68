"""Strip footing on sand under a surcharge: Nq

Weightless sand without cohesion, with $\\psi = \\phi$, under the surcharge $p$ carries $q = N_q p$,
$N_q = e^{\\pi \\tan\\phi} \\tan^2(45° + \\phi/2)$, whether the base is smooth or rough (Prandtl 1921, Reissner 1924). The surcharge is
the pressure of a soft elastic cover between the ground and the top of the mesh, a roller. Sand and cover start at this
pressure, in equilibrium. The cover's modulus is twice the pressure; the heave, below 0.005 $B$, changes the pressure in
its 1 $B$ of thickness by 1 % at most. Set-up and reading are those of `footing_cohesion`.
"""

import numpy as np

from mpm_regression.checks import footing_limits as footing
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from mpm_regression.size import Size

CELLS, COARSE, COARSEST = 41, 21, 11
ANGLES = (20, 25, 30, 35, 40)
PRESSURE = 1000.0  # Pa
RUNS = {f"{base}_{phi}": footing.surcharge_options(phi, CELLS) + more for phi in ANGLES for base, more in footing.BASES.items()}
RUNS |= {f"{base}_coarse": footing.surcharge_options(30, COARSE) + more for base, more in footing.BASES.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def factor(run):
    return footing.limit(run) / PRESSURE


def pressure(run):
    """Mean vertical pressure in the lowest rows of the cover at the end, over the pressure at the start."""
    cover = last_frame(run, "cover")
    low = cover["position"][:, 1] < np.min(cover["position"][:, 1]) + 2 * run.number("mesh_spacing")
    return -cover["stress"][low, 1].mean() / PRESSURE


def check(runs):
    source = "Prandtl (1921), Reissner (1924)"
    for base in footing.BASES:
        for phi in ANGLES:
            yield Row(f"Nq, {base}, phi = {phi}, d = B/{CELLS}", factor(runs[f"{base}_{phi}"]), footing.surcharge_factor(phi),
                      footing.tolerance(phi), source, relative=True)
        fine, coarse = factor(runs[f"{base}_30"]), factor(runs[f"{base}_coarse"])
        yield Row(f"Nq, {base}, phi = 30, extrapolated from B/{COARSE} and B/{CELLS}",
                  fine + (fine - coarse) * COARSE / (CELLS - COARSE), footing.surcharge_factor(30), 0.02, source, relative=True)
    worst = max((pressure(run) for run in runs.values()), key=lambda share: abs(share - 1))
    yield Row("surcharge at the end over that at the start, worst run", worst, 1, 0.02, "set-up")


def draw(axes, runs):
    curves = {}
    for base, colour in footing.COLOURS.items():
        for phi, style in ((20, ":"), (30, "--"), (35, "-")):
            w, q = footing.curve(runs[f"{base}_{phi}"])
            curves[f"{base}, $\\phi$ = {phi}"] = w, q / PRESSURE, colour, style
    footing.draw_curves(axes, curves, [footing.surcharge_factor(phi) for phi in (20, 30, 35)], "$N_q$")


class Coarse(Size):
    """Strip footing on sand under a surcharge, coarse

    $N_q$ for $\\phi$ = 30° as in `footing_surcharge`, with 11 cells under the footing instead of 41.
    """

    RUNS = {base: footing.surcharge_options(30, COARSEST) + more for base, more in footing.BASES.items()}
    LONG = False

    def check(runs):
        for base, run in runs.items():
            yield Row(f"Nq, {base}, phi = 30, d = B/{COARSEST}", factor(run), footing.surcharge_factor(30),
                      footing.tolerance(30), "Prandtl (1921), Reissner (1924)", relative=True, shortfall=footing.COARSE, bound=0.1)
            yield Row(f"surcharge at the end over that at the start, {base}", pressure(run), 1, 0.02, "set-up")
