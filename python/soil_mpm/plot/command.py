"""The command that draws the results of a run: scripts/plot and `soil-mpm plot`."""

from __future__ import annotations

import argparse
import pathlib
import sys
from typing import Sequence

from soil_mpm.plot.camera import parse_camera
from soil_mpm.plot.fields import parse_slice
from soil_mpm.plot.pictures import Wishes, draw_all, draw_element, is_element
from soil_mpm.plot.profiles import parse_line
from soil_mpm.plot.view import STYLES, View
from soil_mpm.results import Run


def slice_of(text):
    try:
        return parse_slice(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"given \"{text}\", takes auto, x, y or z, or a place in m, as y=0.5") from None


def line_of(text):
    try:
        return parse_line(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"given \"{text}\", takes two points in m, as 0,1:5,1") from None


def camera(text):
    try:
        return parse_camera(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"given \"{text}\", takes iso, x, y, z, or azimuth and elevation in degrees, as 240,30") from None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="OUTPUT_DIR")
    parser.add_argument("--compare", nargs="+", default=[], metavar="OTHER_DIR", help="runs to draw in the same curves")
    parser.add_argument("--time", type=float, metavar="SECONDS",
                        help="of the frame in field.png and velocity.png, and a mark in the curves; the end of the film")
    parser.add_argument("--field", type=lambda text: text.split(","), default=[], metavar="NAME,...",
                        help="fields of field.png and the film: a dataset of the frames, or grid_velocity, velocity_x, pressure, "
                        "mises, stress_xx and so on")
    parser.add_argument("--slice", type=slice_of, metavar="PLACE",
                        help="in 3D: the plane that is seen, as y=0.5, z or auto: through the moving rigid, else the bodies; with --view, "
                        "all between it and the camera is left out")
    parser.add_argument("--factor", action="store_true",
                        help="the force over su times the area too, where a rigid is pushed along an axis into any clay")
    parser.add_argument("--profile", type=line_of, metavar="X,Y:X,Y",
                        help="fields (--field) along a line between two points, at --time or at five times of the run")
    parser.add_argument("--terrain", metavar="TERRAIN.asc",
                        help="an ESRI ASCII grid in the coordinates of the mesh, under the rasters, or with --view in space")
    parser.add_argument("--film", action="store_true", help="film.gif and, with ffmpeg, film.mp4 of all frames")
    space = parser.add_argument_group("bodies in space, view.png, in place of all else (3D; takes pip install \"soil-mpm[3d]\")")
    space.add_argument("--view", type=camera, metavar="CAMERA", help="seen from iso, x, y, z, or AZIMUTH,ELEVATION in degrees: 0,0 is x, 270,0 is y")
    space.add_argument("--style", choices=STYLES, help="of the particles: cubes of their size (default), points, or the surface round them")
    space.add_argument("--bodies", type=lambda text: text.split(","), metavar="NAME,...",
                       help="bodies and rigid bodies that are seen, by default all")
    space.add_argument("--forces", action="store_true", help="contact forces of bodies in pairs, as arrows")


def view_of(arguments):
    """The View of the words, None without --view."""
    if arguments.view is None:
        return None
    return View(arguments.view, arguments.style or STYLES[0], arguments.bodies or [], arguments.forces)


def wants_view(arguments):
    """The line for the user where an option of --view has nothing to act on; empty where all is well."""
    given = [name for name in ("style", "bodies", "forces") if getattr(arguments, name)]
    return f"--{given[0]}: has a place only with --view" if given and arguments.view is None else ""


def draw(arguments: argparse.Namespace) -> int:
    """Draws, and prints the paths; the exit status."""
    if wants_view(arguments):
        print(f"plot: {wants_view(arguments)}", file=sys.stderr)
        return 2
    wishes = Wishes(arguments.time, arguments.field, arguments.slice, arguments.factor, arguments.profile, arguments.terrain, arguments.film,
                    view_of(arguments))
    if is_element(pathlib.Path(arguments.folder)):
        paths, missing = draw_element(pathlib.Path(arguments.folder)), []
    else:
        paths, missing = draw_all(Run(arguments.folder), [Run(folder) for folder in arguments.compare], wishes)
    for path in paths:
        print(path)
    for line in missing:
        print(f"plot: {line}", file=sys.stderr)
    return 0 if paths and (wishes.is_plain() or not missing) else 1


def main(description: str, words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    return draw(parser.parse_args(words))
