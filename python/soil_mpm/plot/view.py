"""Pictures of runs in 3D as one sees bodies in space: view.png and its film. Needs matplotlib, scipy and PyVista, but no display."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Sequence

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.cm import ScalarMappable
from PIL import Image

from soil_mpm.ground.raster import WrongRaster
from soil_mpm.plot.camera import NAMED, axis_lines, camera_of, parse_camera
from soil_mpm.plot.fields import NothingToDraw, colours_of, default_fields, parse_slice
from soil_mpm.plot.film import common_view, frames_of, scenes_of, write_film
from soil_mpm.plot.render import GREYS, Terrain, pixels_of, with_pyvista
from soil_mpm.problems import Problem
from soil_mpm.units import scale

STYLES = "cubes", "points", "surface"
WIDTH, HEIGHT, DPI = 1920, 1080, 100  # of a slide, pixels
FILM = 1280, 720
FONT = 24.0


@dataclass
class View:
    """How bodies in space are seen. camera: azimuth and elevation, degrees. style: of particles, one of STYLES. names: bodies and rigid
    bodies that are seen, by default all. forces: arrows of contact forces."""
    camera: tuple[float, float] = (-60.0, 30.0)
    style: str = "cubes"
    names: Sequence[str] = field(default_factory=list)
    forces: bool = False


# ---------------------------------------------------------------------------------------------- the page round it


def rectangles(count):
    """[left, bottom, width, height] of panels in a figure, in parts of it."""
    columns = int(np.ceil(np.sqrt(count)))
    rows = -(-count // columns)
    return [[(k % columns) / columns, 1 - (k // columns + 1) / rows, 1 / columns, 1 / rows] for k in range(count)]


def number(value, diagonal):
    """A coordinate [m] in as many digits as a picture shows."""
    digits = max(0, int(np.ceil(2.5 - np.log10(diagonal))))
    return f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{round(value)}"


def label_axes(axes, view, box, font):
    """Coordinates at the ends of three edges of the box, and their names between them."""
    camera = camera_of(*view.camera)
    middle, diagonal = (np.asarray(box[0]) + box[1]) / 2, np.linalg.norm(np.subtract(*box))
    for axis, low, high in axis_lines(camera, box):
        ends = camera.on_screen([low - middle, high - middle])
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        out = np.array([-along[1], along[0]])
        out = out if out @ ends.mean(axis=0) > 0 else -out
        side = "right" if out[0] < -0.5 else "left" if out[0] > 0.5 else "center"
        axes.plot(*ends.T, color="0.35", lw=1.5)
        for place, text, inward in ((ends[0], number(low[axis], diagonal), 1), (ends.mean(axis=0), f"{'xyz'[axis]} (m)", 0),
                                    (ends[1], number(high[axis], diagonal), -1)):
            way = font * ((0.35 if side != "center" else 0.8) * out + 0.6 * inward * along)
            axes.annotate(text, place, xytext=way, textcoords="offset points", ha=side, va="center", fontsize=0.8 * font)


def page(scene, view, names, limits, box, terrain=None, longest=0.0):
    """A figure of the size of a slide: a panel for each field, with its legend."""
    figure = plt.figure(figsize=(WIDTH / DPI, HEIGHT / DPI), dpi=DPI)
    panels = rectangles(len(names))
    font = FONT * max(panels[0][2] ** 0.5, 0.6)
    for name, (left, bottom, width, height) in zip(names, panels):
        title, bar = 2.6 * font / 72 * DPI / HEIGHT, 6.0 * font / 72 * DPI / WIDTH
        place = [left + 0.005, bottom + 0.01, width - bar - 0.005, height - title - 0.01]
        size = round(place[2] * WIDTH), round(place[3] * HEIGHT)
        pixels, seen = pixels_of(scene, view, name, limits[name], box, size, terrain, longest)
        axes = figure.add_axes(place)
        axes.imshow(pixels, extent=seen, interpolation="none", aspect="auto")
        axes.axis("off")
        label_axes(axes, view, box, font)
        axes.set(xlim=seen[:2], ylim=seen[2:])
        field_, values = scene.field(name), scene.values(name)
        figure.text(left + 0.02, bottom + height - title / 2, f"{field_.title}, {scene.where}", fontsize=font, va="center")
        beyond = ["neither", "min", "max", "both"][(values.min() < limits[name][0]) + 2 * (values.max() > limits[name][1])]
        legend = figure.add_axes([place[0] + place[2] + 0.004, place[1] + 0.12 * height, 0.22 * bar, place[3] - 0.2 * height])
        colours = ScalarMappable(Normalize(*limits[name]), colours_of(name, field_))
        figure.colorbar(colours, cax=legend, extend=beyond).ax.tick_params(labelsize=0.8 * font)
        if longest:
            unit, by = scale(np.array([longest]), "N")
            figure.text(left + 0.02, bottom + 0.02, f"arrows: contact force, the longest {longest / by:.3g} {unit}", fontsize=0.8 * font,
                        color=GREYS["force"])
    return figure


def largest_force(frames):
    """The largest contact force at a node in some frames, N; 0 where there is none."""
    largest = 0.0
    for path in frames:
        with h5py.File(path) as file:
            for group in file.values():
                if "contact_force" in group and len(group["contact_force"]):
                    largest = max(largest, float(np.linalg.norm(group["contact_force"][()], axis=1).max()))
    return largest


def forces_of(view, frames):
    """The largest contact force of the frames [N] where arrows are asked for; NothingToDraw where there is none."""
    if not view.forces:
        return 0.0
    largest = largest_force(frames)
    if not largest:
        raise NothingToDraw("--forces: the frames have no contact force of deformable bodies in pairs (-contact_pairs)")
    return largest


def scene_of(run, frame, view, cut):
    with_pyvista()
    from soil_mpm.plot.space import SpaceScene
    return SpaceScene(run, frame, cut, camera_of(*view.camera).towards, view.names)


def around(run, box, path):
    """A box with the terrain of a file round it, and this Terrain; None without a file."""
    ground = Terrain(run, path, box) if path else None
    return ground.box if ground else box, ground


def draw_view(run, view, fields=(), time=None, cut=None, terrain=None, to=None):
    """view.png: bodies in space in the last frame, or the one nearest to a time [s], coloured by the first of the usual fields, or a panel
    for each of some. Returns its path."""
    frame = run.frame if time is None else run.frame_near(time)
    if frame is None:
        raise NothingToDraw(f"--view: {run.folder}/frames holds no frame")
    scene = scene_of(run, frame, view, cut)
    names = list(fields) or default_fields(scene)[:1]
    limits = {name: scene.limits(name) for name in names}
    box, ground = around(run, scene.box(), terrain)
    figure = page(scene, view, names, limits, box, ground, forces_of(view, [frame]))
    path = to or run.folder / "view.png"
    figure.savefig(path, dpi=DPI)
    plt.close(figure)
    return path


def draw_view_film(run, view, fields=(), until=None, cut=None, terrain=None):
    """film.gif and film.mp4 of draw_view's picture over all frames, or those up to a time [s], with one camera and one scale of colours and
    arrows. Returns the paths of those made."""
    frames, make = frames_of(run, until), lambda frame: scene_of(run, frame, view, cut)
    if not frames:
        raise NothingToDraw(f"--film: {run.folder}/frames holds no frame to show")
    names = list(fields) or default_fields(make(frames[-1]))[:1]
    names, box, limits = common_view(scenes_of(frames, make, report=True), names)
    if box is None:
        raise NothingToDraw(f"--film: {run.folder}/frames holds no frame to show")
    box, ground = around(run, box, terrain)
    longest, pictures = forces_of(view, frames), []
    for scene in scenes_of(frames, make):
        figure = page(scene, view, names, limits, box, ground, longest)
        figure.canvas.draw()
        pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
        plt.close(figure)
        pictures.append(Image.fromarray(pixels).resize(FILM).quantize(255))
    return write_film(run.folder, pictures)


def picture(run: Any, fields: Sequence[str] | str = (), time: float | None = None, to: Path | str | None = None,
            camera: str | tuple[float, float] = "iso", cut: str | None = None, style: str = "cubes", bodies: Sequence[str] = (), forces: bool = False,
            terrain: Path | str | None = None) -> Path:
    """draw_view with the words of the command: camera "iso", "x", "y", "z" or azimuth and elevation in degrees; cut "y=0.5", "y" or "auto".
    Problem where there is nothing to draw."""
    try:
        seen = parse_camera(camera) if isinstance(camera, str) else tuple(camera)
    except ValueError:
        raise Problem(f"camera: given {camera!r}, takes {', '.join(NAMED)}, or azimuth and elevation in degrees") from None
    if style not in STYLES:
        raise Problem(f"style: given {style!r}, takes {', '.join(STYLES)}")
    try:
        plane = None if cut is None else parse_slice(cut)
    except ValueError:
        raise Problem(f"cut: given {cut!r}, takes auto, x, y or z, or a place in m, as y=0.5") from None
    try:
        view = View(seen, style, [bodies] if isinstance(bodies, str) else bodies, forces)
        return draw_view(run, view, [fields] if isinstance(fields, str) else fields, time, plane, terrain, None if to is None else Path(to))
    except (NothingToDraw, WrongRaster, OSError) as nothing:
        raise Problem(str(nothing)) from None
