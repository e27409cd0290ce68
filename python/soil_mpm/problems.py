"""Exceptions of the package. The text of each is one line for the user, or a line for each mistake."""

from __future__ import annotations


class Problem(Exception):
    """Base of all exceptions that the package raises by intention."""


class UnknownOption(Problem, KeyError, AttributeError):
    """An option that the program does not have; the text has the nearest one."""

    def __str__(self) -> str:
        return self.args[0]


class WrongValue(Problem, ValueError):
    """A value that an option does not take."""


class WrongDeck(Problem):
    """A deck that cannot be read, or that the program refuses."""


class RunFailed(Problem):
    """A run that did not reach its end. status: exit status of the program (docs/running.md)."""

    def __init__(self, text: str, status: int):
        super().__init__(text)
        self.status = status


class NoProgram(Problem):
    """There is no program to ask or to run."""


class NoSuchResult(Problem, KeyError):
    """A column, field, body or frame that a run does not have."""

    def __str__(self) -> str:
        return self.args[0]
