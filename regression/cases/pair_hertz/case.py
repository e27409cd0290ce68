"""Elastic balls and cylinders pressed together

*Plane*: a rigid plate is pressed on a ball of 0.2 m radius. *Balls*: two such balls are pressed together. *Cylinders*: the same in plane strain. The bodies are
halves that end at their planes of symmetry. The radius of the contact is 15 mm, 6 cells. Hertz has the force at a given approach for balls that are large
against the contact. Those here are a little stiffer: linear finite elements give an approach of 0.9745 of Hertz's at the same force, and so 1.0395 times the force at
the same approach. The approach of cylinders is that of Johnson. *Slip*: two cylinders, whose contact is 30 mm wide to either side, 12 cells, are then shifted
along each other, with a friction of 0.3. The middle of the contact stays stuck, from $-c$ to $c$, with $c/b = \\sqrt{1 - Q/(\\mu P)}$ (Cattaneo, Mindlin). The bodies
shear as they are shifted, so the contact turns by up to 0.013: $Q$ and $P$ are along and across the mean of the nodes' normals. $c$ is fitted to the slip
of the particles on both faces: $\\mu (x \\sqrt{x^2 - c^2} - c^2 \\mathrm{arcosh}(x/c)) / (2 R)$, $R$ that of both.
"""

import numpy as np

from mpm_regression.row import Row

RADIUS, STIFFNESS, FRICTION = 0.2, 1e7 / 0.91, 0.3  # m; E / (1 - nu^2) of a body, Pa
LONG = True


def cylinders(half_width):
    """Load on two cylinders [N/m] for a half width b [m], and their approach [m]."""
    load = np.pi * half_width**2 * STIFFNESS / (4 * RADIUS)
    return load, 2 * load / (np.pi * STIFFNESS) * (2 * np.log(4 * RADIUS / half_width) - 1)


def pressed(spacing, approach, shift=0.0):
    """Two bodies, a cell apart, that the plate presses together and then shifts."""
    top, down = 2 * RADIUS + spacing, -(spacing + approach)
    return (f"-bodies low,high -high_material soft -high_shape disc -high_centre 0,{top:g} -high_radius {RADIUS} -high_fill cut -high_cut_out plate"
            f" -contact_pairs low:high -mesh_upper 0.25,0.65 -mesh_spacing {spacing} -plate_upper 0.24,{top + 0.22:g}"
            f" -plate_displacement_table 0:0:0,0.025:0:{down:.8g},0.04:0:{down:.8g},0.08:{shift}:{down:.8g},1:{shift}:{down:.8g}"), top


BALLS, TOP = pressed(0.0025, 0.00225)
LINES, _ = pressed(0.0025, cylinders(0.015)[1])
SLIP, HIGH = pressed(0.0025, cylinders(0.03)[1], 0.0085)
RUNS = {"plane": "", "balls": BALLS + f" -plate_lower 0,{TOP:g}", "cylinders": LINES + f" -geometry plane_strain -plate_lower 0,{TOP:g}",
        "slip": SLIP + f" -geometry plane_strain -plate_lower -0.24,{HIGH:g} -mesh_lower -0.25,-0.25 -mesh_xmin free -mesh_ymin free -low_high_friction {FRICTION}"
                " -rigid_bodies plate,bed -plate_friction 10 -bed_shape box -bed_lower -0.24,-0.22 -bed_upper 0.24,0 -bed_friction 10 -low_cut_out bed"
                " -time_end 0.071 -output_frames on -output_interval 0.005 -output_fields velocity"}
EARLY = ("Contact with rigid bodies acts from a gap of 0.15 cells on, which is a third of the approach. With -plate_contact_gap_reach 0.05 the force is 2.4 % too small. "
         "Pairs of deformable bodies may approach by their gap.")


def positions(run, time, body):
    with run.frame_at(time) as frame:
        return frame[body]["position"][:, :2]


def forces_at(run, time):
    """Forces across and along the contact [N/m], means of three rows of the history, about the mean normal of a frame."""
    row = np.argmin(np.abs(run.history["time"] - time))
    force = np.array([run.history[f"low_high_force_{axis}"][row - 2:row + 1].mean() for axis in "xy"])
    with run.frame_at(time) as frame:
        nodes = frame["low_high"]
        normals = nodes["contact_normal"][:, :2]
        normal = np.sum(normals * np.sum(normals * nodes["contact_force"][:, :2], axis=1)[:, None], axis=0)
    normal /= np.linalg.norm(normal)
    return abs(force @ normal), abs(force @ [normal[1], -normal[0]])


def slip_of_faces(run, time, width):
    """Places x and slips [m] since 0.04 s of the particles on both faces, column by column of particles, up to `width` from the middle."""
    spacing, faces = run.number("mesh_spacing"), {}
    for body, up in (("low", 1), ("high", -1)):
        before, now = positions(run, 0.04, body), positions(run, time, body)
        column = np.floor(before[:, 0] / (spacing / 2)).astype(int)
        faces[body] = {}
        for k in range(-int(width / (spacing / 2)), int(width / (spacing / 2))):
            there = np.flatnonzero(column == k)
            at = there[np.argmax(up * before[there, 1])]
            faces[body][k] = before[at, 0], now[at, 0] - before[at, 0]
    low, high = (np.array(list(faces[body].values())) for body in ("low", "high"))
    return (low[:, 0] + high[:, 0]) / 2, high[:, 1] - low[:, 1]


def stuck_width(x, slip, half_width):
    """c / b that fits the slips best."""
    x, inside = np.abs(x), np.abs(x) < half_width

    def misfit(c):
        far = np.maximum(x / c, 1)
        return np.var((slip - FRICTION / RADIUS * c**2 * (far * np.sqrt(far**2 - 1) - np.arccosh(far)))[inside])
    return min(np.linspace(0.05, 1, 400), key=lambda ratio: misfit(ratio * half_width))


def check(runs):
    hertz = 1.0395 * 4 / 3 * STIFFNESS * np.sqrt(RADIUS) * 0.001125**1.5
    force = {name: np.abs(runs[name].history[column][-10:].mean())
             for name, column in (("plane", "plate_force_y"), ("balls", "low_high_force_y"), ("cylinders", "low_high_force_y"))}
    yield Row("force of a ball on a rigid plate, 6 cells (N)", force["plane"], hertz, 0.05 * hertz, "Hertz, finite elements", shortfall=EARLY, bound=0.1 * hertz)
    yield Row("force of two balls, 6 cells (N)", force["balls"], hertz, 0.05 * hertz, "Hertz, finite elements")
    load = cylinders(0.015)[0] / 2
    yield Row("force of two half cylinders, 6 cells (N/m)", force["cylinders"], load, 0.05 * load, "Hertz, Johnson")
    run = runs["slip"]
    for time, name in ((0.055, "0.30"), (0.06, "0.52"), (0.065, "0.73"), (0.07, "0.90")):
        normal, shear = forces_at(run, time)
        half_width = np.sqrt(4 * normal * RADIUS / (np.pi * STIFFNESS))
        exact = np.sqrt(1 - shear / (FRICTION * normal))
        stuck = stuck_width(*slip_of_faces(run, time, half_width), half_width)
        yield Row(f"stuck part of the contact of cylinders, c / b, at Q / (mu P) = {name}", stuck, exact, 0.06 * exact, "Cattaneo, Mindlin")
