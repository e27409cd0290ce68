"""Rigid bodies as surfaces in space, from the options of a run and from its history. Needs numpy, scipy and PyVista."""

import copy
import csv
from pathlib import Path

import numpy as np
import pyvista
from scipy.spatial.transform import Rotation, Slerp
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

from soil_mpm.ground.raster import WrongRaster
from soil_mpm.plot.outlines import CIRCLE, pairs, radius_over_height, surface, turned_box

ROUND = CIRCLE // 2  # corners of a circle
MOST_CELLS = 400     # of a layer along an axis


def with_table(run):
    """A run that has the rows of -rigid_bodies_file among its options."""
    path = Path(run.text("rigid_bodies_file"))
    if not run.text("rigid_bodies_file") or not path.is_file():
        return run
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    found = {f"{row['name']}_{key}": text.strip().replace(" ", ",") for row in rows for key, text in row.items() if key != "name" and text}
    whole = copy.copy(run)
    whole.options = {**found, **run.options}
    return whole


def solid(run, name):
    """Surface of a rigid body at the start, in the part that the mesh holds, with all its parts; None where options do not give it: a
    surface of triangles, a part cut out, files that are not there."""
    if run.words(f"{name}_cut_out"):
        return None
    try:
        parts = [shape_of(run, part) for part in run.words(f"{name}_parts") or [name]]
    except (IndexError, KeyError, ValueError, WrongRaster, OSError):
        return None
    if any(part is None for part in parts):
        return None
    parts = [part for part in (in_mesh(run, part) for part in parts) if part.n_points]
    return pyvista.merge(parts) if len(parts) > 1 else parts[0] if parts else None


def in_mesh(run, mesh):
    """The part of a closed surface that lies in the mesh, closed too."""
    for axis in range(3):
        for end, sign in (("lower", 1), ("upper", -1)):
            limit = run.numbers(f"mesh_{end}")[axis]
            if mesh.n_points and (sign * (mesh.points[:, axis] - limit)).min() < 0:
                mesh = keep_side(mesh, sign * np.eye(3)[axis], limit * np.eye(3)[axis])
    return mesh


def keep_side(mesh, normal, point):
    """The part of a surface where normal . (x - point) >= 0; closed where it was closed."""
    beyond = (mesh.points - point) @ np.asarray(normal, dtype=float)
    if beyond.min(initial=0.0) >= 0:
        return mesh
    if beyond.max(initial=0.0) <= 0:
        return pyvista.PolyData()
    mesh = mesh.triangulate()
    if mesh.is_manifold:
        return mesh.clip_closed_surface(normal=normal, origin=point)
    return mesh.clip(normal=normal, origin=point, invert=False)


# ---------------------------------------------------------------------------------------------- shapes


