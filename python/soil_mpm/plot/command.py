"""The command that draws the results of a run: scripts/plot and `soil-mpm plot`."""

from __future__ import annotations

import argparse
import pathlib
import sys
from typing import Sequence

from soil_mpm.plot.fields import parse_slice
from soil_mpm.plot.pictures import Wishes, draw_all, draw_element, is_element
from soil_mpm.plot.profiles import parse_line
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


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="OUTPUT_DIR")
    parser.add_argument("--compare", nargs="+", default=[], metavar="OTHER_DIR", help="runs to draw in the same curves")
    parser.add_argument("--time", type=float, metavar="SECONDS",
                        help="of the frame in field.png and velocity.png, and a mark in the curves; the end of the film")
    parser.add_argument("--field", type=lambda text: text.split(","), default=[], metavar="NAME,...",
                        help="fields of field.png and the film: a dataset of the frames, or grid_velocity, velocity_x, pressure, "
                        "mises, stress_xx and so on")
    parser.add_argument("--slice", type=slice_of, metavar="PLACE",
                        help="in 3D: the plane that is seen, as y=0.5, z or auto: through the moving rigid, else the bodies")
    parser.add_argument("--factor", action="store_true",
                        help="the force over su times the area too, where a rigid is pushed along an axis into any clay")
    parser.add_argument("--profile", type=line_of, metavar="X,Y:X,Y",
                        help="fields (--field) along a line between two points, at --time or at five times of the run")
    parser.add_argument("--terrain", metavar="TERRAIN.asc", help="an ESRI ASCII grid in the coordinates of the mesh, under the rasters")
    parser.add_argument("--film", action="store_true", help="film.gif and, with ffmpeg, film.mp4 of all frames")


def draw(arguments: argparse.Namespace) -> int:
    """Draws, and prints the paths; the exit status."""
    wishes = Wishes(arguments.time, arguments.field, arguments.slice, arguments.factor, arguments.profile, arguments.terrain, arguments.film)
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
