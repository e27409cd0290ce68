"""Bodies in space, drawn by PyVista without a display. Needs matplotlib, numpy, scipy and PyVista."""

from __future__ import annotations

import ctypes.util
import importlib.util
import os
from typing import Any

import numpy as np
from matplotlib.colors import LightSource

from soil_mpm.ground.raster import read_ascii
from soil_mpm.plot.camera import camera_of, frame_of
from soil_mpm.plot.fields import NothingToDraw, colours_of

GREYS = {"body": "#d9d4c7", "rigid": "#8a9097", "force": "#c1121f"}
TERRAIN_ROOM = 0.1  # beside the bodies, over the longest side of their box
LONGEST = 0.12  # of an arrow, over the diagonal of what is seen
EGL = "vtkEGLRenderWindow"
LEAST_VTK = 9, 4  # that can choose this window when it runs


def with_pyvista() -> Any:
    """PyVista, ready to draw without a display; NothingToDraw where it is missing."""
    if importlib.util.find_spec("pyvista") is None or importlib.util.find_spec("scipy") is None:
        raise NothingToDraw("--view: PyVista or SciPy is missing; takes pip install \"soil-mpm[3d]\", or pip install pyvista scipy")
    if ctypes.util.find_library("EGL"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", EGL)
    elif not os.environ.get("DISPLAY"):
        raise NothingToDraw("--view: there is neither EGL nor a display; takes apt install libegl1 libgl1-mesa-dri")
    import pyvista
    if pyvista.vtk_version_info < LEAST_VTK and not os.environ.get("DISPLAY"):
        raise NothingToDraw(f"--view: VTK {'.'.join(map(str, pyvista.vtk_version_info))} cannot draw without a display; takes VTK 9.4")
    return pyvista


def can_draw() -> bool:
    """Whether there is all that a picture of bodies in space takes."""
    try:
        with_pyvista()
    except NothingToDraw:
        return False
    return True


def add_bodies(plotter, scene, view, name, limits):
    """The bodies, coloured by a field where they have it, and the rigid bodies."""
    light = {"ambient": 0.55, "diffuse": 0.5, "specular": 0.0}
    colours = {"scalars": "value", "cmap": colours_of(name, scene.field(name)), "clim": limits, "show_scalar_bar": False}
    for body in scene.bodies:
        values = scene.values_of(body, name)
        mesh = getattr(scene, view.style)(body, values)
        if not mesh.n_points:
            continue
        look = {"color": GREYS["body"]} if values is None else colours
        size = {"style": "points", "point_size": max(scene.size(body) / scene.pixel, 1.5)} if view.style == "points" else {}
        plotter.add_mesh(mesh, **look, **light, **size, smooth_shading=view.style == "surface")
    for rigid in scene.rigids():
        mesh = scene.solid(rigid)
        mesh = scene.cubes(rigid) if mesh is None and len(scene.groups[rigid]["position"]) else mesh
        if mesh is not None:
            plotter.add_mesh(mesh, color=GREYS["rigid"], **light, smooth_shading=True, split_sharp_edges=True, feature_angle=35)


class Terrain:
    """A terrain round a box, in the part that the mesh has: its heights z on a grid x, y [n, m], its shaded relief, and the box [2][3] of
    both, m."""

    def __init__(self, run, path, box):
        raster = read_ascii(path)
        room = max(TERRAIN_ROOM * np.max(np.subtract(box[1], box[0])[:2]), 1.5 * raster.cell)
        ends = [np.array(run.numbers(f"mesh_{end}")) for end in ("lower", "upper")]
        lower, upper = np.maximum(box[0] - room, ends[0]), np.minimum(box[1] + room, ends[1])
        axes = [places[(places >= low) & (places <= high)] for places, low, high in zip(raster.centres(), lower, upper)]
        if min(map(len, axes)) < 2:
            raise NothingToDraw(f"--terrain: {path} has no point in the mesh near the bodies")
        self.x, self.y = np.meshgrid(*axes, indexing="ij")
        self.z = raster.at(self.x, self.y)
        self.relief = LightSource(azdeg=315, altdeg=45).hillshade(self.z.T, dx=raster.cell, dy=-raster.cell, vert_exag=1.5).T
        seen = np.array([[end(each) for each in (self.x, self.y, self.z)] for end in (np.nanmin, np.nanmax)])
        self.box = np.minimum(box[0], seen[0]), np.maximum(box[1], seen[1])

    def add_to(self, plotter, half=None):
        """Draws it, of which a plane may leave a half."""
        from soil_mpm.plot.solids import keep_side, sheet
        mesh = sheet(self.x, self.y, self.z, relief=self.relief)
        mesh = mesh if half is None else keep_side(mesh, *half)
        if mesh.n_points:
            plotter.add_mesh(mesh, scalars="relief", cmap="gray", clim=(-0.8, 1.1), lighting=False, show_scalar_bar=False)


def add_forces(plotter, pyvista, scene, longest, length):
    """Contact forces as arrows from the nodes where they act; `longest` [N] has the length `length` [m]."""
    for pair, contact in scene.contacts.items():
        cloud = pyvista.PolyData(contact["position"]) if len(contact["position"]) else None
        if cloud is None or not contact["contact_force"].any():
            continue
        cloud["force"] = contact["contact_force"]
        cloud["size"] = np.linalg.norm(contact["contact_force"], axis=1)
        arrows = cloud.glyph(orient="force", scale="size", factor=length / longest, geom=pyvista.Arrow(shaft_resolution=8, tip_resolution=12))
        plotter.add_mesh(arrows, color=GREYS["force"], ambient=0.5, diffuse=0.5, specular=0.0)


def pixels_of(scene, view, name, limits, box, size, terrain=None, longest=0.0):
    """Pixels [height, width, 3] of a scene in a picture of some (width, height), and what is seen of space there: (left, right, lower,
    upper) about the middle of the box, m."""
    pyvista = with_pyvista()
    camera = camera_of(*view.camera)
    middle, half = frame_of(camera, box, size[0] / size[1])
    scene.pixel = 2 * half[1] / size[1]
    plotter = pyvista.Plotter(off_screen=True, window_size=size, border=False)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    add_bodies(plotter, scene, view, name, limits)
    if terrain:
        terrain.add_to(plotter, scene.half)
    diagonal = np.linalg.norm(np.subtract(*box))
    if longest:
        add_forces(plotter, pyvista, scene, longest, LONGEST * diagonal)
    plotter.enable_parallel_projection()
    plotter.camera_position = [tuple(middle + 3 * diagonal * camera.towards), tuple(middle), tuple(camera.up)]
    plotter.camera.parallel_scale = half[1]
    plotter.reset_camera_clipping_range()
    pixels = plotter.screenshot(return_img=True)
    plotter.close()
    return pixels, (-half[0], half[0], -half[1], half[1])
