"""Results of a run as arrays, and values that follow from them: the bearing capacity of a footing. Needs numpy and h5py."""

from __future__ import annotations

import csv
import difflib
import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Sequence

import h5py
import numpy as np

from soil_mpm.problems import NoSuchResult
from soil_mpm.tree import CASES

if TYPE_CHECKING:
    from soil_mpm.frames import Frame

WINDOW = 0.01  # B, width of the windows over which Nc is averaged
MEAN_FROM, MEAN_TO = 0.03, 0.20  # B, range of the mean that is reported


class Run:
    """A run's output: options {name: text}, history {column: array [rows]}, and the paths of its frames and the last of
    them or None. Units are SI; docs/results.md has the columns and the fields."""

    def __init__(self, folder: Path | str):
        self.folder = Path(folder)
        self.options = read_options(self.folder)
        self.history = read_history(self.folder / "history.csv")
        self.frames = sorted(self.folder.glob("frames/frame_*.h5"))
        self.frame = self.frames[-1] if self.frames else None

    def __repr__(self) -> str:
        rows = len(next(iter(self.history.values()), ()))
        return f"<Run {self.folder}: {self.outcome or 'no outcome'}, {rows} rows, {len(self.frames)} frames>"

    def __getitem__(self, column: str) -> np.ndarray:
        """A column of the history [rows]."""
        if column not in self.history:
            near = difflib.get_close_matches(column, self.history, 1, 0)
            raise NoSuchResult(f"{self.folder}: no column {column}" + (f", the nearest is {near[0]}" if near else ""))
        return self.history[column]

    @property
    def dim(self) -> int:
        """2 or 3."""
        return int(self.text("dim", "2"))

    @property
    def outcome(self) -> str:
        """finished, stopped or failed; empty where the run did not get to say."""
        path = self.folder / "performance.json"
        return json.loads(path.read_text())["outcome"] if path.exists() else ""

    def table(self) -> Any:
        """The history as a data frame of pandas where pandas is there, else as a structured array of numpy; a column each."""
        try:
            import pandas
        except ImportError:
            return np.rec.fromarrays(list(self.history.values()), names=list(self.history)) if self.history else np.empty(0)
        return pandas.DataFrame(self.history)

    def frame_at(self, time: float | None = None, number: int | None = None) -> Frame:
        """The frame nearest to a time [s], or by its number (-1: the last, which it is by default)."""
        from soil_mpm.frames import Frame
        if not self.frames:
            raise NoSuchResult(f"{self.folder}: no frames; -output_frames off leaves them out")
        if time is not None:
            return Frame(self, self.frame_near(time) or self.frames[-1])
        try:
            return Frame(self, self.frames[-1 if number is None else number])
        except IndexError:
            raise NoSuchResult(f"{self.folder}: no frame {number}; there are {len(self.frames)}") from None

    def plot(self, others: Sequence[Run] = (), **how: Any) -> list[Path]:
        """Draws the pictures that the results have data for, as scripts/plot does, into the output folder; returns their paths. how:
        soil_mpm.plot.pictures.Wishes."""
        from soil_mpm.plot.pictures import Wishes, draw_all
        return draw_all(self, list(others), Wishes(**how))[0]

    def view(self, fields: Sequence[str] | str = (), time: float | None = None, **how: Any) -> Path:
        """Draws the bodies in space of a run in 3D, by default view.png in the output folder; returns its path. how:
        soil_mpm.plot.view.picture."""
        from soil_mpm.plot.view import picture
        return picture(self, fields, time, **how)

    def report(self, to: Path | str | None = None, pictures: bool = True) -> Path:
        """Writes one HTML file of the run (docs/report.md), by default report.html in the output folder; returns its path."""
        from soil_mpm.report import write
        return write(self.folder, to, pictures)

    def text(self, name: str, default: str = "") -> str:
        return self.options.get(name, default)

    def words(self, name: str) -> list[str]:
        return [word for word in self.text(name).split(",") if word]

    def numbers(self, name: str, default: Sequence[float] = ()) -> list[float]:
        return [float(word) for word in self.words(name)] or list(default)

    def number(self, name: str, default: float = 0.0) -> float:
        return self.numbers(name, [default])[0]

    def columns(self, name: str) -> np.ndarray:
        """History columns NAMEx, NAMEy [, NAMEz] as an array [rows, dim]."""
        return np.column_stack([self.history[name + axis] for axis in "xyz" if name + axis in self.history])

    def frame_near(self, time: float) -> Path | None:
        """Path of the frame nearest to a time [s], None without frames."""
        return min(self.frames, key=lambda path: abs(time_of(path) - time), default=None)

    def displacement(self, rigid: str, time: float) -> np.ndarray | None:
        """Displacement [dim] of a rigid at a time [s] since it was placed: rows of the history, linearly between them, with what
        came before a stage that a reset ended. None without history."""
        columns = [self.history.get(f"{rigid}_{axis}") for axis in "xyz"[:int(self.text("dim", "2"))]]
        if "time" not in self.history or any(column is None for column in columns):
            return None
        ways = np.column_stack(columns)
        stages, numbers = self.words("stages"), self.history.get("stage", np.ones(len(ways)))
        for k in np.flatnonzero(np.diff(numbers) > 0):
            if self.text(f"{stages[int(numbers[k]) - 1]}_reset", "off") == "on":
                ways[k + 1:] += ways[k]
        return np.array([np.interp(time, self.history["time"], way) for way in ways.T])

    def angle(self, rigid: str, time: float) -> float:
        """Angle [rad] by which a rigid in 2D has turned at a time [s]; 0 where it does not turn."""
        angles = self.history.get(f"{rigid}_angle")
        return 0.0 if angles is None else float(np.interp(time, self.history["time"], angles))

    def moving_rigids(self) -> list[str]:
        stages = [f"{stage}_" for stage in self.words("stages")]
        return [name for name in self.words("rigid_bodies")
                if any(self.text(f"{stage}{name}_motion", "fixed") != "fixed" for stage in ["", *stages])]

    def stage_ends(self) -> list[tuple[str, float]]:
        """[(name, time)] of the stages but the last that the history holds: s, where the next one begins."""
        numbers, names = self.history.get("stage", np.array([])), self.words("stages")
        ends = np.flatnonzero(np.diff(numbers) > 0)
        return [(names[int(numbers[k]) - 1], self.history["time"][k]) for k in ends]


