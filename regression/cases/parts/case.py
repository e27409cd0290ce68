"""A rigid body of several parts

*Pressed*: a T that is pressed into clay beyond its two inner corners, as one polygon, and as the union of two boxes, on each other
or one in the other. *Halves*: a plate, whole, and in two halves that share an end; *even* halves take the same force. *Falls*: an L that falls on a corner of its foot onto a
rigid plane and turns until it stands, as one polygon, and as the union of two boxes. The polygon is the exact answer.
"""

import numpy as np

from mpm_regression.row import Row

ELL = np.array([[1, 1], [1.8, 1], [1.8, 1.2], [1.2, 1.2], [1.2, 2], [1, 2]])
TILT = 0.3


def turned(points):
    c, s = np.cos(TILT), np.sin(TILT)
    return ",".join(f"{x:.12g}" for x in ((np.array(points) - [1, 1]) @ [[c, s], [-s, c]] + [1, 1]).ravel())


def pair(a, b, name="tee", names=("cap", "stem"), angle=""):
    text = f"-{name}_parts {','.join(names)}"
    for part, (lower, upper) in zip(names, (a, b)):
        text += f" -{part}_shape box -{part}_lower {lower} -{part}_upper {upper}{angle.format(part)}"
    return text


def corner(x, y, width, height):
    """The lower and the upper corner of a box that -NAME_angle_deg turns, so that it is a part of the L."""
    at = np.array([float(v) for v in turned([[x, y]]).split(",")])
    return ",".join(f"{v:.12g}" for v in at), ",".join(f"{v:.12g}" for v in at + [width, height])


WHOLE = "-tee_shape polygon -tee_polygon 1.5,1.7,1.8,1.7,1.8,1.2,2.2,1.2,2.2,1.7,2.5,1.7,2.5,2.1,1.5,2.1"
FALL = ("-rigid_bodies ell,floor -floor_shape half_plane -floor_point 0,1.9 -floor_normal 0,1 -floor_particles_per_cell 1 -soil_lower 3.5,1.9 -soil_upper 3.9,2.3"
        " -clay_young 1e5 -ell_motion dynamic -ell_density 2600 -ell_free x,y,rz -rigid_friction 0.4 -time_step 5e-4 -time_end 0.8"
        " -mesh_upper 4,4 ")
PLACE = 1.4  # m, of the L over its drawing
SITES = " -tee_contact sites"
FORCES = " -tee_part_forces on"
EVEN = " -tee_velocity 0,-1.2 -mesh_upper 4.1,2.8 -soil_upper 4.1,1.2 -mesh_xmin roller -mesh_xmax roller"
RUNS = {"polygon": WHOLE, "sites": WHOLE + SITES, "on_each_other_sites": pair(("1.5,1.7", "2.5,2.1"), ("1.8,1.2", "2.2,1.7")) + SITES,
        "on_each_other": pair(("1.5,1.7", "2.5,2.1"), ("1.8,1.2", "2.2,1.7")),
        "overlap": pair(("1.5,1.7", "2.5,2.1"), ("1.8,1.2", "2.2,2")),
        "plate": "-tee_shape box -tee_lower 1.5,1.2 -tee_upper 2.5,1.6",
        "halves": pair(("1.5,1.2", "1.9,1.6"), ("1.9,1.2", "2.5,1.6")) + FORCES,
        "even": pair(("1.5,1.2", "2.05,1.6"), ("2.05,1.2", "2.6,1.6")) + FORCES + EVEN,
        "even_sites": pair(("1.5,1.2", "2.05,1.6"), ("2.05,1.2", "2.6,1.6")) + FORCES + EVEN + SITES,
        "falls": FALL + "-ell_shape polygon -ell_polygon " + turned(ELL + [0, PLACE]),
        "falls_in_parts": FALL + pair(corner(1, 1 + PLACE, 0.8, 0.2), corner(1, 1.2 + PLACE, 0.2, 0.8), "ell", ("foot", "leg"),
                                      f" -{{0}}_angle_deg {float(np.degrees(TILT))!r}")}


def off(runs, name, whole, columns="tee_force_"):
    """Largest difference of the forces from those on the whole body, over the largest."""
    exact = runs[whole].columns(columns)
    return np.abs(runs[name].columns(columns) - exact).max() / np.abs(exact).max()


def check(runs):
    source = "the body as one polygon"
    for name in ("on_each_other", "overlap"):
        yield Row(f"force on a T of two boxes off that on the polygon, over the largest, {name}", off(runs, name, "polygon"), 0, 0.02, source)
    yield Row("the same with contact at sites", off(runs, "on_each_other_sites", "sites"), 0, 1e-9, source, single=0.02)
    yield Row("force on a plate in two halves off that on the whole, over the largest", off(runs, "halves", "plate"), 0, 1e-9,
              "the whole plate", single=0.02)
    for name in ("halves", "even", "even_sites"):
        of = [runs[name].columns(f"{part}_force_") for part in ("tee", "cap", "stem")]
        yield Row(f"forces on the parts added, off that on the plate, over the largest, {name}",
                  np.abs(of[1] + of[2] - of[0]).max() / np.abs(of[0]).max(), 0, 1e-12, "the force on the body")
        if name != "halves":  # a site on the border belongs to one part
            yield Row(f"force on half a plate off that on the other, over the largest, {name}",
                      np.abs(of[1] - of[2] * [-1, 1]).max() / np.abs(of[0]).max(), 0, 1e-6 if name == "even" else 0.06, "symmetry", single=0.06)
    for column, unit in (("ell_x", "m"), ("ell_y", "m"), ("ell_angle", "rad")):
        exact = runs["falls"].history[column]
        yield Row(f"{column} of an L that falls, largest difference ({unit})",
                  np.abs(runs["falls_in_parts"].history[column] - exact).max(), 0, 1e-6, source, single=1e-3)
    yield Row("rotation of the L at the end (rad)", np.abs(runs["falls"].history["ell_angle"][-1]), 0.2, 0, "it stands", at_least=True)
