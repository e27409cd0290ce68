"""Shared by the cases of a collapsing column: the column at rest, its run-out, and the laws of the experiments."""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.results import read_frame

DENSITY, G, K0 = 1600.0, 9.81, 0.485  # K0 of sand of 31 degrees, 1 - sin (Jaky 1944)
LENGTH = 1.0  # m, of the column at the start: half of a symmetric one
SPEEDS = 5.0  # of the elastic wave over sqrt(2 g H), the speed of a fall from the top


def lube(a):
    """Run-out over L0 of sand, rice and sugar in a channel (Lube et al. 2005), as cited by Lagrée et al. (2011)."""
    return 1.2 * a if a < 1.8 else 1.9 * a ** (2 / 3) if a > 2.8 else np.interp(a, (1.8, 2.8), (2.16, 1.9 * 2.8 ** (2 / 3)))


def lajeunesse(a):
    """Run-out over L0 of glass beads in a channel (Lajeunesse et al. 2005), as cited by Lagrée et al. (2011)."""
    return 1.8 * a if a <= 3 else 2.3 * a ** (2 / 3)


def lagree(a):
    """Run-out over L0 of mu(I) as a continuum (Lagrée, Staron & Popinet 2011)."""
    return 2.2 * a if a < 7 else 3.9 * a**0.7


def options(a, spacing, material, run_out):
    """Options of a column a m high and 1 m long, on a mesh that ends `run_out` m beyond it. The stiffness follows the
    height, so that columns of every height strain alike."""
    wave_modulus = DENSITY * SPEEDS**2 * 2 * G * a
    young = wave_modulus * 1.3 * 0.4 / 0.7  # nu = 0.3
    right, top = LENGTH + np.ceil(run_out), a + 2 * spacing
    return (f"-block_file {{start}} -mesh_spacing {spacing} -mesh_upper {right:g},{np.ceil(top / spacing) * spacing:.12g} "
            f"-time_end {5.5 * np.sqrt(a / G):.4g} -block_material {material} -{material}_young {young:.5g}")


def write_column(path, a, spacing):
    """The column at rest with the stress of its weight; spacing of the particles, m."""
    place = particles.lattice((0, 0), (LENGTH, a), spacing)
    vertical = -DENSITY * G * (a - place[:, 1])
    stress = np.zeros((len(place), 6))
    stress[:, 0] = stress[:, 2] = K0 * vertical
    stress[:, 1] = vertical
    particles.write(path, "block", place, spacing, stress=stress)


def surface(run):
    """The deposit's surface: middles x of the columns of the mesh, m, and the soil's height in each, m: volume over width."""
    frame, width = last_frame(run, "block"), run.number("mesh_spacing")
    column = np.floor(frame["position"][:, 0] / width).astype(int)
    height = np.bincount(column, frame["volume"]) / width
    return (np.arange(len(height)) + 0.5) * width, height


def run_out(run):
    """Run-out over the length at the start: to where the soil that hangs together with the heap becomes thinner than a
    quarter of a cell, one row of particles half a cell wide. Linear between the columns of cells."""
    x, height = surface(run)
    thin = run.number("mesh_spacing") / 4
    x, height = np.append(x, x[-1] + run.number("mesh_spacing")), np.append(height, 0)
    end = np.flatnonzero(height < thin)[0]
    return (np.interp(-thin, -height[end - 1:end + 1], x[end - 1:end + 1]) - LENGTH) / LENGTH


def kinetic_energy(frame):
    """Kinetic energy of the nodes' velocity, J/m. The particles' own holds FLIP's noise too, which moves no particle: 7 to
    13 % of the largest energy of a collapse remain in it."""
    fields = read_frame(frame)[1]["block"]
    return (fields["mass"] * (fields["grid_velocity"] ** 2).sum(axis=1)).sum() / 2


def kinetic_share(run):
    """Kinetic energy at the end over its largest."""
    return kinetic_energy(run.frame) / max(kinetic_energy(frame) for frame in run.frames)


def rest_row(what, run):
    return Row(f"kinetic energy at the end over its largest, {what}", kinetic_share(run), 0, 0.01, "the deposit rests")


def band_row(what, run, a, **more):
    """The run-out of a column between 0.85 of Lube's law and 1.1 of Lajeunesse's; "exact" is the middle between them."""
    low, high = 0.85 * lube(a), 1.1 * lajeunesse(a)
    return Row(what, run_out(run), (low + high) / 2, (high - low) / 2, "experiments: 0.85 of Lube et al. (2005) to 1.1 of "
               "Lajeunesse et al. (2005)", **more)