def shape_of(run, name):
    shape = run.text(f"{name}_shape", "box")
    if shape == "box" and not run.number(f"{name}_fillet"):
        return extruded(turned_box(run, name, (0, 2)), *(run.numbers(f"{name}_{end}")[1] for end in ("lower", "upper")))
    if shape == "polygon":
        return extruded(pairs(run.numbers(f"{name}_polygon")), *run.numbers(f"{name}_width"))
    if shape == "ball":
        return pyvista.Sphere(radius=run.number(f"{name}_radius"), center=run.numbers(f"{name}_centre"), theta_resolution=ROUND // 2,
                              phi_resolution=ROUND // 3)
    if shape in ("cylinder", "cone"):
        return revolved(run.numbers(f"{name}_centre"), *radius_over_height(run, name))
    if shape == "half_plane":
        lower, upper = run.numbers("mesh_lower"), run.numbers("mesh_upper")
        whole = pyvista.Box(bounds=[end[d] for d in range(3) for end in (lower, upper)])
        return keep_side(whole, -np.array(run.numbers(f"{name}_normal")), run.numbers(f"{name}_point"))
    return layer(run, name) if shape == "layer" else None


def extruded(corners, low, high):
    """A polygon [N, 2] in x and z, from y = low to high, m."""
    flat = pyvista.PolyData(np.insert(np.asarray(corners, dtype=float), 1, low, axis=1), faces=[len(corners), *range(len(corners))])
    return flat.triangulate().extrude((0, high - low, 0), capping=True).clean().triangulate().compute_normals(split_vertices=False)


def revolved(centre, height, radius):
    """An upright body of revolution: radius [N] at some heights [N] over its centre, from below up, m."""
    turn = np.linspace(0, 2 * np.pi, ROUND, endpoint=False)
    rings = [np.column_stack([r * np.cos(turn), r * np.sin(turn), np.full(ROUND, z)]) for z, r in zip(height, radius)]
    here, there = np.arange(ROUND), np.roll(np.arange(ROUND), -1)
    faces = [np.column_stack([np.full(ROUND, 4), k + here, k + there, k + ROUND + there, k + ROUND + here])
             for k in range(0, ROUND * (len(rings) - 1), ROUND)]
    last = ROUND * (len(rings) - 1)
    caps = [[ROUND, *here[::-1]], [ROUND, *(last + here)]]
    mesh = pyvista.PolyData(np.concatenate(rings) + centre, faces=np.concatenate([*map(np.ravel, faces), *map(np.array, caps)]))
    return mesh.triangulate().clean()


def layer(run, name):
    """A layer between its base and its top; where a raster has no data, or the layer no thickness, its top alone."""
    (x0, y0), (x1, y1) = (run.numbers(f"mesh_{end}")[:2] for end in ("lower", "upper"))
    x, y = (np.linspace(low, high, int(min(max(np.ceil((high - low) / run.number("mesh_spacing")), 1), MOST_CELLS)) + 1)
            for low, high in ((x0, x1), (y0, y1)))
    x, y = np.meshgrid(x, y, indexing="ij")
    base, top = (surface(run, name, end)(x, y) + 0 * x for end in ("base", "top"))
    if (top > base).all():  # false where one has no data
        ends = [np.stack([each, each], axis=-1) for each in (x, y)]
        outside = vtkGeometryFilter()
        outside.SetInputData(pyvista.StructuredGrid(*ends, np.stack([base, top], axis=-1)))
        outside.Update()
        return pyvista.wrap(outside.GetOutput()).triangulate().clean()
    return sheet(x, y, np.where(base < top, top, np.nan))


def sheet(x, y, z, **data):
    """A surface z(x, y) on a grid [n, m], without the cells of which a corner is not finite; data: of its points [n, m]."""
    numbers = np.arange(x.size).reshape(x.shape)
    corners = np.stack([numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]], axis=-1).reshape(-1, 4)
    corners = corners[np.isfinite(z.ravel()[corners]).all(axis=1)]
    faces = np.insert(corners, 0, 4, axis=1).ravel()
    mesh = pyvista.PolyData(np.column_stack([x.ravel(), y.ravel(), np.nan_to_num(z.ravel())]), faces=faces)
    for name, values in data.items():
        mesh[name] = values.ravel()
    return mesh.clean()


# ---------------------------------------------------------------------------------------------- movement


def rotation_at(run, rigid, time):
    """Rotation of a rigid in 3D since the start, at a time [s]: rows of the history, with a constant angular velocity between them."""
    vectors = [run.history.get(f"{rigid}_angle_{axis}") for axis in "xyz"]
    if any(vector is None for vector in vectors):
        return Rotation.identity()
    times, first = np.unique(run.history["time"], return_index=True)
    turned = Rotation.from_rotvec(np.column_stack(vectors)[first])
    return Slerp(times, turned)(np.clip(time, times[0], times[-1])) if len(times) > 1 else turned[0]


def moved(run, rigid, mesh, centre, time):
    """A surface as the rigid has moved until a time [s]; centre: its centre of mass [3] now, m. None without history."""
    way = run.displacement(rigid, time)
    if way is None:
        return None
    given = run.numbers(f"{rigid}_centre_of_mass")
    centre = np.array(given) + way if given else np.asarray(centre)
    found = mesh.copy()
    found.points = centre + rotation_at(run, rigid, time).apply(np.asarray(mesh.points, dtype=float) + way - centre)
    return found


def fits(mesh, points, reach):
    """Whether a surface ends where the particles [N, 3] of its body end, within `reach` m."""
    bounds = np.array(mesh.bounds).reshape(3, 2).T
    return all(np.abs(end - at).max() <= reach for end, at in zip(bounds, (points.min(axis=0), points.max(axis=0))))
