"""Waves of large strain

An elastic square that is periodic along both axes begins without stress, with the velocities $v_x = V \\sin 2\\pi X \\cos 2\\pi Y$, $v_y =
0.7 V \\sin 2\\pi (X + Y)$, $V$ = 0.25 of the speed of pressure waves. A quarter of a period later the soil is stretched by up to 1.25
and pressed to 0.82, sheared and turned. The exact solution of the same equations (Jaumann rate, rate of deformation), in the
coordinates of the start, is that of a Fourier method with 128 points along each axis and a Runge-Kutta method of fourth order, which
are exact to $10^{-8}$. The rms errors of displacement and stress must fall with the cells, 16, 32 and 64 along each axis, of the
displacement at second order. The time step is in proportion to the cells.
"""

import functools

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame, order
from mpm_regression.row import Row

LOWER, LENGTH = np.array([-0.3, 0.7]), 1.0  # m
DENSITY, YOUNG, POISSON = 1000.0, 1e6, 0.3
LAME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
SHEAR = YOUNG / (2 * (1 + POISSON))
SPEED = np.sqrt((LAME + 2 * SHEAR) / DENSITY)  # m/s
END = 0.25 * LENGTH / SPEED                    # s
STEPS = {16: 50, 32: 100, 64: 200}             # to the end, by cells along each axis
POINTS, FINE_STEPS = 128, 160
LONG = True
SIZE = "Particles keep their size: where the soil is stretched they leave gaps, and where it is pressed they overlap."
VARIANTS = {"fixed": "", "stretch": " -particle_domain stretch", "stretch, XPIC": " -particle_domain stretch -velocity_update xpic"}


def name_of(variant, cells):
    return f"{variant.replace(', ', '_').lower()}_{cells}"


RUNS = {name_of(variant, n): f"-mesh_spacing {LENGTH / n:.12g} -time_step {END / steps:.17g} -time_end {END:.17g}"
        f" -output_interval {END:.17g} -soil_file {{start}} -f_bar_fraction 0{more}"
        for variant, more in VARIANTS.items() for n, steps in STEPS.items()}


def start_velocity(x, y):
    return 0.25 * SPEED * np.stack([np.sin(2 * np.pi * x) * np.cos(2 * np.pi * y), 0.7 * np.sin(2 * np.pi * (x + y))])


def prepare(run, path, options):
    spacing = float(options[options.index("-mesh_spacing") + 1]) / 2
    place = particles.lattice(LOWER, LOWER + LENGTH, spacing)
    x, y = (place - LOWER).T / LENGTH
    particles.write(path, "soil", place, spacing, velocity=start_velocity(x, y).T)


def gradient(field):
    """d field / dX, d field / dY of a periodic field [..., POINTS, POINTS]."""
    k = 2j * np.pi * np.fft.fftfreq(POINTS, LENGTH / POINTS)
    k[POINTS // 2] = 0
    there = np.fft.fft2(field)
    return np.fft.ifft2(np.stack([there * k[:, None], there * k])).real


def rates(u, v, stress):
    """Time derivatives of displacement, velocity and stress (xx, yy, xy), each [components, POINTS, POINTS]."""
    du, dv, ds = gradient(u), gradient(v), gradient(stress)  # [X or Y, component, ...]
    f = np.array([[1 + du[0, 0], du[1, 0]], [du[0, 1], 1 + du[1, 1]]])
    j = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
    back = np.array([[f[1, 1], -f[0, 1]], [-f[1, 0], f[0, 0]]]) / j  # dX_k / dx_j
    l = np.einsum("kixy,kjxy->ijxy", dv, back)
    grad = np.einsum("ksxy,kjxy->sjxy", ds, back)
    spin, shear, trace = (l[0, 1] - l[1, 0]) / 2, (l[0, 1] + l[1, 0]) / 2, l[0, 0] + l[1, 1]
    sx, sy, sxy = stress
    change = np.stack([LAME * trace + 2 * SHEAR * l[0, 0] + 2 * spin * sxy, LAME * trace + 2 * SHEAR * l[1, 1] - 2 * spin * sxy,
                       2 * SHEAR * shear + spin * (sy - sx)])
    return v, j / DENSITY * np.stack([grad[0, 0] + grad[2, 1], grad[2, 0] + grad[1, 1]]), change


@functools.cache
def exact():
    """Displacement and stress at the end, at X = i / POINTS, Y = k / POINTS."""
    x, y = np.meshgrid(*[np.arange(POINTS) / POINTS] * 2, indexing="ij")
    state = [np.zeros((2, POINTS, POINTS)), start_velocity(x, y), np.zeros((3, POINTS, POINTS))]
    dt = END / FINE_STEPS
    for _ in range(FINE_STEPS):
        one = rates(*state)
        two = rates(*[s + dt / 2 * r for s, r in zip(state, one)])
        three = rates(*[s + dt / 2 * r for s, r in zip(state, two)])
        four = rates(*[s + dt * r for s, r in zip(state, three)])
        state = [s + dt / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, one, two, three, four)]
    return state[0], state[2]


def at_particles(field, cells):
    """A field of exact() at the lattice of the particles, in its order: by interpolation with its Fourier series."""
    k = np.fft.fftfreq(POINTS, 1 / POINTS)
    place = (np.arange(2 * cells) + 0.5) / (2 * cells)
    wave = np.exp(2j * np.pi * np.outer(place, k))
    there = np.fft.fft2(field) / POINTS**2
    return np.einsum("ak,ckl,bl->cab", wave, there, wave, optimize=True).real.reshape(len(field), -1)


def errors(run, cells):
    """rms errors of displacement and stress over their rms."""
    frame = last_frame(run, "soil")
    start = particles.lattice(LOWER, LOWER + LENGTH, LENGTH / cells / 2)
    moved = frame["position"][:, :2] - start
    moved -= LENGTH * np.round(moved / LENGTH)
    u, stress = (at_particles(field, cells) for field in exact())
    answer = frame["stress"][:, [0, 1, 3]].T
    return [np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)) for a, b in ((moved.T, u), (answer, stress))]


def check(runs):
    for variant in VARIANTS:
        found = np.array([errors(runs[name_of(variant, n)], n) for n in STEPS])
        short = {"shortfall": SIZE, "bound": 0.5} if variant == "fixed" else {}
        yield Row(f"order of the displacement, {variant}", -order(list(STEPS), found[:, 0]), 2, 0.1, "second order", at_least=True, **short)
        yield Row(f"rms error of the displacement, 64 cells, {variant}", found[-1, 0], 0, 0.01, "Fourier method")
        yield Row(f"order of the stress, {variant}", -order(list(STEPS), found[:, 1]), 1, 0.1, "first order", at_least=True, **short)
        yield Row(f"rms error of the stress, 64 cells, {variant}", found[-1, 1], 0, 0.02, "Fourier method",
                  **(short | {"bound": 0.08} if short else {}))


def draw(axes, runs):
    for variant in VARIANTS:
        found = np.array([errors(runs[name_of(variant, n)], n) for n in STEPS])
        line, = axes.loglog(list(STEPS), found[:, 0], "o-", label=f"displacement, {variant}")
        axes.loglog(list(STEPS), found[:, 1], "s--", color=line.get_color(), label=f"stress, {variant}")
    n = np.array(list(STEPS))
    axes.loglog(n, 0.02 * (n / 16.0) ** -2, "k:", lw=0.8, label="second order")
    axes.set(xlabel="cells along an axis", ylabel="rms error over rms")
    axes.legend(fontsize=7)
