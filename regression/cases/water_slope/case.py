"""Infinite submerged slope

A slab of sand, $z$ = 1.5 m thick, under water on a rough base that dips by $\\beta$ = 25 degrees, begins with the stresses of
its buoyant weight, $\\sigma'_n = -\\gamma' z\\cos\\beta$, $\\tau = \\gamma' z\\sin\\beta$. Its factor of safety is
$\\tan\\varphi/\\tan\\beta$, dry or submerged. With $\\varphi$ for 1.03 it stays. With $\\varphi$ for 0.9 it slides on its lowest
cells. Flow is associated, so that the slab rises by $\\tan\\varphi$ as it slides, which presses it on the base, and the
acceleration down the slope is $g (1 - \\rho_w/\\rho) (\\sin\\beta - \\cos\\beta\\tan\\varphi) \\cos^2\\varphi$. The middle third is
read before waves from the ends come there. Horizontal stress is that of a slope about to fail, $2/\\cos^2\\beta - 1$ times the
normal stress. F-bar is off: it brings the mean stresses of a cell together, and single particles would yield.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row

BETA, DENSITY, WATER, G = np.radians(25.0), 2000.0, 1000.0, 9.81
LENGTH, THICK, SPACING, END = 30.0, 1.5, 0.125, 0.1
SAFETY = {"stays": 1.03, "slides": 0.9}


def phi(factor):
    """Angle of friction for a factor of safety, deg."""
    return np.degrees(np.arctan(factor * np.tan(BETA)))


RUNS = {f"{name}_{how}": f"-gravity {G * np.sin(BETA):.15g},{-G * np.cos(BETA):.15g}"
        f" -sand_friction_deg {phi(factor):.12g} -sand_dilation_deg {phi(factor):.12g} -slab_file {{start}}"
        + (" -water_level 20" if how == "submerged" else "") for name, factor in SAFETY.items() for how in ("dry", "submerged")}

IN_3D = (f" -dim 3 -mesh_lower 0,0,0 -mesh_upper 32,0.5,2 -gravity {G * np.sin(BETA):.15g},0,{-G * np.cos(BETA):.15g}"
         " -mesh_ymin roller -mesh_ymax roller -mesh_zmin fixed -mesh_zmax free")
RUNS["slides_submerged_3D"] = RUNS["slides_submerged"] + IN_3D


def weight(run):
    """Effective unit weight, N/m3."""
    return (DENSITY - WATER * ("submerged" in run)) * G


def prepare(run, path, options):
    dim = 3 if run.endswith("3D") else 2
    place = particles.lattice((1, *[0] * (dim - 1)), (1 + LENGTH, *[0.5] * (dim - 2), THICK), SPACING)
    depth = THICK - place[:, -1]
    up, across, shear = (1, 2, 3) if dim == 2 else (2, 1, 5)
    stress = np.zeros((len(place), 6))
    stress[:, up] = -weight(run) * depth * np.cos(BETA)
    stress[:, 0] = (2 / np.cos(BETA) ** 2 - 1) * stress[:, up]
    stress[:, across] = (stress[:, 0] + stress[:, up]) / 2
    stress[:, shear] = weight(run) * depth * np.sin(BETA)
    particles.write(path, "slab", place, SPACING, stress=stress)


def speed(run):
    """Mean speed down the slope of the upper half of the middle third, m/s."""
    slab = last_frame(run, "slab")
    x, y = slab["position"][:, 0], slab["position"][:, int(run.number("dim", 2)) - 1]
    inside = (np.abs(x - 1 - LENGTH / 2) < LENGTH / 6) & (y > THICK / 2)
    return slab["velocity"][inside, 0].mean()


def check(runs):
    for how in ("dry", "submerged"):
        g = weight(f"x_{how}") / DENSITY
        yield Row(f"speed over g' t sin(beta), factor of safety 1.03, {how}", speed(runs[f"stays_{how}"]) / (g * END * np.sin(BETA)),
                  0, 1e-9, "rest", single=1e-3)
        yield Row(f"speed over g' t sin(beta), factor of safety 0.9, {how}", speed(runs[f"slides_{how}"]) / (g * END * np.sin(BETA)),
                  0.1 * np.cos(np.radians(phi(SAFETY["slides"]))) ** 2, 0.01, "sliding, (1 - 0.9) cos2(phi)")
    yield Row("speed over g' t sin(beta), factor of safety 0.9, submerged, 3D",
              speed(runs["slides_submerged_3D"]) / (weight("submerged") / DENSITY * END * np.sin(BETA)),
              0.1 * np.cos(np.radians(phi(SAFETY["slides"]))) ** 2, 0.01, "sliding, (1 - 0.9) cos2(phi)")
