"""Thick cylinder

A ring widens the hole of an elastic cylinder, $a$ = 1 m and $b$ = 2 m, by $u(a)$ = 0.2 mm without friction, in one row of cells between rollers
(`-geometry axisymmetric`). The exact stresses are $\\sigma_{rr} = A (1 - b^2/r^2)$, $\\sigma_{\\theta\\theta} = A (1 + b^2/r^2)$ and $\\sigma_{zz} =
2 \\nu A$ with $A = p a^2/(b^2 - a^2)$ and $u(a) = p a (1 + \\nu)/E \\cdot ((1 - 2\\nu) a^2 + b^2)/(b^2 - a^2)$, which gives $p$ = 2.098 kPa
(Lamé). The force on the ring is $2 \\pi a h p$, over the whole revolution, with the height $h$ of the section. The cells are 1/20 and 1/40 of
the wall; the stresses are compared on the particles that are more than a cell from the faces.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

INNER, OUTER, WIDENED, HEIGHT = 1.0, 2.0, 2e-4, 0.05
RUNS = {"20_cells": "", "40_cells": "-mesh_spacing 0.025"}
SOURCE = "Lamé"


def pressure(run):
    young, poisson = run.number("elastic_young"), run.number("elastic_poisson")
    a, b = INNER**2, OUTER**2
    return WIDENED * young * (b - a) / ((1 + poisson) * INNER * ((1 - 2 * poisson) * a + b))


def exact(run, r):
    """Stresses rr, zz, tt at radii, Pa."""
    scale = pressure(run) * INNER**2 / (OUTER**2 - INNER**2)
    return np.column_stack([scale * (1 - (OUTER / r) ** 2), np.full_like(r, 2 * run.number("elastic_poisson") * scale), scale * (1 + (OUTER / r) ** 2)])


def errors(run):
    """Largest errors of the three stresses within the wall, of the pressure in the hole, and of the force on the ring, of the exact one."""
    fields, spacing = last_frame(run, "cylinder"), run.number("mesh_spacing")
    r = fields["position"][:, 0]
    inside = (r > INNER + spacing) & (r < OUTER - spacing)
    stress = np.abs(fields["stress"][:, :3] - exact(run, r))[inside].max(axis=0) / pressure(run)
    rest = run.history["time"] > 0.7
    force = -run.history["ring_force_x"][rest].mean() / (2 * np.pi * INNER * HEIGHT * pressure(run))
    return [*stress, abs(force - 1)]


def check(runs):
    names = ("radial stress", "axial stress", "hoop stress")
    coarse, fine = errors(runs["20_cells"]), errors(runs["40_cells"])
    for name, value in zip(names, coarse):
        yield Row(f"largest error of the {name} over the pressure, 20 cells", value, 0, 0.03, SOURCE)
    for name, value in zip(names, fine):
        yield Row(f"largest error of the {name} over the pressure, 40 cells", value, 0, 0.015, SOURCE)
    for cells, value in ((20, coarse[3]), (40, fine[3])):
        yield Row(f"error of the force on the ring, {cells} cells", value, 0, 1e-3, SOURCE, single=5e-3)
    mass = 2000 * np.pi * (OUTER**2 - INNER**2) * HEIGHT
    yield Row("mass of the whole revolution (kg)", runs["20_cells"].history["cylinder_mass"][-1], mass, 1e-9 * mass, "Pappus", single=1e-5 * mass)


def draw(axes, runs):
    run = runs["20_cells"]
    fields = last_frame(run, "cylinder")
    r = np.sort(fields["position"][:, 0])
    for k, (name, colour) in enumerate((("rr", "r"), ("zz", "b"), ("tt", "k"))):
        axes.plot(fields["position"][:, 0], fields["stress"][:, k] / 1e3, colour + ".", ms=3, label=name)
        axes.plot(r, exact(run, r)[:, k] / 1e3, colour + "-", lw=0.8)
    axes.set(xlabel="radius (m)", ylabel="stress (kPa)")
    axes.legend()
