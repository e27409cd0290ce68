"""Spinning disc, one turn

An elastic disc spins freely. In the steady state of plane strain its stress is

$$\\sigma_{rr} = k\\,(3 - 2\\nu)(R^2 - r^2), \\qquad \\sigma_{\\theta\\theta} = k\\,[(3 - 2\\nu) R^2 - (1 + 2\\nu) r^2], \\qquad
k = \\frac{\\rho\\omega^2}{8 (1 - \\nu)} ,$$

with which it starts. After one turn the stress of every particle, which has turned by 360° with it, must be the same as at
the start, the particles must be back at their positions, and angular momentum and energy must be conserved. Strains are
0.2 %. In 3D a slice of the disc, two cells thick, spins in the vertical plane. (A unit test turns a stress at a point, without a
mesh, by 360° and recovers it to $10^{-12}$.) FLIP strains the soil at a free surface that turns; the table shows FLIP and APIC,
which does not strain it.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import first_frame, last_frame
from mpm_regression.row import Row

RADIUS, OMEGA, DENSITY, POISSON = 1.0, 2 * np.pi, 1000.0, 0.3
THICKNESS = 0.2
SPACING = {"2D": 0.05, "3D": 0.1, "2D_flip": 0.05}
RUNS = {"2D": "-disc_file {start}", "2D_flip": "-disc_file {start} -velocity_update flip", "3D": "-disc_file {start} -dim 3 -mesh_lower -1.3,0.3,-1.3 -mesh_upper 1.3,0.5,1.3 -mesh_spacing 0.1"
        " -mesh_ymin roller -mesh_ymax roller -mesh_zmin free -mesh_zmax free"}
SURFACE = "FLIP: nodes at the free surface, covered on one side, do not move with the spin of the particles."
LONG = True


def exact_stress(place, dim):
    """Stress [N, 6] of the steady spin at places [N, 2] in the plane of the disc, Pa."""
    r2 = np.sum(place**2, axis=1)
    k = DENSITY * OMEGA**2 / (8 * (1 - POISSON))
    radial = k * (3 - 2 * POISSON) * (RADIUS**2 - r2)
    hoop = k * ((3 - 2 * POISSON) * RADIUS**2 - (1 + 2 * POISSON) * r2)
    c, s = (place / np.sqrt(r2)[:, None]).T
    stress = np.zeros((len(place), 6))
    up, out, shear = (1, 2, 3) if dim == 2 else (2, 1, 5)
    stress[:, 0] = radial * c**2 + hoop * s**2
    stress[:, up] = radial * s**2 + hoop * c**2
    stress[:, out] = POISSON * (radial + hoop)
    stress[:, shear] = (radial - hoop) * c * s
    return stress


def prepare(run, path, options):
    h = SPACING[run] / 2
    lower, upper = ([-1.2, -1.2], [1.2, 1.2]) if run != "3D" else ([-1.2, 0.3, -1.2], [1.2, 0.5, 1.2])
    position = particles.lattice(lower, upper, h)
    position = position[np.sum(position[:, [0, -1]] ** 2, axis=1) < RADIUS**2]
    velocity = np.zeros_like(position)
    velocity[:, 0], velocity[:, -1] = -OMEGA * position[:, -1], OMEGA * position[:, 0]
    number = np.arange(len(position), dtype=float)  # an elastic material leaves the plastic strain alone
    particles.write(path, "disc", position, h, velocity=velocity, plastic_strain=number,
                    stress=exact_stress(position[:, [0, -1]], position.shape[1]))


def by_number(fields):
    order = np.argsort(fields["plastic_strain"])
    return {name: values[order] for name, values in fields.items()}


def spin_of(fields, up):
    """Angular momentum and kinetic energy, over the mass of a particle."""
    x, v = fields["position"][:, [0, up]], fields["velocity"][:, [0, up]]
    return np.sum(x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]), np.sum(v**2) / 2


def stress_error(start, end, dim):
    """Root of the mean square error of the stress, of particles within 0.9 R, over the largest stress."""
    place = start["position"][:, [0, dim - 1]]
    inside = np.sum(place**2, axis=1) < (0.9 * RADIUS) ** 2
    expected = exact_stress(place, dim)
    return np.sqrt(np.mean((end["stress"][inside] - expected[inside]) ** 2)) / expected.max()


def check(runs):
    for name, run in runs.items():
        dim = int(run.number("dim", 2))
        why = SURFACE if name == "2D_flip" else ""
        what = name.replace("_", ", ")
        start, end = by_number(first_frame(run, "disc")), by_number(last_frame(run, "disc"))
        yield Row(f"rms error of the stress over the largest stress, {what}", stress_error(start, end, dim), 0, 0.02,
                  "theory of elasticity", shortfall=why, bound=0.2)
        back = np.linalg.norm(end["position"] - start["position"], axis=1).max() / RADIUS
        yield Row(f"largest distance from the start over R, {what}", back, 0, 0.02, "one turn", shortfall=why, bound=0.06)
        (spin_0, energy_0), (spin, energy) = spin_of(start, dim - 1), spin_of(end, dim - 1)
        yield Row(f"angular momentum kept, {what}", spin / spin_0, 1, 0.005, "conservation")
        yield Row(f"kinetic energy kept, {what}", energy / energy_0, 1, 0.01, "conservation", shortfall=why, bound=0.02)


def draw(axes, runs):
    start, end = by_number(first_frame(runs["2D"], "disc")), by_number(last_frame(runs["2D"], "disc"))
    r = np.linalg.norm(start["position"], axis=1)
    axes.plot(r, end["stress"][:, :2].sum(axis=1) / 1e3, ".", ms=2, label="after one turn")
    line = np.linspace(0.001, 1, 100)
    exact = exact_stress(np.column_stack([line, 0 * line]), 2)
    axes.plot(line, exact[:, :2].sum(axis=1) / 1e3, "k--", label="exact")
    axes.set(xlabel="radius (m)", ylabel="sum of the stresses in the plane (kPa)")
    axes.legend()
