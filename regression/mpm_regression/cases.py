"""A case of the suite: its folder's case.py, and its runs by the program.

case.py holds
  RUNS         {run: options of the program beside the deck's}; {start} in them is the file that prepare wrote
  check(runs)  yields a Row for each answer; runs is {run: Run}, all of one back end and precision
and may hold
  DECK         the options file, from the top of the source tree; else case.opts of its folder
  PRECISIONS   those in which it is run, where not in both; BACKENDS likewise
  LONG         True: not among the quick tests
  APART        (why, bound): strategies and back ends are further apart after a step in single precision than compare.py allows
  prepare(run, path, options)  writes the initial fields of a run to the HDF5 file `path`
  draw(axes, runs)             draws the case's curve for the documents
  class Fine(Size)             the same problem in another size, as the case NAME_fine: size.py
Its docstring opens with a title, and explains the problem, the exact answer and what the set-up neglects.
"""

import importlib.util
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

from mpm_regression.size import with_size
from soil_mpm.results import Run
from soil_mpm.tree import ROOT

SESSIONS = tempfile.TemporaryDirectory(prefix="mpm_")


class ProgramFailed(Exception):
    """A run that did not reach its end; the text says which, and what the program said."""


def places(root=ROOT):
    """{name of a case: (its case.py,) or (its case.py, its size)}."""
    found = {}
    for path in (root / "regression" / "cases").glob("*/case.py"):
        sizes = [word.lower() for word in re.findall(r"^class (\w+)\(Size\)", path.read_text(), re.M)]
        found |= {"_".join([path.parent.name, *size]): (path, *size) for size in ([], *([word] for word in sizes))}
    return dict(sorted(found.items()))


def names():
    return list(places())


class Case:
    def __init__(self, name, root=ROOT):
        """root: of the source tree whose case it is."""
        found = places(root)
        if name not in found:
            sys.exit(f"regression/run: no case {name} in {root / 'regression' / 'cases'}")
        path, *size = found[name]
        spec = importlib.util.spec_from_file_location(f"case_{path.parent.name}", path)
        self.module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(self.module)
        if size:
            self.module = with_size(self.module, *size)
        self.name, self.root, self.folder = name, root, f"regression/cases/{path.parent.name}"
        self.deck = getattr(self.module, "DECK", f"{self.folder}/case.opts")
        self.runs = self.module.RUNS

    def is_long(self):
        return getattr(self.module, "LONG", False)

    def variants(self, backends, precisions, in_turn=False):
        """The (back end, precision) pairs of those asked for in which this case is run; in_turn: as few as have each word."""
        backends = [word for word in backends if word in getattr(self.module, "BACKENDS", backends)]
        precisions = [word for word in precisions if word in getattr(self.module, "PRECISIONS", precisions)]
        if in_turn and backends and precisions:
            return [(backends[k % len(backends)], precisions[k % len(precisions)]) for k in range(max(len(backends), len(precisions)))]
        return [(backend, precision) for backend in backends for precision in precisions]

    def title(self):
        return self.module.__doc__.split("\n\n")[0].strip()

    def explanation(self):
        return "\n\n".join(self.module.__doc__.split("\n\n")[1:]).strip()


def run_program(binary, case, run, variant, folder, more="", ranks=1):
    """Runs the program once, in a variant (back end, precision, ...) and on so many ranks; its output as a Run, and the
    time it took, s."""
    backend, precision = variant[:2]
    folder.mkdir(parents=True, exist_ok=True)
    start = folder / f"{run}.start.h5"
    options = shlex.split(f"-backend {backend} -precision {precision} {case.runs[run]} {more}".format(start=start))
    if hasattr(case.module, "prepare"):
        case.module.prepare(run, start, options)
    command = [str(binary), "-options_file", case.deck, *options, "-output_dir", str(folder / run), "-progress", "off"]
    if ranks > 1:
        command = [launcher(), "-n", str(ranks), "--bind-to", "none", *command]
    begin = time.time()
    done = subprocess.run(command, cwd=case.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment())
    if done.returncode != 0:
        raise ProgramFailed(f"{shlex.join(command)}: exit status {done.returncode}\n{done.stdout[-2000:]}")
    return Run(folder / run), time.time() - begin


def launcher():
    """The mpirun of a bundle, or that of the machine."""
    bundled = ROOT / "bin" / "mpirun"
    return str(bundled) if bundled.exists() else "mpirun"


def environment():
    """Open MPI refuses root, and more ranks than cores, unless allowed; runs at the same time may clear each other's session
    folder, so each has one of its own; threads and ranks that wait give way to those of other runs. A run on one rank starts
    in half the time without a daemon beside it."""
    return {"OMPI_MCA_orte_tmpdir_base": tempfile.mkdtemp(dir=SESSIONS.name),
            "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_ess_singleton_isolated": "1", "OMP_PROC_BIND": "false", "OMP_WAIT_POLICY": "passive", **os.environ}
