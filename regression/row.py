"""One answer of a case beside what it should be."""

from dataclasses import dataclass


@dataclass
class Row:
    what: str        # the answer, with its unit
    answer: float
    expected: float
    allowed: float   # largest difference
    source: str      # where the expected value comes from

    def passes(self):
        return abs(self.answer - self.expected) <= self.allowed  # false for NaN
