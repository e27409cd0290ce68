"""Flows between periodic sides

*Plates.* Fluid between plates at $y = \\pm h$, $h$ = 0.5 m, starts from rest under a body force $G$ of 100 N/m3 along the plates
and comes to the steady flow of `channel`: Newtonian $u = G (h^2 - y^2) / 2 \\eta$ (Poiseuille), and with a yield stress a plug
of half the width $\\tau_y / G$.

*Film.* A Newtonian film of 50 mm on a slope of 10° starts from rest with the pressure of its weight, and comes to
$u = \\rho g \\sin\\theta (2 H y - y^2) / 2 \\eta$ (Nusselt).

Both are 8 cells long. The velocity is that of the nodes, the means of the rows of particles.
"""

import numpy as np

from mpm_regression.checks.film import FluidFilm
from mpm_regression.curves import last_frame, mesh_options
from mpm_regression.row import Row

G, H, K, CELLS, ALONG = 100.0, 0.5, 10.0, 20, 8
EDGE = 2 * H / CELLS
YIELDS = "-fluid_model yield_stress_fluid -fluid_shear_modulus 2e4 -fluid_yield_stress 20 -fluid_consistency 10 -fluid_tension on"
LAWS = {"newtonian": (0.0, 1.0, 0.01), "Bingham": (20.0, 1.0, 0.03)}  # yield stress, n, tolerance
PLATES = (mesh_options(2, EDGE, (0, 0), (ALONG * EDGE, 2 * H)) + " -mesh_ymax fixed -gravity 10,0 -fluid_density 10"
          f" -fluid_bulk_modulus 2000 -layer_shape box -layer_lower 0,0 -layer_upper {ALONG * EDGE:g},{2 * H:g} -output_interval 1 ")
FILM = FluidFilm(10, 0.05, 1000, 0, 5, 1, 10)
FILM_END = 8 * FILM.relaxation()  # s, when 0.03 % of the velocity are missing


def film_options():
    return (f"{FILM.mesh(ALONG * FILM.spacing)} -mesh_ymax free {FILM.law()} -layer_shape particles"
            f" -time_end {FILM_END:.6g} -output_interval {FILM_END:.6g}")


RUNS = {"newtonian": PLATES + "-fluid_model newtonian -fluid_viscosity 10 -time_end 0.6", "Bingham": PLATES + YIELDS + " -time_end 0.8",
        "film": film_options()}


def prepare(run, path, options):
    if run == "film":
        FILM.write(path, ALONG * FILM.spacing, 0.0)


def rows_of(run, edge):
    """Heights, m, velocity along x, m/s, and stress, Pa: means of the rows of particles."""
    frame = last_frame(run, "layer")
    y = frame["position"][:, 1]
    row = np.floor(y / (edge / 2)).astype(int)
    inside = [row == n for n in np.unique(row)]
    return (np.array([field[n].mean(axis=0) for n in inside]) for field in (y, frame["grid_velocity"][:, 0], frame["stress"]))


def exact(law, y):
    """Velocity at heights y from the lower plate."""
    strength, n, _ = LAWS[law]
    plug, m = strength / G, 1 + 1 / n
    return (G / K) ** (1 / n) / m * ((H - plug) ** m - np.maximum(abs(y - H) - plug, 0) ** m)


def check(runs):
    for law, (strength, _, tolerance) in LAWS.items():
        y, velocity, stress = rows_of(runs[law], EDGE)
        peak = exact(law, np.array([H]))[0]
        yield Row(f"largest velocity between plates, {law} (m/s)", velocity.max(), peak, tolerance, "steady flow", relative=True)
        yield Row(f"largest error of the profile, {law} (of the largest velocity)", abs(velocity - exact(law, y)).max() / peak, 0,
                  tolerance, "steady flow")
    y, velocity, stress = rows_of(runs["film"], FILM.spacing)
    yield Row("velocity of the film's surface (m/s)", velocity[-1], float(FILM.velocity(y[-1])), 0.01, "Nusselt", relative=True)
    yield Row("largest error of its profile (of the velocity of the surface)", abs(velocity - FILM.velocity(y)).max() / FILM.surface(), 0,
              0.01, "Nusselt")
    shear = FILM.pull * (FILM.height - y)
    yield Row("largest error of its shear stress (of that at the base)", abs(stress[:, 3] - shear).max() / (FILM.pull * FILM.height), 0, 0.03,
              "equilibrium")


def draw(axes, runs):
    heights = np.linspace(0, 1, 101)
    for law in LAWS:
        y, velocity, _ = rows_of(runs[law], EDGE)
        peak = exact(law, np.array([H]))[0]
        axes.plot(velocity / peak, y / (2 * H), ".", ms=4, label=f"plates, {law}")
        axes.plot(exact(law, 2 * H * heights) / peak, heights, "k--", lw=0.8)
    y, velocity, _ = rows_of(runs["film"], FILM.spacing)
    axes.plot(velocity / FILM.surface(), y / FILM.height, "x", ms=4, label="film")
    axes.plot(FILM.velocity(FILM.height * heights) / FILM.surface(), heights, "k--", lw=0.8)
    axes.set(xlabel="velocity over the largest (dashed: exact)", ylabel="height over that of the fluid")
    axes.legend()
