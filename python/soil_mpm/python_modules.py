"""Finds a Python that has the modules that a script needs.

A script calls need("numpy", "h5py") before it imports them. Where the Python that runs it lacks one of them, the script goes
on with another Python that has all: that of MPM_PYTHON, the one that scripts/setup chose, or the system's. Where none has
them, it ends with one line that says what to install.
"""

import importlib.util
import os
import pathlib
import subprocess
import sys

CHANGED = "MPM_PYTHON_CHANGED"  # set in the environment of a script that goes on with another Python
ASK = "import importlib.util as u, sys; sys.exit(not all(map(u.find_spec, sys.argv[1:])))"
PACKAGES = {"numpy": "python3-numpy", "h5py": "python3-h5py", "matplotlib": "python3-matplotlib", "scipy": "python3-scipy"}


def chosen_by_setup():
    """Pythons that scripts/setup chose, the latest first."""
    cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "mpm"
    folder = pathlib.Path(os.environ.get("MPM_DEPS") or cache) / "env"
    found = []
    for file in sorted(folder.glob("*.sh"), key=lambda file: file.stat().st_mtime, reverse=True):
        for line in file.read_text().splitlines():
            if line.startswith("export MPM_PYTHON='"):
                found.append(line.partition("'")[2].rstrip("'"))
    return found


def has(python, modules):
    try:
        return subprocess.run([python, "-c", ASK, *modules], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              timeout=60).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def another_python(modules):
    """A Python that has the modules; None where there is none."""
    candidates = [os.environ.get("MPM_PYTHON", ""), *chosen_by_setup(), "/usr/bin/python3"]
    for python in dict.fromkeys(filter(None, candidates)):
        if os.path.realpath(python) != os.path.realpath(sys.executable) and has(python, modules):
            return python
    return None


def need(*modules):
    """Goes on where all modules are there, by another Python where need be; else ends the script."""
    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if not missing:
        return
    python = None if CHANGED in os.environ else another_python(modules)
    if python is not None:
        os.environ[CHANGED] = "1"
        sys.stdout.flush()
        os.execv(python, [python, *sys.argv])
    packages = " ".join(PACKAGES.get(name, name) for name in missing)
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {sys.executable} lacks {', '.join(missing)}; takes apt install {packages}, "
             f"pip install {' '.join(missing)}, or MPM_PYTHON set to a Python that has them")
