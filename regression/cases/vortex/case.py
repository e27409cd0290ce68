"""Taylor-Green vortex in a box

One vortex of Taylor & Green (1937) between smooth walls: $u = U e^{-2\\pi^2\\nu t} \\sin\\pi x \\cos\\pi y$, $v = -U e^{-2\\pi^2\\nu t}
\\cos\\pi x \\sin\\pi y$ with $U$ = 1 m/s and $\\nu$ = 0.01 m2/s solves the Navier-Stokes equations in a box of 1 m, whose walls neither let the
fluid through nor hold it back. Particles turn about the middle and past the corners, where streamlines part; without a correction of their
positions (`-position_correction none`) they gather in lines. Domains are split. The fluid is slightly compressible.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.flow import filling

SPEED, NU, DENSITY, SPACING = 1.0, 0.01, 1000.0, 0.05
PRESSURE = 5000.0  # Pa, everywhere at the start
LONG = True
RUNS = {"flip": "-box_file {start}", "flip_none": "-box_file {start} -position_correction none",
        "apic": "-box_file {start} -velocity_update apic", "apic_none": "-box_file {start} -velocity_update apic -position_correction none"}
LINES = "Particles gather in lines without the correction."
CORNERS = "Where streamlines part, particles are driven apart faster than the correction brings them back."
UPDATE = {"flip": "FLIP keeps noise of the particles.", "apic": "APIC damps, on a mesh of 20 cells."}


def velocity(place, t):
    x, y = np.pi * place[:, 0], np.pi * place[:, 1]
    return SPEED * np.exp(-2 * np.pi**2 * NU * t) * np.stack([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y)], axis=1)


def prepare(run, path, options):
    place = particles.lattice((0, 0), (1, 1), SPACING / 2)
    x, y = 2 * np.pi * place.T
    stress = np.zeros((len(place), 6))
    stress[:, :3] = -(PRESSURE + DENSITY * SPEED**2 / 4 * (np.cos(x) + np.cos(y)))[:, None]
    particles.write(path, "box", place, SPACING / 2, stress=stress, velocity=velocity(place, 0))


def error(run):
    """Root of the mean square error of the nodes' velocity at the particles, over that of the exact one, at the end."""
    frame = last_frame(run, "box")
    exact = velocity(frame["position"][:, :2], run.history["time"][-1])
    return np.sqrt(np.sum((frame["grid_velocity"][:, :2] - exact) ** 2) / np.sum(exact**2))


def unevenness(run):
    frame = last_frame(run, "box")
    half = np.stack([frame["half_length_x"], frame["half_length_y"]], axis=1)
    return filling(frame["position"], frame["volume"], half, (0, 0), (1, 1), SPACING, [[True, True]] * 2)[1]


def check(runs):
    decay = np.exp(-4 * np.pi**2 * NU * runs["flip"].history["time"][-1])
    for name in ("flip", "apic"):
        none = runs[name + "_none"]
        yield Row(f"standard deviation of the filled share of a node, {name}", unevenness(runs[name]), 0, 0.02, "an even density",
                  shortfall=CORNERS, bound=0.08)
        yield Row(f"the same without the correction, {name}", unevenness(none), 0, 0.02, "an even density", shortfall=LINES, bound=0.3)
        yield Row(f"rms error of the velocity over its rms, {name}", error(runs[name]), 0, 0.1, "Taylor & Green 1937",
                  shortfall=UPDATE[name], bound=0.15)
        energy = runs[name].history["box_kinetic_energy"]
        yield Row(f"kinetic energy at the end over that at the start, {name}", energy[-1] / energy[0], decay, 0.1, "Taylor & Green 1937",
                  relative=True, shortfall=UPDATE[name], bound=0.3)
        added = runs[name].history["box_corrected_energy"][-1] / energy[0]
        yield Row(f"kinetic energy that the correction adds, over that at the start, {name}", added, 0, 0.01, "none")


def draw(axes, runs):
    for k, name in enumerate(("flip_none", "flip")):
        place = last_frame(runs[name], "box")["position"]
        axes.plot(place[:, 0] + 1.1 * k, place[:, 1], ".", ms=1.5, label=("without correction", "with")[k])
    axes.set(xlabel="x (m); the second run is moved by 1.1 m", ylabel="y (m)", aspect="equal")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.16), ncol=2)
