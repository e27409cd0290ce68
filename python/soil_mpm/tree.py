"""Places in the source tree, or in a bundle."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "regression" / "cases"


def default_program():
    """The program to run where none is named: a bundle's own, or what the preset built."""
    bundled = ROOT / "bin" / "mpm"
    return bundled if bundled.exists() else ROOT / "build" / os.environ.get("MPM_PRESET", "openmp") / "app" / "mpm"
