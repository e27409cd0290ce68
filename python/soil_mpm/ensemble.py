"""Runs of a table of option values: sweeps over options, and over seeds of random fields. scripts/sweep is its command.

Run n of a table goes to OUT/run_000n. A run that has finished is not made again, and one that was stopped goes on from its checkpoint.
"""

from __future__ import annotations

import concurrent.futures
import csv
import itertools
import json
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping, Sequence, TYPE_CHECKING

import numpy as np

from soil_mpm import launch
from soil_mpm.problems import NoSuchResult, RunFailed, WrongDeck
from soil_mpm.schema import written

if TYPE_CHECKING:
    from soil_mpm.deck import Deck
    from soil_mpm.results import Run

REDUCE: dict[str, Callable[[Sequence[float]], float]] = {"last": lambda v: v[-1], "max": max, "min": min}


def read_table(path: Path | str) -> tuple[list[str], list[list[str]]]:
    """Names of options without dash, and rows of values, of a CSV file."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        raise WrongDeck(f"{path}: is empty; takes a line of names of options, and a row of values for each run")
    header = [name.strip().lstrip("-") for name in rows[0]]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(header):
            raise WrongDeck(f"{path}:{number}: {len(row)} values, {len(header)} names")
    return header, [[value.strip() for value in row] for row in rows[1:]]


def table_of(values: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """The table of a sweep: of all combinations of {option: values}, the last option quickest, or of rows {option: value}."""
    if isinstance(values, Mapping):
        header = list(values)
        return header, [[written(each) for each in row] for row in itertools.product(*values.values())]
    header = list(dict.fromkeys(name for row in values for name in row))
    short = next((n for n, row in enumerate(values) if set(row) != set(header)), None)
    if short is not None:
        raise WrongDeck(f"row {short} of the table: has {', '.join(values[short])}, takes {', '.join(header)}")
    return header, [[written(row[name]) for name in header] for row in values]


class Ensemble:
    """Runs of a table: header, names of options; rows, their values as texts; out, the folder. ensemble[n] is a Run."""

    def __init__(self, out: Path | str, header: list[str], rows: list[list[str]]):
        self.out, self.header, self.rows = Path(out), header, rows

    def __len__(self) -> int:
        return len(self.rows)

    def folder(self, number: int) -> Path:
        return self.out / f"run_{number:04d}"

    def __getitem__(self, number: int) -> Run:
        from soil_mpm.results import Run
        if not 0 <= number < len(self.rows):
            raise IndexError(number)
        return Run(self.folder(number))

    def __repr__(self) -> str:
        return f"<Ensemble {self.out}: {len(self.finished())} of {len(self)} runs finished, over {', '.join(self.header)}>"

    def options(self, number: int) -> dict[str, str]:
        """Options of a run beside those of the deck."""
        return dict(zip(self.header, self.rows[number]))

    def finished(self) -> list[int]:
        """Numbers of the runs that have reached their end."""
        return [number for number in range(len(self)) if launch.is_finished(self.folder(number))]

    def written(self) -> list[int]:
        """Numbers of the runs that have a history."""
        return [number for number in range(len(self)) if (self.folder(number) / "history.csv").exists()]

    def note(self, options: Sequence[str]) -> None:
        """Writes sweep.json: the table, and the words of the command line that all runs have."""
        self.out.mkdir(parents=True, exist_ok=True)
        (self.out / "sweep.json").write_text(json.dumps({"options": list(options), "header": self.header, "table": self.rows}, indent=1))

    def make(self, one: Callable[[int], str], jobs: int = 1) -> Iterator[tuple[int, str]]:
        """Calls one(number) for each run that has not finished, `jobs` at a time: yields the number and the line that it returns."""
        def made(number: int) -> str:
            return f"{self.folder(number)}: finished before" if launch.is_finished(self.folder(number)) else one(number)
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            yield from enumerate(pool.map(made, range(len(self))))

    # ------------------------------------------------------------------------------------------ results

    def value(self, number: int, wanted: str) -> float:
        """The last, largest or least value of a column of a run: COLUMN, COLUMN:last, COLUMN:max or COLUMN:min."""
        column, _, which = wanted.partition(":")
        if which and which not in REDUCE:
            raise NoSuchResult(f'given "{wanted}", takes COLUMN:last, COLUMN:max or COLUMN:min')
        return float(REDUCE[which or "last"](self[number][column].tolist()))

    def table(self, *wanted: str | tuple[str, Callable[[Run], float]]) -> Any:
        """A row for each run that has finished: run, its options, and of its history columns (value()) or (name, f) with f(run). A
        data frame of pandas where pandas is there, else a structured array of numpy."""
        columns = self.columns(*wanted)
        try:
            import pandas
        except ImportError:
            return np.rec.fromarrays([np.array(values) for values in columns.values()], names=list(columns))
        return pandas.DataFrame(columns)

    def columns(self, *wanted: str | tuple[str, Callable[[Run], float]]) -> dict[str, list[Any]]:
        """The columns of table()."""
        numbers = self.finished()
        columns: dict[str, list[Any]] = {"run": list(numbers)}
        for k, name in enumerate(self.header):
            columns[name] = [as_number(self.rows[number][k]) for number in numbers]
        for each in wanted:
            if isinstance(each, str):
                columns[each] = [self.value(number, each) for number in numbers]
            else:
                columns[each[0]] = [each[1](self[number]) for number in numbers]
        return columns

    def write_table(self, path: Path | str, *wanted: str | tuple[str, Callable[[Run], float]]) -> Path:
        """Writes table() as a CSV file, and returns its path."""
        columns = self.columns(*wanted)
        with open(path, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([list(columns), *zip(*columns.values())])
        return Path(path)

    def plot(self, x: str | None = None, y: str | None = None) -> Path:
        """Draws column y over x of every run (sweep.png); returns the path."""
        from soil_mpm.plot.ensembles import draw_curves
        return draw_curves(self, x, y)

    def gather(self) -> list[int]:
        """Writes histories.csv, all rows of all runs with the run and its options before them; the numbers of the runs."""
        numbers, columns = self.written(), None
        rows: list[list[str]] = []
        for number in numbers:
            with open(self.folder(number) / "history.csv", newline="") as file:
                header, *own = csv.reader(file)
            columns = columns or header
            rows += [[str(number), *self.rows[number], *row] for row in own]
        if columns is not None:
            with open(self.out / "histories.csv", "w", newline="") as file:
                csv.writer(file).writerows([["run", *self.header, *columns], *rows])
        return numbers


def as_number(text: str) -> float | str:
    """A text as a number where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def sweep(deck: Deck, values: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]], out: Path | str, *, jobs: int = 1,
          progress: bool = True, stop: bool = True, **how: Any) -> Ensemble:
    """Runs a deck for all combinations of {option: values}, or for rows {option: value}, `jobs` runs at a time, and returns them. Every
    run's options are checked before the first one is made. stop: whether the first run that fails ends the sweep (RunFailed); else it
    is left out of the tables. how: of launch.run, as ranks or threads."""
    ensemble = Ensemble(out, *table_of(values))
    for number in range(len(ensemble)):
        deck.copy(**ensemble.options(number))
    ensemble.note([])

    def one(number: int) -> str:
        folder = ensemble.folder(number)
        try:
            launch.run(deck.copy(**ensemble.options(number)), folder, progress=False, restart=True, **how)
        except RunFailed as failed:
            if stop:
                raise RunFailed(f"{folder}: {failed}", failed.status) from None
            return f"{folder}: exit status {failed.status}: {failed}"
        return f"{folder}: finished"
    for _, line in ensemble.make(one, jobs):
        if progress:
            print(line, flush=True)
    return ensemble


def random_fields(out: Path | str, count: int, *, seed: int = 0, **how: Any) -> list[Path]:
    """Files of random fields of a parameter, of the seeds seed, seed + 1 ...: values of -NAME_field for a sweep. how: see
    ground.random_fields.RandomField, as name="su", lower=(0, 0), upper=(4, 2), spacing=0.1, mean=20e3, cov=0.3, length=(2, 0.5)."""
    from soil_mpm.ground.random_fields import RandomField
    field, out = RandomField(**how), Path(out)
    out.mkdir(parents=True, exist_ok=True)
    paths = [out / f"{field.name}_{seed + k:04d}.h5" for k in range(count)]
    for k, path in enumerate(paths):
        field.write(path, seed + k)
    return paths
