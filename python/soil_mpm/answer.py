"""An answer of a run: a number of its history, as "plate_force_y at plate_y=-0.05"."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from soil_mpm.problems import NoSuchResult, WrongValue
from soil_mpm.results import Run

FORMS = '"COLUMN at OTHER=VALUE", "COLUMN over OTHER=FROM:TO" (its mean), "COLUMN at end", "COLUMN at max" or "COLUMN at min"'
TEXT = re.compile(r"\s*(\w+)\s+(?:at\s+(end|max|min)|(at|over)\s+(\w+)\s*=\s*([^:\s]+)(?:\s*:\s*(\S+))?)\s*$")
MEANS = re.compile(r"^(?!wall_).*_(force|moment)(_[xyz])?$")  # columns that are means since the row before: docs/results.md
ROUND = 4  # rows on each side of a place from which the ripple is taken


@dataclass(frozen=True)
class Answer:
    """column at end, max or min (which), where `other` first comes to `low`, or its mean while `other` is from low to high."""
    column: str
    which: str = ""
    other: str = ""
    low: float = 0.0
    high: float | None = None

    @staticmethod
    def of(text: str) -> Answer:
        """The answer of a text; WrongValue where it is none."""
        found = TEXT.match(text)
        try:
            if found and found[2]:
                return Answer(found[1], found[2])
            if found and (found[3] == "over") == (found[6] is not None):
                return Answer(found[1], "", found[4], float(found[5]), None if found[6] is None else float(found[6]))
        except ValueError:
            pass
        raise WrongValue(f'--answer: given "{text}", takes {FORMS}')

    def __str__(self) -> str:
        if self.which:
            return f"{self.column} at {self.which}"
        if self.high is None:
            return f"{self.column} at {self.other}={self.low:g}"
        return f"{self.column} over {self.other}={self.low:g}:{self.high:g}"

    def curve(self, run: Run) -> tuple[np.ndarray, np.ndarray]:
        """The column, and what it is a function of; a mean since the row before belongs to the middle of its interval."""
        values, x = run[self.column], run[self.other or "time"]
        if MEANS.match(self.column) and len(x) > 1:
            return values[1:], (x[1:] + x[:-1]) / 2
        return values, x

    def value(self, run: Run) -> tuple[float, float]:
        """The answer of a run, and its ripple: how far the rows beside it are from a smooth curve (root of the mean square)."""
        values, x = self.curve(run)
        if self.which:
            place = {"end": len(values) - 1, "max": int(np.argmax(values)), "min": int(np.argmin(values))}[self.which]
            return float(values[place]), ripple(values, place)
        if self.high is not None:
            return self.mean(run, values, x)
        cross = np.flatnonzero((x[:-1] - self.low) * (x[1:] - self.low) <= 0)
        if not len(cross):
            raise NoSuchResult(f"{run.folder}: {self.other} does not come to {self.low:g}: it is from {x.min():.6g} to {x.max():.6g}")
        k = int(cross[0])
        share = 0.0 if x[k + 1] == x[k] else (self.low - x[k]) / (x[k + 1] - x[k])
        return float(values[k] + share * (values[k + 1] - values[k])), ripple(values, k)

    def mean(self, run: Run, values: np.ndarray, x: np.ndarray) -> tuple[float, float]:
        low, high = sorted((self.low, self.high or 0.0))
        inside = (x >= low) & (x <= high)
        if inside.sum() < 2:
            raise NoSuchResult(f"{run.folder}: fewer than two rows have {self.other} from {low:g} to {high:g}")
        weight = np.abs(np.gradient(x))[inside]
        mean = float(np.average(values[inside], weights=weight)) if weight.sum() > 0 else float(values[inside].mean())
        return mean, rest_of(x[inside], values[inside], 1) / np.sqrt(inside.sum())


def ripple(values: np.ndarray, place: int) -> float:
    """Distance of rows beside a place from a parabola."""
    near = values[max(place - ROUND, 0):place + ROUND + 1]
    return rest_of(np.arange(len(near), dtype=float), near, 2) if len(near) > 5 else 0.0


def rest_of(x: np.ndarray, values: np.ndarray, degree: int) -> float:
    """Root of the mean square of what a polynomial leaves of some values."""
    span = x.max() - x.min()
    if span == 0 or len(x) <= degree + 1:
        return 0.0
    scaled = (x - x.min()) / span
    rest = values - np.polyval(np.polyfit(scaled, values, degree), scaled)
    return float(np.sqrt((rest ** 2).sum() / (len(x) - degree - 1)))
