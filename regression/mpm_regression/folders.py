"""Runs of the program, and what their output folders hold."""
import contextlib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import zlib

import h5py
import numpy as np

SESSIONS = tempfile.TemporaryDirectory(prefix="mpm_sessions_")
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",  # ranks share cores
               "OMPI_MCA_ess_singleton_isolated": "1",  # no daemon beside each run
               "OMPI_MCA_orte_tmpdir_base": SESSIONS.name,  # runs of another test may clear the common one
               "OMP_PROC_BIND": "false", "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "1"),
               "MALLOC_PERTURB_": "165"}


def launcher(ranks):
    return ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()


def command(binary, deck, folder, *options):
    """deck: an options file, or None."""
    file = [] if deck is None else ["-options_file", str(deck)]
    return [str(binary), *file, "-output_dir", str(folder), "-progress", "off", *map(str, options)]


def run(binary, deck, folder, *options, status=0, environment=None, prefix=(), timeout=1800):
    """Runs to the end and checks the exit status; returns what was printed (stdout, stderr)."""
    with subprocess.Popen([*prefix, *command(binary, deck, folder, *options)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          errors="replace", env={**ENVIRONMENT, **(environment or {})}, start_new_session=True) as process:
        try:
            out, errors = process.communicate(timeout=timeout)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # the launcher and its ranks
            raise
    done = subprocess.CompletedProcess(process.args, process.returncode, out, errors)
    if status is not None and done.returncode != status:
        raise AssertionError(f"exit status {done.returncode} instead of {status} of {options}:\n"
                             f"{done.stdout[-1500:]}\n{done.stderr}")
    return done


def rows(folder):
    """Header and rows of the history as text, without the column of the wall time."""
    lines = (pathlib.Path(folder) / "history.csv").read_text().splitlines()
    skipped = lines[0].split(",").index("wall_time")
    return [[x for k, x in enumerate(line.split(",")) if k != skipped] for line in lines]


def history(folder):
    """{column: array [rows]}, without the column of the wall time."""
    head, *lines = rows(folder)
    return dict(zip(head, np.array(lines, dtype=float).reshape(-1, len(head)).T))


def of_velocities(time, dt):
    """Times [s] to which the velocities of the soil at each row belong: the middle of the step before it, and the first row's own."""
    return np.where(time > time[0], time - dt / 2, time)


def kill(process):
    """SIGKILL to a process and its children."""
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    children = children.read_text().split() if process.poll() is None else []
    process.kill()
    for child in children:
        with contextlib.suppress(ProcessLookupError):  # it ended with its launcher
            os.kill(int(child), signal.SIGKILL)
    process.communicate()


def contents(path):
    """All datasets and attributes of an HDF5 file, as bytes."""
    found = {}
    with h5py.File(path) as file:
        def visit(name, item):
            for key, value in item.attrs.items():
                found[f"{name}@{key}"] = np.asarray(value).tobytes()
            if isinstance(item, h5py.Dataset):
                found[name] = (item.shape, item.dtype.str, item[()].tobytes())
        visit("", file)
        file.visititems(visit)
    return found


def frames(folder):
    return sorted((pathlib.Path(folder) / "frames").glob("frame_*.h5"))


def differences(one, other):
    """Differences between the results in two folders, bit by bit; empty if there is none."""
    found = []
    if rows(one) != rows(other):
        found.append(f"history.csv: {len(rows(one))} and {len(rows(other))} lines")
    names = [[f.name for f in frames(folder)] for folder in (one, other)]
    if names[0] != names[1]:
        found.append(f"frames: {names[0][-1:]} and {names[1][-1:]}")
    for name in set(names[0]) & set(names[1]):
        a, b = (contents(pathlib.Path(folder) / "frames" / name) for folder in (one, other))
        found += [f"{name} {key}" for key in sorted(a.keys() | b.keys()) if a.get(key) != b.get(key)]
    indices = [pathlib.Path(folder) / "particles.xdmf" for folder in (one, other)]  # of runs with frames
    if len({index.read_text() if index.exists() else None for index in indices}) > 1:
        found.append("particles.xdmf")
    return found


def checkpoints(folder):
    """Checkpoints of a folder, the earliest first."""
    return sorted(pathlib.Path(folder).glob("checkpoint_*.h5"), key=lambda path: int(path.stem.split("_")[1]))


SEAL = re.compile(rb"\nmpm checkpoint, (\d{20}) bytes before this line, crc32 ([0-9a-f]{8})\n\Z")


def is_whole(path):
    """Whether a checkpoint has the length and checksum of its last line."""
    data = path.read_bytes()
    seal = SEAL.search(data)
    return bool(seal) and int(seal[1]) == seal.start() and int(seal[2], 16) == zlib.crc32(data[:seal.start()])


def change_sealed(path, change):
    """Changes the items of a checkpoint, and seals it again."""
    data = path.read_bytes()
    path.write_bytes(data[:SEAL.search(data).start()])
    with h5py.File(path, "r+") as file:
        change(file)
    data = path.read_bytes()
    path.write_bytes(data + b"\nmpm checkpoint, %020d bytes before this line, crc32 %08x\n" % (len(data), zlib.crc32(data)))


def faults_of_folder(folder):
    """Files of an output folder that are neither whole nor temporary."""
    folder, found = pathlib.Path(folder), []
    for path in folder.rglob("*"):
        if path.is_dir() or path.suffix == ".tmp":
            continue
        if path.name.startswith("checkpoint_"):
            if not is_whole(path):
                found.append(f"{path.name} is not whole")
        elif path.suffix == ".h5":
            try:
                contents(path)
            except Exception as error:
                found.append(f"{path.name}: {error}")
        elif path.name == "particles.xdmf":
            import xml.etree.ElementTree
            xml.etree.ElementTree.fromstring(path.read_text())
        elif path.name in ("options.json", "performance.json"):
            import json
            json.loads(path.read_text())
        elif path.name == "history.csv":
            lines = path.read_text().split("\n")
            if lines[-1] or any(line.count(",") != lines[0].count(",") for line in lines[:-1]):
                found.append("history.csv has a line that is cut")
    return found


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    return pathlib.Path(folder)
