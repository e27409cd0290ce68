"""Curves of a history as SVG with their numbers beside them, which page.js shows under the pointer."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from html import escape
from typing import Sequence

import numpy as np

from soil_mpm.results import Run
from soil_mpm.units import axis_unit, unit_of

MOST_POINTS, MOST_LINES = 400, 8
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 300, 76, 12, 10, 44
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31"]  # told apart by the colour-blind
DASHES = ["", "7 3", "2 3", "9 3 2 3"]

AXES = r"_[xyz]$"
# Title and columns of each chart, in the order of the page; NAME stands for the names of a list of the deck.
KINDS: list[tuple[str, str, str]] = [
    ("Force of the soil on rigid bodies", "rigid_bodies", "_force" + AXES), ("Moment of the soil on rigid bodies", "rigid_bodies", r"_moment(_[xyz])?$"),
    ("Displacement of rigid bodies", "rigid_bodies", AXES), ("Velocity of rigid bodies", "rigid_bodies", "_velocity" + AXES),
    ("Force between rigid bodies", "rigid_bodies", "_contact_force" + AXES), ("Reactions of joints", "joints", "_force" + AXES),
    ("Forces between bodies in contact", "contact_pairs", "_force" + AXES), ("Force of loads", "loads", "_force" + AXES),
    ("Largest speed of the soil", "bodies", "_grid_velocity$"), ("Centre of mass, from its first place", "bodies", "_centre" + AXES),
    ("Kinetic energy of the soil", "bodies", "_kinetic_energy$"), ("Probes: velocity", "probes", "_velocity" + AXES),
    ("Probes: displacement", "probes", "_displacement" + AXES), ("Probes: pressure", "probes", r"_(pore_)?pressure$"),
    ("Probes: stress", "probes", r"_stress_[xyz]{2}$"), ("Probes: depth and levels", "probes", r"_(depth|surface|base)$"),
    ("Probes: speed", "probes", "_speed$"), ("Probes: flux of mass", "probes", "_mass_flux$"), ("Forces on the sides of the mesh", "", r"wall_\w+_force" + AXES),
    ("Balance of energy", "", r"(energy|work)_\w+$"), ("Empty cells and particles in trouble", "bodies", "_(strays|limited|put_back)$"),
    ("Mass that left the run", "bodies", "_lost_mass$"), ("Unbalanced forces over the weight", "", "unbalanced_ratio$"), ("Time step", "", "dt$")]


@dataclass
class Chart:
    """Lines over one axis. x: values [rows], rising. lines: {name: values [rows]}, in the unit of the axis. left_out: what is not drawn,
    in words."""
    title: str
    x_label: str
    y_label: str
    x: np.ndarray
    lines: dict[str, np.ndarray]
    left_out: str = ""


def charts_of(run: Run) -> list[Chart]:
    """The charts that a history has columns for; columns that are zero all the time are left out."""
    if len(run.history.get("time", ())) < 2:
        return []
    by_way = [force_of_way(run, name) for name in run.moving_rigids()]
    by_time = [chart_of(run, title, columns_of(run, of, pattern)) for title, of, pattern in KINDS]
    return [chart for chart in [*by_way, *by_time] if chart]


def columns_of(run: Run, of: str, pattern: str) -> list[str]:
    names = [name.replace(":", "_") for name in run.words(of)] if of else []
    starts = "(" + "|".join(map(re.escape, names)) + ")" if names else ""
    if of and not names:
        return []
    found = [column for column in run.history if re.match(starts + pattern, column)]
    return found + (["empty_cells"] if pattern.startswith("_(strays") and "empty_cells" in run.history else [])


def chart_of(run: Run, title: str, columns: Sequence[str]) -> Chart | None:
    """A chart of columns against time."""
    values = {column: run[column] - (run[column][0] if "_centre_" in column else 0) for column in columns}
    drawn = {column: each for column, each in values.items() if np.isfinite(each).any() and np.nanmax(np.abs(each)) > 0}
    if not drawn:
        return None
    largest = sorted(drawn, key=lambda column: -np.nanmax(np.abs(drawn[column])))[:MOST_LINES]
    unit, size = axis_unit(run, np.concatenate([drawn[column] for column in largest]), unit_of(largest[0]))
    quiet = [column for column in values if column not in drawn]
    told = [f"zero all the time: {', '.join(quiet)}"] if quiet else []
    if len(drawn) > MOST_LINES:
        told.append(f"the {MOST_LINES} largest of {len(drawn)} columns")
    return Chart(title, "time (s)", f"({unit})" if unit not in ("", "-") else "", run["time"],
                 {column: drawn[column] / size for column in values if column in largest}, "; ".join(told))


def force_of_way(run: Run, name: str) -> Chart | None:
    """Force of the soil on a rigid body against the length of its displacement, where that only grows."""
    way = np.linalg.norm(run.columns(f"{name}_"), axis=1) if f"{name}_x" in run.history else np.zeros(1)
    columns = [column for column in columns_of(run, "rigid_bodies", "_force" + AXES) if column[:-len("_force_x")] == name]
    if not columns or not (np.diff(way) >= 0).all() or way[-1] <= 0:
        return None
    made = chart_of(run, f"Force of the soil on {name} against its displacement", columns)
    if made:
        made.x, made.x_label = way, "displacement (m)"
    return made


# ---------------------------------------------------------------------------------------------- drawing


def ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Round numbers from low to high, both inside, at most `most` and at least two steps apart of 1, 2 or 5 times a power of ten."""
    if not high > low:
        return [low]
    step = 10.0 ** math.floor(math.log10((high - low) / most))
    step *= next(k for k in (1, 2, 5, 10, 20) if (high - low) / (k * step) <= most)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]


