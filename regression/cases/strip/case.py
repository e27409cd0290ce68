"""Strip footing on clay of one strength

A strip of width $B$ on weightless clay of strength $s_u$ fails at $q = (2 + \\pi) s_u$ whether its base is smooth or rough
(Prandtl 1921; von Mises clay in plane strain with $\\sqrt{J_2} = s_u$). The exact value is for small penetration, so the mean
over 0.02-0.05 $B$ is compared: the clay has yielded by 0.02 $B$, and the trench adds little before 0.05 $B$. The speed of
0.1 m/s is 1/2000 of that of a wave. Sides are 2.5 $B$ from the edge and the bottom is 4 $B$ down, beyond the mechanism of a
rough strip (1.5 $B$). The case `strip_fine` continues to $d = B/80$ and $d = 0$.
"""

from mpm_regression.checks.footing import EXACT
from mpm_regression.row import Row
from mpm_regression.size import Size
from soil_mpm.results import bearing_curve, mean_over, window_means

SPACINGS, FINER = (0.1, 0.05, 0.025), (0.025, 0.0125)
ROUGH = " -plate_shear_limit 3000"
FULL = "-mesh_lower -3,0 -soil_lower -3,0 -plate_lower -0.5,4"
COARSE = "Half the footing is only five cells wide; with F-bar it is too soft there."
LONG = True


def runs_of(spacings):
    return {f"{base}_{d}": f"-mesh_spacing {d}" + more for base, more in (("smooth", ""), ("rough", ROUGH)) for d in spacings}


RUNS = runs_of(SPACINGS) | {"smooth_full": FULL, "rough_full": FULL + ROUGH}


def factor(run):
    """Mean Nc over 0.02-0.05 B."""
    return mean_over(*bearing_curve(run, "plate"), lower=0.02, upper=0.05)


def check(runs):
    source = "Prandtl (1921)"
    for base in ("smooth", "rough"):
        n = {d: factor(runs[f"{base}_{d}"]) for d in SPACINGS}
        yield Row(f"Nc, {base}, d = B/10", n[0.1], EXACT, 0.2, source, relative=True,
                  shortfall=COARSE, bound=0.22)
        yield Row(f"Nc, {base}, d = B/20", n[0.05], EXACT, 0.1, source, relative=True)
        yield Row(f"Nc, {base}, d = B/40", n[0.025], EXACT, 0.05, source, relative=True)
        yield Row(f"Nc, {base}, whole over half model, d = B/20", factor(runs[f"{base}_full"]) / n[0.05], 1, 1e-3, "symmetry",
                  single=1e-2)


def draw(axes, runs):
    draw_curves(axes, runs, dict(zip(SPACINGS, (":", "--", "-"))))


def draw_curves(axes, runs, styles):
    """Nc over the penetration for each base and spacing; styles: {spacing: line style}."""
    for base, colour in (("smooth", "#0072b2"), ("rough", "#d55e00")):
        for d, style in styles.items():
            axes.plot(*window_means(*bearing_curve(runs[f"{base}_{d}"], "plate"), window=0.0025), style, color=colour,
                      label=f"{base}, d = B/{1 / d:.0f}")
    axes.axhline(EXACT, color="k", lw=0.8, label="exact")
    axes.set(xlabel="penetration $w/B$", ylabel="$N_c$", xlim=(0, 0.05), ylim=(0, 8))
    axes.legend(ncols=2, fontsize=8)


class Fine(Size):
    """Strip footing, finer

    The case `strip` with cells of $B$/80 and of $B$/40: eight times the work, so the case runs on a GPU or on all cores, in
    double precision. The straight line through the two answers, over $d$, gives the answer at $d = 0$. A part of the difference is no
    error: a footing that has sunk by 0.035 $B$, the mean of the window, stands in a trough.
    """

    RUNS = runs_of(FINER)
    BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)

    def check(runs):
        for base in ("smooth", "rough"):
            coarse, fine = (factor(runs[f"{base}_{d}"]) for d in FINER)
            yield Row(f"Nc, {base}, d = B/80", fine, EXACT, 0.03, "Prandtl (1921)", relative=True)
            yield Row(f"Nc, {base}, extrapolated from B/40 and B/80", 2 * fine - coarse, EXACT, 0.02, "Prandtl (1921)",
                      relative=True)

    def draw(axes, runs):
        draw_curves(axes, runs, dict(zip(FINER, ("--", "-"))))
