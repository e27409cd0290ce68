"""Stiffness from a field

The stiffness of a column of 10 m is E = 2 MPa + 1 MPa/m times the depth, in a field on a grid, or as `young_gradient`.
At rest $\\sigma_{yy} = -\\rho g z$ at the depth $z$ at the start, and with $M = E (1-\\nu)/((1+\\nu)(1-2\\nu)) = M_0 + k_M z$ the top settles by
$u = \\rho g (H/k_M - (M_0/k_M^2) \\ln(1 + k_M H/M_0))$ = 84.167 mm by small strains. `mpm` adds up increments of strain, which is logarithmic
strain here, so that $u = \\int_0^H (1 - e^{-\\rho g z / M}) dz$ = 83.8 mm; the case compares with this integral. The laws with a strength are given so
much of it that they stay elastic.

A bar of 25 m, fixed at one end, vibrates in its first mode; a file of particles gives them $E = E_0 (1 + k x)^2$, so that the
waves travel with $c = c_0 (1 + k x)$. With $\\ell = \\ln(1 + k L)$ and the first root of $\\tan \\beta \\ell = 2 \\beta$ the mode is
$(1 + k x)^{-1/2} \\sin(\\beta \\ln(1 + k x))$ and $\\omega = k c_0 \\sqrt{\\beta^2 + 1/4}$.
"""

import h5py
import numpy as np

from mpm_regression import particles
from mpm_regression.curves import first_frame, last_frame, mesh_options
from mpm_regression.row import Row

LOWER, HEIGHT = (0.3, -0.7), 10.0
YOUNG, GROWTH, POISSON, WEIGHT = 2e6, 1e6, 0.3, 1800 * 9.81
SMALL_STRAIN = 0.084167  # m
STRONG = {
    "von_mises": "-soil_su 1e7", "tresca": "-soil_su 1e7",
    "softening_clay": "-soil_su 1e5 -soil_remoulded_ratio 0.5 -soil_xi95 100",
    "mohr_coulomb": "-soil_cohesion 1e7 -soil_friction_deg 30",
    "drucker_prager": "-soil_cohesion 1e7 -soil_friction_deg 30 -soil_match compression",
    "j2_hardening": "-soil_yield_stress 1e7"}

LENGTH, GROWS, SLOWEST, DENSITY, SPEED = 25.0, 0.08, 10.0, 1000.0, 0.01
ORIGIN, BAR_CELLS, PERIODS = (3.7, -1.3), 40, 10


def strip(dim, more):
    h = 0.25
    lower = (*[LOWER[0]] * (dim - 1), LOWER[1])
    side = [x + h for x in lower[:-1]]
    upper = ",".join(f"{x:.12g}" for x in (*side, lower[-1] + HEIGHT))
    sides = " -gravity 0,0,-9.81 -mesh_ymin roller -mesh_ymax roller -mesh_zmin fixed -mesh_zmax free" if dim == 3 else ""
    return (mesh_options(dim, h, lower, (*side, lower[-1] + HEIGHT + 2 * h)) + f" -column_lower {','.join(map(str, lower))} -column_upper {upper}"
            + sides + " " + more)


def bar():
    h = LENGTH / BAR_CELLS
    mesh = mesh_options(2, h, ORIGIN, (ORIGIN[0] + LENGTH + 2 * h, ORIGIN[1] + h))
    return (mesh + " -gravity 0,0 -damping 0 -mesh_xmin fixed -mesh_xmax free -mesh_ymin roller -mesh_ymax roller -time_end 70 -time_courant 0.1"
            f" -soil_density {DENSITY:g} -soil_poisson 0 -bodies bar -bar_material soil -bar_shape particles -bar_particles_per_cell 2 -bar_file {{start}}"
            " -history_interval 0.05 -output_interval 70")


FIELD = "-column_field {start}"
GRADIENT = f"-soil_young {YOUNG:g} -soil_young_gradient {GROWTH:g} -soil_young_datum {LOWER[1] + HEIGHT:g}"
LONG = True
RUNS = {"field_2D": strip(2, FIELD), "field_3D": strip(3, FIELD), "gradient": strip(2, GRADIENT)}
RUNS |= {law: strip(2, f"{FIELD} -soil_model {law} {more}") for law, more in STRONG.items()}
RUNS["bar"] = bar()


