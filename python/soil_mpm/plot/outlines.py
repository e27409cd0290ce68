"""Outlines of rigid bodies from the options of a run: the section of a shape with the plane that is seen. Needs numpy."""

from pathlib import Path

import numpy as np

from soil_mpm.ground.raster import WrongRaster, read_ascii

CIRCLE = 180  # corners of a circle
LINE = 400    # corners of a layer along the plane


def outline(run, name, plane=(0, 1), at=None):
    """Corners [N, 2] of a rigid's shape at the start, in m, in the part that the mesh holds; in 3D of its section with the plane
    of two axes that cuts the third one at a place [m]. None where options do not give it: stl, files that are not there."""
    three = run.text("dim", "2") == "3"
    if run.words(f"{name}_cut_out"):
        return None
    try:
        corners = (section if three else shape_in_plane)(run, name, *([tuple(plane), at] if three else []))
    except (IndexError, KeyError, ValueError, WrongRaster, OSError):
        return None
    return None if corners is None or len(corners) < 3 else in_mesh(run, np.asarray(corners, dtype=float), plane)


def in_mesh(run, corners, plane):
    """The part of a polygon that lies in the mesh, None where there is none."""
    for axis, place in enumerate(plane):
        for end, sign in (("lower", 1), ("upper", -1)):
            limits = run.numbers(f"mesh_{end}")
            if len(limits) > place:
                corners = cut_by_line(corners, sign * np.eye(2)[axis], sign * limits[place])
    return corners if len(corners) > 2 else None


def cut_by_line(corners, normal, offset):
    """The part of a polygon where normal . x >= offset (Sutherland & Hodgman 1974)."""
    kept = []
    for here, there in zip(corners, np.roll(corners, -1, axis=0)):
        inside, beyond = here @ normal - offset, there @ normal - offset
        if inside >= 0:
            kept.append(here)
        if (inside < 0) != (beyond < 0):
            kept.append(here + (there - here) * inside / (inside - beyond))
    return np.array(kept).reshape(-1, 2)


def pairs(numbers, size=2):
    return np.array(numbers).reshape(-1, size)


# ---------------------------------------------------------------------------------------------- 2D


def shape_in_plane(run, name):
    shape = run.text(f"{name}_shape", "box")
    if shape == "box":
        return turned_box(run, name, (0, 1))
    if shape == "polygon":
        return pairs(run.numbers(f"{name}_polygon"))
    if shape == "disc":
        return circle(run.numbers(f"{name}_centre"), run.number(f"{name}_radius"))
    if shape == "half_plane":
        return behind_plane(run, run.numbers(f"{name}_point"), run.numbers(f"{name}_normal"), (0, 1))
    if shape == "layer":
        return layer(run, name, 0, lambda x: (x,))
    return None


def circle(centre, radius):
    turn = np.linspace(0, 2 * np.pi, CIRCLE, endpoint=False)
    return np.column_stack([centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)])


def turned_box(run, name, plane):
    """A box whose corners may be round, turned about its lower corner."""
    lower, upper = (np.array(run.numbers(f"{name}_{end}"))[list(plane)] for end in ("lower", "upper"))
    fillet, angle = run.number(f"{name}_fillet"), np.radians(run.number(f"{name}_angle_deg"))
    corners = []
    for k, corner in enumerate([lower, [upper[0], lower[1]], upper, [lower[0], upper[1]]]):
        middle = np.clip(corner, lower + fillet, upper - fillet)
        turn = np.pi * (1 + k / 2) + np.linspace(0, np.pi / 2, 12 if fillet else 1)
        corners += list(middle + fillet * np.column_stack([np.cos(turn), np.sin(turn)]) if fillet else [corner])
    along = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return lower + (np.array(corners) - lower) @ along


def mesh_rectangle(run, plane):
    (left, low), (right, high) = (np.array(run.numbers(f"mesh_{end}"))[list(plane)] for end in ("lower", "upper"))
    return np.array([[left, low], [right, low], [right, high], [left, high]])


def behind_plane(run, point, normal, plane, beyond=0.0):
    """The part of the mesh behind a plane; `beyond` is how far the plane that is seen lies before its point, times the normal."""
    direction = np.array(normal)[list(plane)]
    offset = np.array(point)[list(plane)] @ direction - beyond
    return cut_by_line(mesh_rectangle(run, plane), -direction, -offset)


# ---------------------------------------------------------------------------------------------- layers


