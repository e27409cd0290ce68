"""Pictures of the runs of a table (ensemble.py): curves of all, and the distribution of a value. Needs matplotlib."""

from __future__ import annotations

import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from soil_mpm.ensemble import REDUCE, Ensemble
from soil_mpm.problems import NoSuchResult
from soil_mpm.results import Run
from soil_mpm.units import axis_unit, unit_of

FEW = 12  # runs; the names of more fill the picture


def history_of(run: Run) -> dict[str, np.ndarray]:
    """The history of a run; columns without rows where none is written yet."""
    if run.history:
        return run.history
    with open(run.folder / "history.csv", newline="") as file:
        return {name: np.empty(0) for name in next(csv.reader(file))}


def chosen_columns(runs: list[dict[str, np.ndarray]], x: str | None, y: str | None) -> tuple[str, str]:
    """The columns of the picture: those asked for, else the force on the first rigid body that moves, along the axis on which it moves
    most, over its displacement; else the first force, or the last column, over time."""
    columns = list(runs[0])
    forces = [name for name in columns if "_force_" in name]
    ways = {name: name.replace("_force_", "_") for name in forces if name.replace("_force_", "_") in columns}
    moved = {name: max((np.abs(run[way]).max(initial=0) for run in runs if way in run), default=0) for name, way in ways.items()}
    if y is None:
        first = next((name.rpartition("_force_")[0] for name in moved if moved[name] > 0), None)
        own = [name for name in moved if name.rpartition("_force_")[0] == first]
        y = max(own, key=lambda name: moved[name]) if own else next(iter(forces), columns[-1])
    if x is None:
        x = y.replace("_force_", "_") if moved.get(y, 0) > 0 else "time"
    for name in (x, y):
        if name not in columns:
            raise NoSuchResult(f"no column {name}; there are {', '.join(columns)}")
    return x, y


def draw_curves(ensemble: Ensemble, x: str | None = None, y: str | None = None) -> Path:
    """sweep.png: column y over x of every run that has a history; its path."""
    numbers = ensemble.written()
    first = ensemble[numbers[0]]
    runs = [history_of(ensemble[number]) for number in numbers]
    x, y = chosen_columns(runs, x, y)
    drawn = {name: [run[name] for run in runs] for name in (x, y)}
    # a body that goes down or to the left goes to the right in the picture, and the force against it is up
    flip = x == y.replace("_force_", "_") and sum(values[-1] for values in drawn[x] if len(values)) < 0
    figure, axes = plt.subplots(figsize=(7, 5))
    several, sizes = len(runs) <= FEW, {}
    for name in (x, y):
        text, size = axis_unit(first, np.concatenate(drawn[name]), unit_of(name))
        sizes[name] = -size if flip and name == x else size
        label = name if name == "time" else ("-" if flip and name == x else "") + name
        (axes.set_xlabel if name == x else axes.set_ylabel)(f"{label} ({text})" if text else label)
    for number, along, up in zip(numbers, drawn[x], drawn[y]):
        axes.plot(along / sizes[x], up / sizes[y], label=", ".join(f"{name} {value}" for name, value in ensemble.options(number).items()),
                  color=None if several else "tab:blue", alpha=1 if several else 0.4)
    axes.grid(alpha=0.25)
    if several:
        axes.legend(fontsize="small")
    figure.tight_layout()
    figure.savefig(ensemble.out / "sweep.png", dpi=150)
    plt.close(figure)
    return ensemble.out / "sweep.png"


def draw_distribution(ensemble: Ensemble, wanted: str) -> str:
    """distribution.csv and distribution.png of COLUMN, COLUMN:last, COLUMN:max or COLUMN:min over the runs that have a history; a line
    of mean, deviation and quantiles."""
    column, _, which = wanted.partition(":")
    if which and which not in REDUCE:
        raise NoSuchResult(f'--distribution: given "{wanted}", takes COLUMN:last, COLUMN:max or COLUMN:min')
    what, numbers = f"{which or 'last'} {column}", ensemble.written()
    if column not in ensemble[numbers[0]].history:
        raise NoSuchResult(f"no column {column}; there are {', '.join(ensemble[numbers[0]].history)}")
    values = np.array([ensemble.value(number, wanted) for number in numbers])
    with open(ensemble.out / "distribution.csv", "w", newline="") as file:
        csv.writer(file).writerows([["run", what], *zip(numbers, values.tolist())])
    text, size = axis_unit(ensemble[numbers[0]], values, unit_of(column))
    values = np.sort(values) / size
    mean, deviation = values.mean(), values.std(ddof=1) if len(values) > 1 else 0.0
    marks = np.quantile(values, [0.05, 0.5, 0.95])
    printed = (f"{len(values)} runs: mean {mean:.4g}, deviation {deviation:.4g}, 5 % {marks[0]:.4g}, 50 % {marks[1]:.4g}, "
               f"95 % {marks[2]:.4g}")
    figure, axes = plt.subplots(figsize=(7, 5))
    axes.hist(values, bins="auto", density=False, color="0.8", edgecolor="0.5")
    axes.set(xlabel=f"{what} ({text})" if text else what, ylabel="runs", title=printed)
    axes.title.set_fontsize("small")
    shares = axes.twinx()
    shares.step(values, (np.arange(len(values)) + 0.5) / len(values), where="mid", color="tab:blue")
    shares.set(ylabel="fraction of runs below", ylim=(0, 1))
    for x in marks:
        shares.axvline(x, color="tab:red", linestyle="--", linewidth=0.8)
    figure.tight_layout()
    figure.savefig(ensemble.out / "distribution.png", dpi=150)
    plt.close(figure)
    return f"{ensemble.out}/distribution.csv, {ensemble.out}/distribution.png: {printed}" + (f" ({text})" if text else "")
