"""All pictures that the results of a run have data for: scripts/plot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

from soil_mpm.ground.raster import WrongRaster
from soil_mpm.plot.contacts import draw_contacts
from soil_mpm.plot.curves import draw_curves, draw_runout
from soil_mpm.plot.fields import NothingToDraw, draw_field, draw_velocity
from soil_mpm.plot.probes import draw_probes, draw_rasters
from soil_mpm.plot.profiles import draw_line


@dataclass
class Wishes:
    """What pictures show. time [s]: of the frame, and a mark in curves; None: the last one. fields: of field.png and the film. cut: the
    plane seen in 3D (plot.fields.Slice). factor: forces over su times the area too. line: two points [2, dim] in m, along which fields
    are drawn in place of all else. terrain: an ESRI ASCII grid under the rasters, and in space. film: film.gif of all frames. view: how bodies
    in space are seen (plot.view.View), in place of all else."""
    time: float | None = None
    fields: Sequence[str] = ()
    cut: Any = None
    factor: bool = False
    line: Any = None
    terrain: str | None = None
    film: bool = False
    view: Any = None

    def is_plain(self) -> bool:
        """Whether nothing is asked for that may be missing."""
        return not (self.fields or self.cut or self.film or self.terrain or self.view or self.line is not None)


def is_element(folder: Path) -> bool:
    """Whether a folder holds the output of a single material point."""
    return (folder / "element.csv").exists() and not (folder / "history.csv").exists()


def draw_element(folder: Path) -> list[Path]:
    from soil_mpm.element.figures import draw_path
    return [draw_path(folder)]


def draw_in_space(run: Any, wishes: Wishes) -> list[Path]:
    """view.png, and its film where one is asked for."""
    from soil_mpm.plot.view import draw_view, draw_view_film
    paths = [draw_view(run, wishes.view, wishes.fields, wishes.time, wishes.cut, wishes.terrain)]
    return paths + (draw_view_film(run, wishes.view, wishes.fields, wishes.time, wishes.cut, wishes.terrain) if wishes.film else [])


def draw_all(run: Any, others: list[Any], wishes: Wishes) -> tuple[list[Path], list[str]]:
    """Draws one kind of picture after the other: paths, and lines about pictures without data. others: runs in the same curves."""
    kinds = [lambda: draw_curves(run, others, wishes.factor, wishes.time),
             lambda: draw_runout(run, others, wishes.time),
             lambda: draw_velocity(run, wishes.time, wishes.cut),
             lambda: draw_probes(run, others, wishes.time),
             lambda: draw_rasters(run, wishes.terrain),
             lambda: draw_contacts(run, wishes.time),
             lambda: draw_field(run, wishes.fields, wishes.time, wishes.cut)]
    if wishes.line is not None:
        kinds = [lambda: draw_line(run, wishes.line, wishes.fields, wishes.time)]
    if wishes.view is not None:
        kinds = [lambda: draw_in_space(run, wishes)]
    elif wishes.film:
        from soil_mpm.plot.film import draw_film
        kinds.append(lambda: draw_film(run, wishes.fields, wishes.time, wishes.cut))
    paths: list[Path] = []
    missing: list[str] = []
    for kind in kinds:
        try:
            made = kind()
            paths += made if isinstance(made, list) else [made] if made else []
        except (NothingToDraw, WrongRaster, OSError) as nothing:
            missing.append(str(nothing))
    return paths, list(dict.fromkeys(missing))  # each line once
