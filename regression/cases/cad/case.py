"""Surfaces of triangles that meet rigid bodies

*Drops*: a cube falls flat on a rigid plane, or on a side of the mesh, with a restitution of 0.5, and comes to rest. *Tumbles*: one on edge
falls on a rigid plane and tumbles. Each as the shape `box`, which is the answer, and as an STL file of twelve triangles. *Rolls*: a ball
of 2048 triangles rolls down a plane of 20 degrees.
"""

import struct

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row

G, ANGLE = 9.81, np.radians(20)
CENTRE, EDGE = np.array([2.5, 1.0, 1.2]), 0.5
LOWER, UPPER = (",".join(f"{x:.12g}" for x in CENTRE + sign * EDGE / 2) for sign in (-1, 1))
TILT = 0.4  # rad, from x to z, about the lower corner
FLAT, TILTED = f"-body_shape box -body_lower {LOWER} -body_upper {UPPER}", f" -body_angle_deg {float(np.degrees(TILT))!r}"
FILE = "-body_shape stl -body_file {start}"
BOUNCES = " -body_restitution 0.5 -time_end 1.5"
SIDE = " -rigid_bodies body -rigid_contact on -time_end 1"
NORMAL = f"{float(np.sin(ANGLE))!r},0,{float(np.cos(ANGLE))!r}"
RUNS = {"drops_box": FLAT + BOUNCES, "drops": FILE + BOUNCES, "side_box": FLAT + SIDE, "side": FILE + SIDE,
        "tumbles_box": FLAT + TILTED + " -body_angular_velocity 0,1,0", "tumbles": FILE + " -body_angular_velocity 0,1,0",
        "rolls": FILE + f" -plane_point 1,1,1.5 -plane_normal {NORMAL} -mesh_upper 6,2,4 -time_end 0.8"}
RADIUS = 0.5  # m, of the ball, which begins on the plane


def ball():
    faces = [[(x, 0, 0), (0, y, 0), (0, 0, z)][::1 if x * y * z > 0 else -1] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = np.array(faces, dtype=float)
    for _ in range(4):
        a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
        p, q, r = a + b, b + c, c + a
        p, q, r = (m / np.linalg.norm(m, axis=1)[:, None] for m in (p, q, r))
        faces = np.concatenate([np.stack(t, axis=1) for t in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))])
    return np.array([1, 1, 1.5]) + RADIUS * np.array([np.sin(ANGLE), 0, np.cos(ANGLE)]) + RADIUS * faces


def cube(tilt):
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * EDGE / 2 + CENTRE
    about, c, s = CENTRE - EDGE / 2, np.cos(tilt), np.sin(tilt)
    corners = about + (corners - about) @ [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners[[t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]]


def prepare(run, path, options):
    """A binary STL file."""
    triangles = ball() if run == "rolls" else cube(TILT if run == "tumbles" else 0)
    with open(path, "wb") as file:
        file.write(b"".ljust(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *triangle.ravel(), 0))


def check(runs):
    source = "the same body as a box"
    for name, what in (("drops", "on a plane"), ("side", "on a side of the mesh")):
        box, stl = runs[f"{name}_box"].history, runs[name].history
        way = np.abs(box["body_z"]).max()
        yield Row(f"height of a cube that falls {what}, largest difference over the fall", np.abs(stl["body_z"] - box["body_z"]).max() / way, 0,
                  0.01, source)
        yield Row("its place at rest, difference (m)", stl["body_z"][-1] - box["body_z"][-1], 0, 1e-4, source, single=1e-3)
    box, stl = runs["drops_box"].history, runs["drops"].history
    yield Row("its largest velocity upwards over that of the box", stl["body_velocity_z"].max() / box["body_velocity_z"].max(), 1, 0.01, source)
    box, stl = runs["tumbles_box"].history, runs["tumbles"].history
    yield Row("rotation of a cube that tumbles, largest difference over the largest rotation",
              np.abs(stl["body_angle_y"] - box["body_angle_y"]).max() / np.abs(box["body_angle_y"]).max(), 0, 0.02, source)
    run = runs["rolls"].history
    down = np.cos(ANGLE) * run["body_velocity_x"] - np.sin(ANGLE) * run["body_velocity_z"]
    yield Row("acceleration of a ball of triangles that rolls down 20 degrees (m/s2)", slope(run["time"], down, 0.2), 5 / 7 * G * np.sin(ANGLE),
              0.02, "rolling", relative=True)
    yield Row("its angular velocity times the radius over the velocity", RADIUS * run["body_angular_velocity_y"][-1] / down[-1], 1, 0.02,
              "rolling")


def draw(axes, runs):
    for name in ("drops_box", "drops"):
        axes.plot(runs[name].history["time"], runs[name].history["body_z"], label=name)
    axes.set(xlabel="time (s)", ylabel="displacement upwards (m)")
    axes.legend()
