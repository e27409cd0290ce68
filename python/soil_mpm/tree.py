"""Places in the source tree, in a bundle, in an installation, or in a wheel; and the program."""

import os
import shutil
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
ROOT = PACKAGE.parents[1]
PROGRAM = PACKAGE / "program"  # of a wheel
CASES = ROOT / "regression" / "cases"


def default_program() -> Path:
    """The program to run where none is named: that of MPM_PROGRAM, a wheel's or a bundle's own, what the preset built, the one that was
    installed with this package, or the first mpm of PATH."""
    built = ROOT / "build" / os.environ.get("MPM_PRESET", "openmp") / "app" / "mpm"
    installed = ROOT.parents[1] / "bin" / "mpm"  # ROOT is PREFIX/share/mpm
    given = os.environ.get("MPM_PROGRAM")
    own = (PROGRAM / "bin" / "mpm", ROOT / "bin" / "mpm", built, installed)
    found = next((path for path in own if path.is_file()), None)
    return Path(given) if given else found or Path(shutil.which("mpm") or built)


def launcher() -> str:
    """The mpirun of a wheel or a bundle, or that of the machine."""
    own = (PROGRAM / "bin" / "mpirun", ROOT / "bin" / "mpirun")
    return str(next((path for path in own if path.exists()), "mpirun"))


def extra_mpi() -> str:
    """Folder of the Open MPI that `pip install "soil-mpm[mpi]"` has put beside the program of a wheel; empty where there is none."""
    folder = Path(sys.prefix)
    return str(folder) if all((folder / name).is_file() for name in ("bin/mpirun", "lib/libmpi.so.40")) and PROGRAM.is_dir() else ""


def decks_folder() -> Path:
    """Folder of the decks that come with the program: inputs."""
    own = PACKAGE / "inputs"
    return own if own.is_dir() else ROOT / "inputs"
