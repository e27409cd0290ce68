"""Decks, runs and results of mpm, a material point method for soil: docs/python.md.

    from soil_mpm import Deck, Run, sweep

What a name needs is imported when it is first used, so that a script can find a Python that has numpy and h5py first
(soil_mpm.python_modules).
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.2.0"

PLACES = {
    "Deck": "deck", "Schema": "schema", "Option": "schema", "Run": "results", "Frame": "frames", "Ensemble": "ensemble",
    "sweep": "ensemble", "random_fields": "ensemble", "Job": "launch", "certify": "certificate", "Certificate": "certificate", "Answer": "answer",
    "Problem": "problems",
    "UnknownOption": "problems", "WrongValue": "problems", "WrongDeck": "problems", "RunFailed": "problems", "NoProgram": "problems",
    "NoSuchResult": "problems",
}


def __getattr__(name: str) -> Any:
    if name not in PLACES:
        raise AttributeError(f"module soil_mpm has no {name}")
    module = importlib.import_module(f"soil_mpm.{PLACES[name]}")
    return getattr(module, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *PLACES})


__all__ = [*PLACES]
