"""Strip footing on soil with cohesion and friction: Nc

Weightless soil with $c$, $\\phi$ and $\\psi = \\phi$ carries $q = N_c c$, $N_c = (N_q - 1) \\cot\\phi$, whether the
base is smooth or rough (Prandtl 1921). The footing sinks by 0.0016 $B$; the mean load over the second half is compared.
The footing's edge lies midway between two nodes. The ground ends beyond the mechanism, 3 to 10 $B$ beside the footing.

One particle a cell, so that the soil does not lock: a dilatant flow fixes the ratio of volume change and shear, and
four particles a cell impose more constraints than the nodes have degrees of freedom. `-f_bar_fraction` has then no effect.
Two rows have four particles without F-bar. With four particles and `-f_bar_fraction` 0.98 the run ends: see
[soils.md](soils.md#mohr_coulomb).
"""

from mpm_regression.checks import footing_limits as footing
from mpm_regression.row import Row
from mpm_regression.size import Size

CELLS, COARSE, COARSEST = 41, 21, 11  # under the footing
ANGLES = (20, 25, 30, 35, 40)
RUNS = {f"{base}_{phi}": footing.cohesion_options(phi, CELLS) + more for phi in ANGLES for base, more in footing.BASES.items()}
RUNS |= {f"{base}_coarse": footing.cohesion_options(30, COARSE) + more for base, more in footing.BASES.items()}
RUNS |= {f"{base}_four": footing.cohesion_options(30, COARSE) + more + " -soil_particles_per_cell 2"
         for base, more in footing.BASES.items()}
LOCKS = "Four particles a cell lock in dilatant flow."
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def factor(run):
    return footing.limit(run) / 1000


def check(runs):
    source = "Prandtl (1921)"
    for base in footing.BASES:
        for phi in ANGLES:
            yield Row(f"Nc, {base}, phi = {phi}, d = B/{CELLS}", factor(runs[f"{base}_{phi}"]), footing.cohesion_factor(phi),
                      footing.tolerance(phi), source, relative=True)
        exact, fine, coarse = footing.cohesion_factor(30), factor(runs[f"{base}_30"]), factor(runs[f"{base}_coarse"])
        yield Row(f"Nc, {base}, phi = 30, extrapolated from B/{COARSE} and B/{CELLS}",
                  fine + (fine - coarse) * COARSE / (CELLS - COARSE), exact, 0.02, source, relative=True)
        yield Row(f"Nc, {base}, phi = 30, d = B/{COARSE}, four particles a cell", factor(runs[f"{base}_four"]), exact, 0.04, source,
                  relative=True, shortfall=LOCKS, bound=0.1)
    rise = max((footing.drift(run) for name, run in runs.items() if not name.endswith("_four")), key=abs)
    yield Row("largest change of a load from the third to the last quarter", rise, 0, 0.03, "a limit load stays")


def draw(axes, runs):
    curves = {}
    for base, colour in footing.COLOURS.items():
        for phi, style in ((20, ":"), (30, "--"), (35, "-")):
            w, q = footing.curve(runs[f"{base}_{phi}"])
            curves[f"{base}, $\\phi$ = {phi}"] = w, q / 1000, colour, style
    footing.draw_curves(axes, curves, [footing.cohesion_factor(phi) for phi in (20, 30, 35)], "$N_c$")


class Coarse(Size):
    """Strip footing on soil with cohesion and friction, coarse

    $N_c$ for $\\phi$ = 30° as in `footing_cohesion`, with 11 cells under the footing instead of 41.
    """

    RUNS = {base: footing.cohesion_options(30, COARSEST) + more for base, more in footing.BASES.items()}
    LONG = False

    def check(runs):
        for base, run in runs.items():
            yield Row(f"Nc, {base}, phi = 30, d = B/{COARSEST}", factor(run), footing.cohesion_factor(30), footing.tolerance(30),
                      "Prandtl (1921)", relative=True, shortfall=footing.COARSE, bound=0.12)