def read_options(folder: Path) -> dict[str, str]:
    path = folder / "options.json"
    if not path.exists():
        print(f"plot: {path} is missing: nothing is known of bodies and rigids", file=sys.stderr)
        return {}
    options = json.loads(path.read_text())["options"]
    options.setdefault("rigid_bodies", options.pop("rigids", "none"))  # the word of older runs
    return {name: text for name, text in options.items() if text != "none"}


def read_history(path: Path) -> dict[str, np.ndarray]:
    """Columns of history.csv as arrays [rows]; empty if the file or its rows are missing."""
    if not path.exists():
        print(f"plot: {path} is missing: no curve", file=sys.stderr)
        return {}
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    if not rows:
        print(f"plot: {path} has no rows: no curve", file=sys.stderr)
        return {}
    return dict(zip(header, np.array(rows, dtype=float).T))


def stage_of(path: Path | str) -> str:
    """Name of the stage in which a frame was written; empty where the run has none."""
    with h5py.File(path) as file:
        name = file.attrs.get("stage", "")
        return name.decode() if isinstance(name, bytes) else str(name)


def time_of(path: Path | str) -> float:
    """Time of a frame [s]."""
    with h5py.File(path) as file:
        return float(file.attrs["time"])


def units_of(path: Path | str) -> dict[str, str]:
    """{dataset: SI unit} of all groups of a frame; older frames have none."""
    with h5py.File(path) as file:
        found = {key: data.attrs["unit"] for group in file.values() for key, data in group.items() if "unit" in data.attrs}
    return {key: unit.decode() if isinstance(unit, bytes) else str(unit) for key, unit in found.items()}


def read_frame(path: Path | str) -> tuple[float, dict[str, dict[str, np.ndarray]]]:
    """Time [s] and {group: {field: array}} of one frame."""
    with h5py.File(path) as file:
        groups = {name: {key: data[()] for key, data in group.items()} for name, group in file.items()}
        return float(file.attrs["time"]), groups


def read_body(path: Path | str, body: str, *fields: str) -> list[np.ndarray]:
    """Some fields of a body in a frame, arrays [N] or [N, components]; NoSuchResult where the frame has no particles of it."""
    with h5py.File(path) as file:
        if body not in file or "position" not in file[body]:
            raise NoSuchResult(f"{path}: has no particles of {body}")
        return [file[body][name][()] for name in fields]


def particles_in(path: Path | str, body: str) -> int:
    """Number of particles of a body in a frame, of which none is read; 0 where it has none."""
    with h5py.File(path) as file:
        return len(file[body]["position"]) if body in file and "position" in file[body] else 0


# ---------------------------------------------------------------------------------------------- bearing capacity


