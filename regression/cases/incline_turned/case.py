"""Area of the contact, at every angle

The block of the incline slides down planes that climb by 0°, 5°, 17° and 45° in the mesh, and start at several places within
a cell. Gravity is turned with the plane, so the answer is always the same: the interface must hold the block with the force
$\\tau_{max} A$, where $A$ is the block's area, $a = g_t - \\tau_{max} A/m$. The check compares the acting area, $(g_t - a)\\,m /
\\tau_{max}$, with the area of the block.
"""

import numpy as np

from mpm_regression.checks.incline import DENSITY, HEIGHT, acceleration, write_block
from mpm_regression.row import Row

ALONG, INTO, LIMIT = -4.9, 8.5, 2000.0  # the block slides down the plane, towards -x
ANGLES = (0, 5, 17, 45)
OFFSETS = {"on a node": 0.0, "at 0.3 cells": 0.03, "at 0.7 cells": 0.07}
LONG = True


def options(angle, offset, dim=2):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    middle = ["0"] if dim == 3 else []
    vector = lambda x, z: ",".join([f"{x:.12g}", *middle, f"{z:.12g}"])
    text = (f"-block_file {{start}} -base_normal {vector(-s, c)} -base_point {vector(0, offset)}"
            f" -gravity {vector(c * ALONG + s * INTO, s * ALONG - c * INTO)}")
    if dim == 3:
        text += (" -dim 3 -mesh_lower 0.5,-0.2,-0.3 -mesh_upper 4.5,0.6,2 -time_end 0.5 -output_interval 0.5 -mesh_ymin free -mesh_ymax free -mesh_zmin free"
                 " -mesh_zmax free")
    return text


CASES = {f"{angle}_{k}": (angle, offset, 2) for angle in ANGLES for k, offset in enumerate(OFFSETS.values())}
CASES |= {f"{angle}_3D": (angle, 0.03, 3) for angle in (0, 17)}
RUNS = {name: options(*how) for name, how in CASES.items()}


def prepare(run, path, options):
    angle, offset, dim = CASES[run]
    turn = np.radians(angle)
    along = 2.0 / np.cos(turn) if angle < 45 else 2.3
    origin = [along * np.cos(turn), along * np.sin(turn) + offset]
    if dim == 3:
        origin[1:1] = [0.037]
    write_block(path, origin, 0.05, INTO, dim, turn)


def area(run, angle):
    """Acting area over the block's."""
    a = acceleration(run, np.radians(angle))
    return (a - ALONG) * DENSITY * HEIGHT / LIMIT


def check(runs):
    names = list(OFFSETS)
    for run, (angle, _, dim) in CASES.items():
        where = names[int(run.split("_")[1])] if dim == 2 else "3D"
        yield Row(f"area that acts over the block's, {angle}°, {where}", area(runs[run], angle), 1, 0.01, "Newton's second law",
                  relative=True)


def draw(axes, runs):
    for name in OFFSETS:
        k = list(OFFSETS).index(name)
        axes.plot(ANGLES, [area(runs[f"{angle}_{k}"], angle) for angle in ANGLES], "o-", label=name)
    axes.axhline(1, color="k", lw=0.8)
    axes.set(xlabel="angle of the plane to the mesh (°)", ylabel="area that acts over the block's")
    axes.legend()
