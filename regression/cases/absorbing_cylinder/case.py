"""Absorbing sides of a body of revolution

Pulses in a cylinder of elastic soil (`-geometry axisymmetric`, $\\nu = 0$) meet absorbing sides, whose dashpots have the factor $a$.
*Along the axis* the pulse reflected from the end has the velocity $R = (1 - a)/(1 + a)$ times that of the first one. *Along the radius* a
pulse begins 5 m from the outer side, at 10 m, and moves outwards; the momentum along the radius is that of the wave equation of the
cylinder with the same dashpots, solved by finite differences with 32 times smaller cells, until the pulse has come back to where it
began. *Level ground* with the stress of its weight must stay at rest between absorbing sides, and so must a heap that has come to rest
between a roller and a fixed base, when its sides begin to absorb.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.checks.absorbing import reflection_rows, rest_row
from mpm_regression.row import Row

SPACING, FINE, LENGTH, RADIUS = 0.25, 0.125, 15.0, 15.0
DENSITY, YOUNG, SPEED, PEAK = 2000.0, 2e7, 100.0, 0.01
FACTORS = ("0.5", "1", "2")
END = 0.11  # s, of the radial pulses
AXIAL = "-soil_shape particles -soil_file {{start}} -mesh_upper 1,15 -mesh_ymin free -mesh_ymax absorbing -mesh_ymax_dashpot_factor {} -time_end 0.125"
RADIAL = (f"-soil_shape particles -soil_file {{{{start}}}} -mesh_spacing {FINE} -mesh_upper {RADIUS},{FINE} -mesh_xmax absorbing"
          f" -mesh_xmax_dashpot_factor {{}} -time_end {END}")
GROUND = "-mesh_upper 4,4 -mesh_ymin absorbing -mesh_xmax absorbing -mesh_ymax free -elastic_poisson 0.3 -gravity 0,-10 -time_courant 0.4"
LEVEL = GROUND + " -soil_shape box -soil_lower 0,0 -soil_upper 4,3 -soil_stress k0 -time_end 4 -history_interval 0.1"
HEAP = (GROUND + " -soil_shape polygon -soil_polygon 0,0,4,0,4,1.5,2.5,1.5,1.5,3,0,3 -stages rest,shake -rest_end equilibrium -rest_damping 0.6"
        " -rest_unbalanced_ratio 3e-7 -rest_time_end 5 -rest_mesh_xmax roller -rest_mesh_ymin fixed -rest_reset on -shake_time_end 4"
        " -history_interval 0.05")
RUNS = {f"axial_{a}": AXIAL.format(a) for a in FACTORS} | {f"radial_{a}": RADIAL.format(a) for a in FACTORS}
RUNS |= {"level": LEVEL, "heap": HEAP}


def pulse(x):
    return PEAK * np.where(abs(x) < 0.5, np.cos(np.pi * x) ** 2, 0.0)


def prepare(run, path, options):
    """A pulse that moves to the side: its velocity, and the stress that a plane wave has with it."""
    if run in ("level", "heap"):
        return
    axis, upper, spacing = (1, (1, LENGTH), SPACING) if run.startswith("axial") else (0, (RADIUS, FINE), FINE)
    position = particles.lattice((0, 0), upper, spacing / 2)
    velocity, stress = np.zeros_like(position), np.zeros((len(position), 6))
    velocity[:, axis] = pulse((position[:, axis] - 8.75) / 5 if axis == 1 else (position[:, axis] - 10) / 5)
    stress[:, axis] = -DENSITY * SPEED * velocity[:, axis]
    volume = (spacing / 2) ** 2 * 2 * np.pi * position[:, 0]
    particles.write(path, "soil", position, spacing / 2, velocity=velocity, stress=stress, volume=volume)


def radial_momentum(factor, times, cells=32 * 120):
    """Momentum along the radius of a cylinder of the height of a cell [kg m/s], by central differences in time and space: velocity and
    hoop stress at nodes, radial stress between them."""
    width = RADIUS / cells
    node, middle = width * np.arange(cells + 1), width * (np.arange(cells) + 0.5)
    held = np.append(np.full(cells, width), width / 2) * node * DENSITY  # mass of a node, of an angle of 1 and a height of 1
    v, hoop, radial = pulse((node - 10) / 5), np.zeros(cells + 1), -DENSITY * SPEED * pulse((middle - 10) / 5)
    dashpot = factor * DENSITY * SPEED * RADIUS
    steps = int(np.ceil(times[-1] / (0.5 * width / SPEED)))
    dt = times[-1] / steps
    now, momentum = np.zeros(steps + 1), np.zeros(steps + 1)
    momentum[0] = (held * v).sum()
    for n in range(1, steps + 1):
        flow = middle * radial
        force = np.append(np.diff(flow, prepend=0), -flow[-1]) - hoop * held / DENSITY / np.maximum(node, width)
        v[1:] += dt * force[1:] / held[1:]
        v[-1] = (v[-1] * held[-1]) / (held[-1] + dt * dashpot)
        radial += dt * YOUNG * np.diff(v) / width
        hoop[1:] += dt * YOUNG * v[1:] / node[1:]
        now[n], momentum[n] = n * dt, (held * v).sum()
    return 2 * np.pi * FINE * np.interp(times, now, momentum)


def check(runs):
    for name in FACTORS:
        yield from reflection_rows(runs[f"axial_{name}"].history, "soil", "y", float(name), ("axial: ", name))
    for name in FACTORS:
        history = runs[f"radial_{name}"].history
        middle = np.maximum(history["time"] - history["dt"] / 2, 0)  # of the last step, as velocities of the soil
        momentum, exact = history["soil_momentum_x"], radial_momentum(float(name), middle)
        error = np.abs(momentum - exact).max() / momentum[0]
        yield Row(f"radial: largest error of the momentum over that at the start, a = {name}", error, 0, 0.01, "finite differences")
    yield rest_row(runs["level"].history, "soil", "level", 1e-6)
    yield rest_row(runs["heap"].history, "soil", "heap", 1e-5)


def draw(axes, runs):
    for name, colour in zip(FACTORS, ("C0", "C1", "C2")):
        history = runs[f"radial_{name}"].history
        momentum = history["soil_momentum_x"]
        axes.plot(history["time"], momentum / momentum[0], colour, label=f"a = {name}")
        axes.plot(history["time"], radial_momentum(float(name), history["time"]) / momentum[0], "k:", lw=1,
                  label="finite differences" if name == FACTORS[-1] else None)
    axes.set(xlabel="time (s)", ylabel="radial momentum over that at the start")
    axes.legend()
