"""Films on a slope

A film of the thickness $H$ flows down a slope under its weight, with the shear stress $\\tau = \\rho g \\sin\\theta (H -
y)$. A Newtonian film has the velocity $\\rho g \\sin\\theta H^2 / 2\\eta$ at the surface. A Bingham film has a plug of the
thickness $h_p = \\tau_y / \\rho g \\sin\\theta$ with the velocity $\\rho g \\sin\\theta (H - h_p)^2 / 2k$. The films start
with 95 % of this velocity and run for two relaxation times, after which 0.7 % are missing. A layer of 20 mm, thinner than
$h_p$ = 26 mm, must rest in its middle third, and one of 40 mm must flow.

| film | $H$ (m) | slope | $\\rho$ (kg/m3) | $\\tau_y$ (Pa) | $k$ or $\\eta$ |
| --- | --- | --- | --- | --- | --- |
| Newtonian | 0.05 | 10° | 1000 | 0 | 5 Pa s |
| Bingham | 0.5 | 15° | 1500 | 100 | 200 Pa s |

The mesh has no periodic sides: the film has open ends, and the check measures the part that no wave from an end has reached.
The velocity is that of the nodes. Six or eight cells over the height of a film; `film_fine` has more, and other laws.
"""

import numpy as np

from mpm_regression.checks import film
from mpm_regression.checks.film import FluidFilm, GrainFilm
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from mpm_regression.size import Size

FILMS = {"newtonian": FluidFilm(10, 0.05, 1000, 0, 5, 1, 8), "Bingham": FluidFilm(15, 0.5, 1500, 100, 200, 1, 6)}
FINE_FILMS = {"newtonian": FluidFilm(10, 0.05, 1000, 0, 5, 1, 16), "Bingham": FluidFilm(15, 0.5, 1500, 100, 200, 1, 16),
              "Herschel-Bulkley": FluidFilm(15, 0.5, 1500, 100, 800, 0.5, 16), "grains": GrainFilm(24, 0.02, 8)}
LAYERS = {"thin": FluidFilm(15, 0.02, 1500, 100, 200, 1, 5), "thick": FluidFilm(15, 0.04, 1500, 100, 200, 1, 5)}
LENGTH = 0.32  # m, of the layers
RUNS = {law: each.options() for law, each in FILMS.items()} | {name: each.from_rest(LENGTH, 1) for name, each in LAYERS.items()}


def prepare(run, path, options):
    if run in FILMS:
        FILMS[run].write(path)
    else:
        LAYERS[run].write(path, LENGTH, 0.0)


def middle_speed(run):
    """Largest speed of the nodes in the middle third of a layer, m/s."""
    frame = last_frame(run, "layer")
    inside = np.abs(frame["position"][:, 0] - LENGTH / 2) < LENGTH / 6
    return np.linalg.norm(frame["grid_velocity"][inside], axis=1).max()


def check(runs):
    for (law, each), tolerance in zip(FILMS.items(), (0.02, 0.03)):
        yield from film.flow_rows(law, runs[law], each, tolerance)
    yield Row("speed of a layer thinner than the plug (m/s)", middle_speed(runs["thin"]), 0, 1e-6, "it rests")
    yield Row("speed of a layer thicker than the plug (m/s)", middle_speed(runs["thick"]), 2e-4, 0, "a control: it flows", at_least=True)


def draw(axes, runs):
    film.draw(axes, runs, FILMS)


class Fine(Size):
    """Films on a slope, finer, and grains

    The films of the case `film`, with 16 cells over the height, and two more laws. Herschel-Bulkley: as the Bingham film, with
    $k$ = 800 Pa s$^{1/2}$ and $n$ = 1/2, and the velocity $\\frac{n}{n+1} (\\rho g \\sin\\theta / k)^{1/n} (H - h_p)^{1 + 1/n}$
    at the surface. Grains (`mu_i`, glass beads of 0.5 mm at a volume fraction of 0.6, 20 mm on 24°) have the same inertial
    number $I = I_0 (\\tan\\theta - \\mu_s) / (\\mu_2 - \\tan\\theta)$ everywhere, and the velocity $\\tfrac23 (I/d_g)
    \\sqrt{0.6\\, g \\cos\\theta}\\, H^{3/2}$ at the surface. They lie between periodic sides, because they take long to come to their
    steady flow, with eight cells over the height, and move by APIC: sheared by more than a hundred, grains by FLIP begin to bounce ([the law](soils.md#mu_i)).
    """

    RUNS = {law: each.options() for law, each in FINE_FILMS.items()}
    BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
    LONG = True

    def prepare(run, path, options):
        FINE_FILMS[run].write(path)

    def check(runs):
        for (law, each), tolerance in zip(FINE_FILMS.items(), (0.02, 0.03, 0.03, 0.02)):
            yield from film.flow_rows(law, runs[law], each, tolerance)

    def draw(axes, runs):
        film.draw(axes, runs, FINE_FILMS)
