"""Places in the source tree, in a bundle, or in an installation; and the program."""

import os
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "regression" / "cases"


def default_program() -> Path:
    """The program to run where none is named: that of MPM_PROGRAM, a bundle's own, what the preset built, the one that was installed
    with this package, or the first mpm of PATH."""
    built = ROOT / "build" / os.environ.get("MPM_PRESET", "openmp") / "app" / "mpm"
    installed = ROOT.parents[1] / "bin" / "mpm"  # ROOT is PREFIX/share/mpm
    given = os.environ.get("MPM_PROGRAM")
    found = next((path for path in (ROOT / "bin" / "mpm", built, installed) if path.is_file()), None)
    return Path(given) if given else found or Path(shutil.which("mpm") or built)


def launcher() -> str:
    """The mpirun of a bundle, or that of the machine."""
    bundled = ROOT / "bin" / "mpirun"
    return str(bundled) if bundled.exists() else "mpirun"
