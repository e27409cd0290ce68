"""Films on a slope, finer, and grains

The films of the case `film`, with 16 cells over the height, and two more laws. Herschel-Bulkley: as the Bingham film, with
$k$ = 800 Pa s$^{1/2}$ and $n$ = 1/2, and the velocity $\\frac{n}{n+1} (\\rho g \\sin\\theta / k)^{1/n} (H - h_p)^{1 + 1/n}$
at the surface. Grains (`mu_i`, glass beads of 0.5 mm at a volume fraction of 0.6, 20 mm on 24°) have the same inertial
number $I = I_0 (\\tan\\theta - \\mu_s) / (\\mu_2 - \\tan\\theta)$ everywhere, and the velocity $\\tfrac23 (I/d_g)
\\sqrt{0.6\\, g \\cos\\theta}\\, H^{3/2}$ at the surface. They lie between periodic sides, because they take long to come to their
steady flow, with eight cells over the height, and move by APIC: sheared by more than a hundred, grains by FLIP begin to bounce ([the law](soils.md#mu_i)).
"""

from mpm_regression.checks import film
from mpm_regression.checks.film import FluidFilm, GrainFilm

DECK = "regression/cases/film/case.opts"
FILMS = {"newtonian": FluidFilm(10, 0.05, 1000, 0, 5, 1, 16), "Bingham": FluidFilm(15, 0.5, 1500, 100, 200, 1, 16),
         "Herschel-Bulkley": FluidFilm(15, 0.5, 1500, 100, 800, 0.5, 16), "grains": GrainFilm(24, 0.02, 8)}
TOLERANCES = (0.02, 0.03, 0.03, 0.02)
RUNS = {law: each.options() for law, each in FILMS.items()}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def prepare(run, path, options):
    FILMS[run].write(path)


def check(runs):
    for (law, each), tolerance in zip(FILMS.items(), TOLERANCES):
        yield from film.flow_rows(law, runs[law], each, tolerance)


def draw(axes, runs):
    film.draw(axes, runs, FILMS)