def layer(run, name, axis, place):
    """A layer along an axis of the mesh; place(x) are the horizontal coordinates at x [m]."""
    x = np.linspace(run.numbers("mesh_lower")[axis], run.numbers("mesh_upper")[axis], LINE)
    bends = [point for end in ("top", "base") for point in bends_of(run, name, end)]
    x = np.unique(np.concatenate([x, [bend for bend in bends if axis == 0 and x[0] < bend < x[-1]]]))
    top, base = (surface(run, name, end)(*place(x)) + 0 * x for end in ("top", "base"))
    return np.concatenate([np.column_stack([x, base]), np.column_stack([x, top])[::-1]])


def bends_of(run, name, end):
    """Where the polyline of a surface bends, m along x."""
    words = run.words(f"{name}_{end}")
    if len(words) == 1 and words[0] in run.words("bodies") + run.words("rigid_bodies"):
        return bends_of(run, words[0], "base" if end == "top" else "top")
    return run.numbers(f"{name}_{end}")[::2] if len(words) > 1 else []


def surface(run, name, end):
    """The height [m] of a layer's top or base at the horizontal coordinates [m], as a function."""
    words = run.words(f"{name}_{end}")
    if len(words) > 1:
        line = pairs(run.numbers(f"{name}_{end}"))
        return lambda x, y=0.0: np.interp(x, *line.T)
    if words[0] in run.words("bodies") + run.words("rigid_bodies"):
        return surface(run, words[0], "base" if end == "top" else "top")
    if Path(words[0]).is_file():
        return read_ascii(words[0]).at
    level = float(words[0])
    return lambda x, y=0.0: level


# ---------------------------------------------------------------------------------------------- sections in 3D


def section(run, name, plane, at):
    """The section with the plane of two axes at a place of the third, None where there is none or it is not known."""
    across = 3 - sum(plane)
    shape = run.text(f"{name}_shape", "box")
    if shape == "box":
        return section_of_box(run, name, plane, across, at)
    if shape == "polygon":
        low, high = run.numbers(f"{name}_width")
        return pairs(run.numbers(f"{name}_polygon")) if across == 1 and low <= at <= high else None
    if shape == "ball":
        centre = np.array(run.numbers(f"{name}_centre"))
        square = run.number(f"{name}_radius") ** 2 - (at - centre[across]) ** 2
        return circle(centre[list(plane)], np.sqrt(square)) if square > 0 else None
    if shape in ("cylinder", "cone"):
        return section_of_revolved(run, name, plane, across, at)
    if shape == "half_plane":
        point, normal = run.numbers(f"{name}_point"), run.numbers(f"{name}_normal")
        return behind_plane(run, point, normal, plane, (at - point[across]) * normal[across])
    if shape == "layer" and across != 2:
        return layer(run, name, plane[0], (lambda x: (x, at + 0 * x)) if across == 1 else (lambda y: (at + 0 * y, y)))
    return None


def section_of_box(run, name, plane, across, at):
    """Section of a box without fillet, which may be turned about y where the plane is normal to y."""
    low, high = run.numbers(f"{name}_lower")[across], run.numbers(f"{name}_upper")[across]
    turned = run.number(f"{name}_angle_deg") != 0 and across != 1
    return None if turned or run.number(f"{name}_fillet") or not low <= at <= high else turned_box(run, name, plane)


def section_of_revolved(run, name, plane, across, at):
    """Section of an upright cylinder or cone: the half width at each height."""
    centre, height, radius = np.array(run.numbers(f"{name}_centre")), *radius_over_height(run, name)
    if across == 2:
        here = np.interp(at, centre[2] + height, radius, 0, 0)
        return circle(centre[:2], here) if here > 0 else None
    z = np.unique(np.concatenate([height, np.linspace(height[0], height[-1], LINE)]))
    square = np.interp(z, height, radius) ** 2 - (at - centre[across]) ** 2
    z, half = z[square >= 0], np.sqrt(square[square >= 0])
    middle = centre[plane[0]]
    return np.concatenate([np.column_stack([middle - half, centre[2] + z]), np.column_stack([middle + half, centre[2] + z])[::-1]])


def radius_over_height(run, name):
    """Heights over the centre, from below up, and the radius there, m."""
    radius, slope = run.number(f"{name}_radius"), np.tan(np.radians(run.number(f"{name}_tip_angle_deg", 180)) / 2)
    if run.text(f"{name}_shape") == "cylinder":
        tip = radius / slope
        return (np.array([0, tip, run.number(f"{name}_height")]), np.array([0, radius, radius])) if tip > 1e-9 * radius else (
            np.array([0, run.number(f"{name}_height")]), np.array([radius, radius]))
    height = run.number(f"{name}_height") or radius / slope
    return (np.array([0, height]), np.array([0, radius])) if run.text(f"{name}_tip", "down") == "down" else (
        np.array([-height, 0]), np.array([radius, 0]))