def extent(run: Run, name: str) -> tuple[float, float]:
    """Lower and upper x of a rigid's or body's shape, m."""
    shape = run.text(f"{name}_shape", "box")
    if shape == "polygon":
        x = run.numbers(f"{name}_polygon")[::2]
        return min(x), max(x)
    if shape in ("disc", "ball", "cylinder", "cone"):
        centre, radius = run.number(f"{name}_centre"), run.number(f"{name}_radius")
        return in_mesh(run, centre - radius, centre + radius)
    if shape == "stl":  # where its particles begin
        x = read_body(run.frames[0], name, "position")[0][:, 0]
        return float(x.min()), float(x.max())
    if shape in ("half_plane", "layer"):
        return run.number("mesh_lower"), run.number("mesh_upper")
    (left, low), (right, high) = run.numbers(f"{name}_lower")[:2], run.numbers(f"{name}_upper")[:2]
    angle = np.radians(run.number(f"{name}_angle_deg"))  # about the lower corner
    x = [left + a * np.cos(angle) - b * np.sin(angle) for a in (0, right - left) for b in (0, high - low)]
    return in_mesh(run, min(x), max(x))


def in_mesh(run: Run, left: float, right: float) -> tuple[float, float]:
    """Part of an extent in x that a side of the mesh leaves, m."""
    return max(left, run.number("mesh_lower", left)), min(right, run.number("mesh_upper", right))


def is_half_model(run: Run, name: str) -> bool:
    """Does the rigid touch a roller side of the mesh, a plane of symmetry?"""
    left, right = extent(run, name)
    near = 1e-6 * max(run.number("mesh_spacing"), 1e-12)
    return (abs(left - run.number("mesh_lower")) < near and run.text("mesh_xmin") == "roller") or (
        abs(right - run.number("mesh_upper")) < near and run.text("mesh_xmax") == "roller")


def strength_below(run: Run, name: str) -> float:
    """Undrained strength [Pa] of the first von_mises or tresca material, at the level of the rigid's underside; 0 if none."""
    for material in run.words("materials"):
        if run.text(f"{material}_model") in ("von_mises", "tresca"):
            level = run.numbers(f"{name}_lower", [0, 0])[1]
            depth = max(run.number(f"{material}_su_datum") - level, 0)
            return run.number(f"{material}_su") + depth * run.number(f"{material}_su_gradient")
    return 0.0


def footing(run: Run, name: str) -> tuple[float, float] | None:
    """Width B [m] and the force on the modelled part at Nc = 1 [N/m], if `name` is pushed straight down into clay in
    2D, else None."""
    velocity = run.numbers(f"{name}_velocity", [0, 0])
    strength = strength_below(run, name)
    vertical = run.text(f"{name}_motion") == "prescribed" and velocity[0] == 0 and velocity[1] < 0
    plane = run.text("dim", "2") == "2" and run.text("geometry", "plane_strain") == "plane_strain"
    if not plane or not vertical or strength == 0:
        return None
    left, right = extent(run, name)
    return (2 if is_half_model(run, name) else 1) * (right - left), strength * (right - left)


def bearing_curve(run: Run, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Penetration w/B and Nc of each row of the history, and the weight (advance) of the row. The force is the mean
    over the interval that ends at the row, so it belongs to the middle of the interval."""
    width, unit_force = footing(run, name) or (np.nan, np.nan)
    w = -run.history[f"{name}_y"] / width
    return (w[1:] + w[:-1]) / 2, run.history[f"{name}_force_y"][1:] / unit_force, np.diff(w)


def window_means(w: np.ndarray, nc: np.ndarray, weight: np.ndarray, window: float = WINDOW) -> tuple[np.ndarray, np.ndarray]:
    """Means of nc over the windows [k, k + 1] * window, k = 0, 1, ...: middles and means of those that are filled."""
    weight = np.where(w > 0, np.maximum(weight, 0), 0)
    place = np.maximum(w / window, 0).astype(int)
    total = np.bincount(place, weight)
    sums = np.bincount(place, weight * nc)
    full = np.flatnonzero(total > 0.8 * window)
    return (full + 0.5) * window, sums[full] / total[full]


def mean_over(w: np.ndarray, nc: np.ndarray, weight: np.ndarray, lower: float = MEAN_FROM, upper: float = MEAN_TO) -> float:
    """Mean of nc over lower <= w <= upper, NaN where the run has nothing there."""
    inside = (w >= lower) & (w <= upper)
    return np.average(nc[inside], weights=weight[inside]) if weight[inside].sum() > 0 else np.nan


def reference_curve(relative_spacing, fillet):
    """Middles of the windows w/B and Nc of the stored curve for cells of d/B, or None. Columns are named Nc_d=0.05B or
    Nc_d=0.05B_fillet, and w_over_B is the end of each window."""
    for path in sorted(CASES.glob("footing/reference*.csv")):
        with open(path, newline="") as file:
            header, *rows = csv.reader(line for line in file if not line.startswith("#"))
        for k, column in enumerate(header):
            match = re.fullmatch(r"Nc_d=([0-9.]+)B(_fillet)?", column)
            if match and bool(match[2]) == fillet and abs(float(match[1]) / relative_spacing - 1) < 1e-3:
                values = np.array(rows, dtype=float)
                return values[:, 0] - (values[1, 0] - values[0, 0]) / 2, values[:, k]
    return None
