"""One answer of a case beside what it should be."""

import sys
from dataclasses import dataclass


@dataclass
class Row:
    what: str                # the answer, with its unit
    answer: float
    exact: float
    tolerance: float         # largest error
    source: str              # where the exact value comes from
    relative: bool = False   # error, tolerance and bound are shares of the exact value
    at_least: bool = False   # an answer above the exact value has no error, as the order of convergence
    single: float | None = None  # tolerance in single precision, where it is another
    shortfall: str = ""      # why the error is known to be larger than the tolerance; then the row does not fail ...
    bound: float = 0.0       # ... up to this error

    def error(self):
        difference = self.answer - self.exact
        if self.at_least:
            difference = min(difference, 0.0)  # NaN stays NaN
        return abs(difference / self.exact if self.relative else difference)

    def tolerance_in(self, precision):
        return self.single if precision == "single" and self.single is not None else self.tolerance

    def verdict(self, precision):
        """pass, short (a known shortfall that got no worse) or FAIL, which NaN is."""
        if self.error() <= self.tolerance_in(precision):
            return "pass"
        return "short" if self.shortfall and self.error() <= self.bound else "FAIL"


def failed(error):
    """The row of a run that did not reach its end; says which on stderr."""
    print(error, file=sys.stderr)
    return Row("every run reaches its end", float("nan"), 0, 0, "definition")