def thinned(x: np.ndarray, lines: dict[str, np.ndarray]) -> np.ndarray:
    """Rows to draw: all where they are few, else those of the least and the largest value of each line in each interval."""
    if len(x) <= MOST_POINTS:
        return np.arange(len(x))
    edges = np.linspace(0, len(x), MOST_POINTS // (2 * len(lines)) + 2).astype(int)
    kept = {0, len(x) - 1}
    for begin, end in zip(edges, edges[1:]):
        for values in lines.values():
            part = np.nan_to_num(values[begin:end])
            if len(part):
                kept |= {begin + int(part.argmin()), begin + int(part.argmax())}
    return np.array(sorted(kept))


def number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "-"


def svg(chart: Chart) -> str:
    """The chart as an SVG element, its legend, and its numbers as JSON for page.js."""
    rows = thinned(chart.x, chart.lines)
    x, lines = chart.x[rows], {name: values[rows] for name, values in chart.lines.items()}
    low, high = (float(f(np.concatenate([*lines.values(), [0.0]]))) for f in (np.nanmin, np.nanmax))
    room = 0.04 * (high - low)
    low, high = low - (room if low < 0 else 0), high + (room if high > 0 else 0)
    left, right = float(x[0]), float(x[-1]) if x[-1] > x[0] else float(x[0]) + 1

    def across(value: float) -> float:
        return LEFT + (value - left) / (right - left) * (WIDTH - LEFT - RIGHT)

    def up(value: float) -> float:
        return HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM)
    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(chart.title)}">']
    for value in ticks(low, high):
        parts.append(f'<path class="grid" d="M{LEFT} {up(value):.1f}H{WIDTH - RIGHT}"/>'
                     f'<text x="{LEFT - 6}" y="{up(value) + 4:.1f}" text-anchor="end">{value:.6g}</text>')
    for value in ticks(left, right, 8):
        parts.append(f'<path class="grid" d="M{across(value):.1f} {TOP}V{HEIGHT - BOTTOM}"/>'
                     f'<text x="{across(value):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{value:.6g}</text>')
    parts.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{escape(chart.x_label)}</text>')
    if chart.y_label:
        parts.append(f'<text transform="translate(14 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">{escape(chart.y_label)}</text>')
    for k, values in enumerate(lines.values()):
        parts.append(f'<path class="line" stroke="{COLOURS[k]}" stroke-dasharray="{DASHES[k % len(DASHES)]}" d="{path_of(x, values, across, up)}"/>')
    parts.append(f'<path class="mark" d="M0 {TOP}V{HEIGHT - BOTTOM}"/></svg>')
    return "".join(parts) + legend(chart) + numbers(chart, x, lines, left, right)


def path_of(x, values, across, up) -> str:
    words, gap = [], True
    for place, value in zip(x, values):
        if math.isfinite(value):
            words.append(f"{'M' if gap else 'L'}{across(place):.1f} {up(value):.1f}")
        gap = not math.isfinite(value)
    return "".join(words)


def legend(chart: Chart) -> str:
    rows = []
    for k, (name, values) in enumerate(chart.lines.items()):
        sample = f'<svg class="sample" viewBox="0 0 30 8"><path class="line" stroke="{COLOURS[k]}" stroke-dasharray="{DASHES[k % len(DASHES)]}" d="M0 4H30"/></svg>'
        rows.append(f"<tr><td>{sample}{escape(name)}</td><td class=\"now\"></td><td>{number(float(np.nanmin(values)))}</td>"
                    f"<td>{number(float(np.nanmax(values)))}</td><td>{number(float(values[-1]))}</td></tr>")
    note = f"<p class=\"note\">{escape(chart.left_out)}</p>" if chart.left_out else ""
    return (f'<table class="legend"><tr><th>{escape(chart.y_label)}</th><th class="now"></th><th>least</th><th>largest</th><th>last</th></tr>'
            + "".join(rows) + "</table>" + note)


def numbers(chart: Chart, x: np.ndarray, lines: dict[str, np.ndarray], left: float, right: float) -> str:
    def plain(values: np.ndarray) -> list[float | None]:
        return [float(f"{value:.6g}") if math.isfinite(value) else None for value in values]
    told = {"label": chart.x_label, "x": plain(x), "lines": [plain(values) for values in lines.values()], "from": left, "to": right,
            "left": LEFT, "right": WIDTH - RIGHT, "width": WIDTH}
    return f'<script type="application/json">{json.dumps(told, separators=(",", ":"))}</script>'
