"""Strip footing on sand with weight: N gamma

Sand of unit weight $\\gamma$ without surcharge, $\\psi = \\phi$, carries $q = \\frac{1}{2} \\gamma B N_\\gamma$. The
exact values are those of slip lines, as in Martin (2005). The sand starts with the stress of its weight and
$K_0 = 1 - \\sin\\phi$. A cohesion of $10^{-4} \\gamma B$ keeps the surface together and adds 0.1 % to the load; the settlement of
0.0004 $B$ at most adds little. Set-up and reading are those of `footing_cohesion`, and the footing sinks half as fast.
"""

import numpy as np

from mpm_regression import ground
from mpm_regression.checks import footing_limits as footing
from mpm_regression.row import Row
from mpm_regression.size import Size

CELLS, COARSE = 41, 11
EXACT = {("smooth", 20): 1.579, ("smooth", 25): 3.461, ("smooth", 30): 7.653, ("smooth", 35): 17.577,
         ("rough", 20): 2.839, ("rough", 25): 6.491, ("rough", 30): 14.754, ("rough", 35): 34.476}
WEIGHT = 20e3  # N/m3
SOURCE = "slip lines, as Martin (2005)"
RUNS = {f"{base}_{phi}": footing.weight_options(phi, CELLS, WEIGHT * exact / 2) + footing.BASES[base]
        for (base, phi), exact in EXACT.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def write_ground(path, phi, cells):
    d, width, depth = footing.ground(phi, cells)
    ground.write_level(path, "soil", (0, 0), (width, depth), d, WEIGHT, 1 - np.sin(np.radians(phi)))


def prepare(run, path, options):
    write_ground(path, int(run.split("_")[1]), CELLS)


def factor(run):
    return footing.limit(run) / (WEIGHT / 2)


def check(runs):
    for (base, phi), exact in EXACT.items():
        yield Row(f"N gamma, {base}, phi = {phi}, d = B/{CELLS}", factor(runs[f"{base}_{phi}"]), exact, 0.08 if phi <= 30 else 0.15,
                  SOURCE, relative=True)


def draw(axes, runs):
    curves = {}
    for base, colour in footing.COLOURS.items():
        for phi, style in ((20, ":"), (25, "--"), (30, "-")):
            w, q = footing.curve(runs[f"{base}_{phi}"])
            curves[f"{base}, $\\phi$ = {phi}"] = w, q / (WEIGHT / 2), colour, style
    footing.draw_curves(axes, curves, [exact for (_, phi), exact in EXACT.items() if phi <= 30], "$N_\\gamma$")


class Coarse(Size):
    """Strip footing on sand with weight, coarse

    $N_\\gamma$ for $\\phi$ = 30° as in `footing_weight`, with 11 cells under the footing instead of 41.
    """

    RUNS = {base: footing.weight_options(30, COARSE, WEIGHT * EXACT[base, 30] / 2) + more for base, more in footing.BASES.items()}
    LONG = False

    def prepare(run, path, options):
        write_ground(path, 30, COARSE)

    def check(runs):
        for base, run in runs.items():
            yield Row(f"N gamma, {base}, phi = 30, d = B/{COARSE}", factor(run), EXACT[base, 30], 0.08, SOURCE, relative=True)