def prepare(run, path, options):
    if run == "bar":
        h = LENGTH / BAR_CELLS
        position = particles.lattice(ORIGIN, (ORIGIN[0] + LENGTH, ORIGIN[1] + h), h / 2)
        s = 1 + GROWS * (position[:, 0] - ORIGIN[0])
        velocity = np.zeros_like(position)
        velocity[:, 0] = SPEED * np.sin(root() * np.log(s)) / np.sqrt(s)
        particles.write(path, "bar", position, h / 2, velocity=velocity, young=DENSITY * (SLOWEST * s)**2)
        return
    if "-column_field" not in options:
        return
    dim = 3 if run == "field_3D" else 2
    lower = np.array([*[LOWER[0]] * (dim - 1), LOWER[1]])
    heights = LOWER[1] + np.linspace(0, HEIGHT, 5)
    values = np.broadcast_to((YOUNG + GROWTH * (LOWER[1] + HEIGHT - heights)).reshape(-1, *[1] * (dim - 1)), (5, *[2] * (dim - 1)))
    with h5py.File(path, "w") as file:
        data = file.create_dataset("young", data=values)
        data.attrs["lower"], data.attrs["spacing"] = lower, [*[0.25] * (dim - 1), HEIGHT / 4]


def root():
    """The first root of tan(beta l) = 2 beta."""
    length = np.log(1 + GROWS * LENGTH)
    low, high = 1e-3, np.pi / 2 / length - 1e-9
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if np.tan(middle * length) < 2 * middle else (low, middle)
    return low


def exact_period():
    return 2 * np.pi / (GROWS * SLOWEST * np.sqrt(root()**2 + 0.25))


def exact_settlement(height):
    """Settlement of the soil that was at this height above the base, m."""
    z, dz = np.linspace(HEIGHT - height, HEIGHT, 20001, retstep=True)
    modulus = (YOUNG + GROWTH * z) * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    strain = 1 - np.exp(-WEIGHT * z / modulus)
    return (strain.sum() - (strain[0] + strain[-1]) / 2) * dz


def settlement(run):
    """Settlement of the top particles over the exact one at their height."""
    up = int(run.number("dim", 2)) - 1
    start, end = first_frame(run, "column"), last_frame(run, "column")
    top = start["position"][:, up].max()
    return (top - end["position"][:, up].max()) / exact_settlement(top - LOWER[1])


def period(run):
    """Mean period, s: twice the mean distance of the zeros of the momentum, by linear interpolation."""
    t, p = run.history["time"], run.history["bar_momentum_x"]
    k = np.flatnonzero(p[1:] * p[:-1] < 0)
    zeros = t[k] - p[k] * (t[k + 1] - t[k]) / (p[k + 1] - p[k])
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def check(runs):
    for name in ("field_2D", "field_3D", "gradient", *STRONG):
        yield Row(f"settlement over the exact one, {name.replace('_', ' ')}", settlement(runs[name]), 1, 0.005,
                  "elasticity, confined compression", relative=True)
    top = exact_settlement(HEIGHT)
    yield Row("settlement of the top (m), beside that of small strains", settlement(runs["field_2D"]) * top, SMALL_STRAIN, 0.015,
              "elasticity, small strains", relative=True)
    one, other = (last_frame(runs[name], "column")["stress"] for name in ("field_2D", "gradient"))
    yield Row("stress of field less that of gradient over the largest", np.abs(one - other).max() / np.abs(one).max(), 0, 1e-3, "the same ground")
    yield Row("period of the bar (s)", period(runs["bar"]), exact_period(), 0.005, "linear wave equation", relative=True)


def draw(axes, runs):
    run = runs["bar"]
    t = np.linspace(0, 70, 1000)
    axes.plot(run.history["time"], run.history["bar_momentum_x"] / run.history["bar_momentum_x"][0], lw=1.2, label="bar")
    axes.plot(t, np.cos(2 * np.pi * t / exact_period()), "k--", lw=0.8, label="exact")
    axes.set(xlabel="time (s)", ylabel="momentum over that at the start", xlim=(40, 70))
    axes.legend()
