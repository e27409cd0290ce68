"""Random fields of a parameter on a grid: scripts/random_field. Needs numpy, scipy and h5py."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from soil_mpm.ground.fields import Field, WrongField, write_field


@dataclass
class RandomField:
    """A field that a body reads by -NAME_field. name: the parameter, as su (Pa). lower, upper [dim]: corners of its grid, m; spacing:
    of the grid, m, one or one an axis. mean: in the parameter's unit; cov: deviation over mean. length [dim]: correlation lengths, m.
    distribution: lognormal or gaussian; covariance: exponential, gaussian or matern of smoothness nu. lowest: in place of values below
    it."""
    name: str
    lower: Any
    upper: Any
    spacing: Any
    mean: float
    cov: float
    length: Any
    distribution: str = "lognormal"
    covariance: str = "exponential"
    nu: float = 1.5
    lowest: float | None = None

    def __post_init__(self) -> None:
        self.lower, self.upper, self.length = (np.atleast_1d(np.asarray(each, dtype=float)) for each in (self.lower, self.upper, self.length))
        self.spacing = np.atleast_1d(np.asarray(self.spacing, dtype=float))
        self.check()
        shape = [int(np.ceil((high - low) / h - 1e-9)) + 1 for low, high, h in zip(self.lower, self.upper, self.spacing)]
        self.field = Field(shape, self.spacing, self.length, self.mean, abs(self.cov * self.mean), self.covariance, self.nu,
                           self.distribution == "lognormal")

    def check(self) -> None:
        dim = self.lower.size
        if dim not in (2, 3) or self.upper.size != dim or self.length.size != dim or self.spacing.size not in (1, dim):
            raise WrongField("--lower, --upper and --length: take 2 numbers each, or 3 each; --spacing 1 or as many")
        self.spacing = np.broadcast_to(self.spacing, dim)
        for name, wrong in [("--upper", (self.upper <= self.lower).any()), ("--spacing", (self.spacing <= 0).any()),
                            ("--length", (self.length <= 0).any())]:
            if wrong:
                raise WrongField(f"{name}: takes numbers greater than " + ("those of --lower" if name == "--upper" else "0"))
        if self.cov < 0 or (self.distribution == "lognormal" and self.mean <= 0) or self.nu <= 0:
            raise WrongField("--cov and --seed take 0 or more, --nu more than 0, --count 1 or more; a lognormal --mean more than 0")

    def write(self, path: Path | str, seed: int) -> str:
        """Writes the field of a seed; a line about its values."""
        values, low = self.field.make(seed), 0
        if self.lowest is not None:
            low = int((values < self.lowest).sum())
            values = np.maximum(values, self.lowest)
        notes = {"seed": seed, "mean": self.mean, "cov": self.cov, "length": self.length, "covariance": self.covariance,
                 "distribution": self.distribution}
        write_field(path, self.name, values, self.lower, self.spacing, notes)
        raised = "" if self.lowest is None else f"; {low} raised to {self.lowest:g}"
        return (f"{path}: {self.name} on {' x '.join(map(str, values.shape))} points, mean {values.mean():.6g}, deviation "
                f"{values.std():.6g}, {values.min():.6g} to {values.max():.6g}{raised}")
