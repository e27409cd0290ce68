#!/usr/bin/env python3
"""Starts the program with random decks, of which none may crash it, hang it or make it print a page.

    decks.py MPM [--count 10000] [--seed 1] [--shard 1/1] [--jobs 1] [--keep FOLDER] [--only K,...]

A deck has options that are valid, with extreme values, and a few that are not; files of particles, nested options files,
options of PETSc, and an environment (deck_make.py). Most are dry runs, the others make a few steps on a tiny mesh. Of each:

- no signal, no end beyond the limits of time and memory, and the exit status is 0, 2, 3 or 75 (1 where the output folder
  cannot be made);
- the program reports faults in lines of its own, a few of them, and never by a page of a library;
- wrong input (2) leaves nothing behind, and says something;
- a run that ends with 0 has a history with finite numbers only.

Offences are printed by class at the end; --keep keeps one folder of each class and number, with the lines of the deck that
matter and a script that starts it again. --only starts some decks of a seed. Decks depend on docs/options.md too.
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import resource
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from deck_make import make_trial  # noqa: E402

MEMORY = 6 << 30       # bytes of address space
PROCESSOR_TIME = 30    # s
WALL_TIME = 60         # s, for a process that sleeps
MOST_LINES = 25        # of stderr: a line for each mistake
STATUSES = (0, 2, 3, 75)
PAGE = re.compile(r"PETSC ERROR|Stack trace|terminate called|Backtrace|HDF5-DIAG|Sanitizer|what\(\):|Assertion|core dumped")
OTHERS = re.compile(r"^(Kokkos::|\s|OMP|libgomp|--kokkos|Usage|--------|$)|WARNING")  # lines that libraries may write


def write_files(trial, folder):
    for name, content in trial.files.items():
        path = folder / name
        if isinstance(content, bytes):
            path.write_bytes(content)
        elif content == "folder":
            path.mkdir()
        elif content == "fifo":
            os.mkfifo(path)
        elif content == "socket":
            with socket.socket(socket.AF_UNIX) as server:
                here = os.open(folder, os.O_RDONLY)
                server.bind(f"/proc/self/fd/{here}/{name}")
                os.close(here)
        elif content != "missing":
            path.symlink_to({"loop": path, "null": "/dev/null", "zero": "/dev/zero"}[content])
    (folder / "deck.opts").write_bytes(deck_bytes(trial))


def deck_bytes(trial):
    return "".join(f"{line}\n" for line in trial.lines).encode(errors="surrogateescape")


def command_of(trial, program):
    ranks = ["mpirun", "-n", str(trial.ranks), "--bind-to", "none"] if trial.ranks > 1 else []
    deck = "/dev/stdin" if trial.by_pipe else "deck.opts"
    place = [] if gives(trial, "output_dir") else ["-output_dir", "out"]
    words = [word.replace("\0", "") for word in trial.words]
    return [*ranks, str(program), "-options_file", deck, *place, "-progress", "off", *words]


def gives(trial, option):
    return any(line.startswith(f"-{option} ") for line in trial.lines)


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_TIME, PROCESSOR_TIME + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))


def environment_of(trial, folder):
    mine = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_orte_tmpdir_base": str(folder.parent / "session"),
            "OMP_NUM_THREADS": "1", "OMP_PROC_BIND": "false", "XDG_CACHE_HOME": str(folder.parent / "cache")}
    return {**os.environ, **mine, **trial.environment}


def start(trial, program, folder):
    """Runs a trial in a folder: (exit status, minus the signal's number where one ended it, or None; stdout; stderr)."""
    folder.mkdir(parents=True)
    (folder.parent / "session").mkdir(exist_ok=True)
    write_files(trial, folder)
    with open(folder / "deck.opts", "rb") as deck:
        process = subprocess.Popen(command_of(trial, program), cwd=folder, env=environment_of(trial, folder),
                                   stdin=subprocess.PIPE if trial.by_pipe else subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=limits, start_new_session=True)
        try:
            out, err = process.communicate(deck.read() if trial.by_pipe else None, timeout=WALL_TIME)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return None, *(text.decode(errors="replace") for text in process.communicate())
    return process.returncode, out.decode(errors="replace"), err.decode(errors="replace")


# ---------------------------------------------------------------------------------------------- what must hold


def nonfinite(folder):
    """The first value of a history that is not finite, "" if there is none."""
    for path in folder.glob("**/history.csv"):
        if path.is_file() and not path.is_symlink():
            lines = path.read_text(errors="replace").splitlines()
            for line in lines[1:]:
                for column, text in zip(lines[0].split(","), line.split(",")):
                    if re.search("nan|inf", text):
                        return f"{re.sub('^[a-z]+_', 'NAME_', column)} is {text}"
    return ""


def first_line(text):
    """The first line of what was printed that says why, with numbers and given values left out, for a class."""
    text = re.sub(r"(?m)^\[\S+:\d+\].*\n?", "", text)  # Open MPI's own account of a signal
    pages = [line for line in text.splitlines() if PAGE.search(line) and "Error Message ---" not in line]
    lines = pages[:2] or [line for line in text.splitlines() if line.strip()][:1]
    line = ": ".join(line.split("PETSC ERROR: ")[-1] for line in lines)
    line = re.sub(r"/\S*/", "", re.sub(r'given ".*?"', 'given "..."', line))
    return re.sub(r"[-+]?\d[\d.e+-]*", "N", line)[:100]


def left_behind(trial, folder):
    ours = {"deck.opts", *trial.files, "cache"}
    return sorted({path.relative_to(folder).parts[0] for path in folder.iterdir()} - ours)


def offence(trial, folder, status, out, err):
    """The class of what is wrong with a trial that has ended, "" if nothing is."""
    helps = "-help" in trial.words or any("help" in word for word in trial.words)
    if status is None or status in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
        return "hang"
    if status < 0 or status > 128:
        return f"signal {-status if status < 0 else status - 128}: {first_line(err)}"
    if PAGE.search(out + err):
        return f"page: {first_line(err if PAGE.search(err) else out)}"
    in_the_way = "out" in trial.files or gives(trial, "output_dir") or "TMPDIR" in trial.environment  # the system's failure
    if status not in STATUSES and not (status == 1 and in_the_way):
        return f"status {status}: {first_line(err)}"
    lines = [line for line in err.splitlines() if not OTHERS.search(line)]
    if len(lines) > MOST_LINES and not helps:
        return f"{status}, many lines: {first_line(err)}"
    if status in (2, 3) and not lines and not helps:
        return f"{status}, silent"
    foreign = [line for line in lines if not line.startswith("mpm: ")]
    if status in (2, 3) and foreign and trial.ranks == 1 and not helps:
        return f"{status}, not our line: {first_line(foreign[0])}"
    if status == 2 and left_behind(trial, folder):
        return f"2, left behind: {left_behind(trial, folder)[0][:40]}"
    if status == 0 and (found := nonfinite(folder)):
        return f"not finite: {found}"
    return ""


def try_trial(trial, program):
    """(class of the offence or "", exit status, what was printed on stderr)."""
    with tempfile.TemporaryDirectory(prefix="mpm_deck_") as place:
        folder = pathlib.Path(place) / "here"
        status, out, err = start(trial, program, folder)
        return offence(trial, folder, status, out, err), status, err


# ---------------------------------------------------------------------------------------------- offenders


def smaller(trial, program, wanted, tries=80):
    """The trial with the lines, words, files and variables left out that the offence does not need."""
    if wanted == "hang":
        return trial  # each try would last as long
    limit = ("-dry_run", "-time_max_steps")  # stays, lest the run be long
    parts = [("lines", k) for k in reversed(range(len(trial.lines)))]
    parts += [("words", k) for k in reversed(range(len(trial.words))) if not {*trial.words[max(k - 1, 0):k + 1]} & {*limit}]
    parts += [("environment", name) for name in trial.environment] + [("files", name) for name in trial.files]
    for kind, key in parts[:tries]:
        held = getattr(trial, kind)
        if isinstance(held, list):
            setattr(trial, kind, [word for k, word in enumerate(held) if k != key])
        else:
            setattr(trial, kind, {name: content for name, content in held.items() if name != key})
        if try_trial(trial, program)[0] != wanted:
            setattr(trial, kind, held)
    return trial


def needs(trial):
    """Conditions of an offence beside the lines of the deck, in words."""
    size_of = lambda content: content if isinstance(content, str) else f"{len(content)} bytes"
    files = [f"{name} ({size_of(content)})" for name, content in trial.files.items()]
    return " ".join([*trial.words, *(f"{name}={value}" for name, value in trial.environment.items()), *files])


def keep(trial, program, folder, what):
    """Writes a trial as a folder with all its files and run.sh."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_files(trial, folder)
    variables = " ".join(f"{name}={shlex.quote(value)}" for name, value in trial.environment.items())
    pipe = "cat deck.opts | " if trial.by_pipe else ""
    lines = ["#!/bin/sh", f"# {what}", 'cd "$(dirname "$0")"', f"ulimit -v {MEMORY >> 10}", f"ulimit -t {PROCESSOR_TIME}",
             f"{pipe}env {variables} {shlex.join(command_of(trial, program))}", ""]
    (folder / "run.sh").write_text("\n".join(lines), errors="surrogateescape")


def numbers_of(arguments):
    if arguments.only:
        return [int(word) for word in arguments.only.split(",")]
    part, parts = (int(word) for word in arguments.shard.split("/"))
    return range(part - 1, arguments.count, parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=10000, help="of decks, of all shards together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shard", default="1/1", metavar="K/N", help="every N-th deck, from the K-th on")
    parser.add_argument("--only", help="numbers of decks, with commas")
    parser.add_argument("--jobs", type=int, default=1, help="decks at once")
    parser.add_argument("--keep", type=pathlib.Path, help="where the offenders go")
    arguments = parser.parse_args()
    program, numbers = pathlib.Path(arguments.program).absolute(), list(numbers_of(arguments))
    offenders, statuses = collections.defaultdict(list), collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        results = pool.map(lambda k: try_trial(make_trial(arguments.seed, k), program), numbers)
        for k, (found, status, err) in zip(numbers, results):
            statuses[status] += 1
            if not found:
                continue
            offenders[found].append(k)
            print(f"deck {k}: {found}", flush=True)
            if arguments.keep and len(offenders[found]) == 1:
                trial = smaller(make_trial(arguments.seed, k), program, found)
                print(f"  needs {len(trial.lines)} lines, {needs(trial)}", flush=True)
                keep(trial, program, arguments.keep / f"{k}_{re.sub('[^A-Za-z0-9]+', '_', found)[:50]}", found)
    print(f"{len(numbers)} decks of seed {arguments.seed}; exit statuses: "
          + ", ".join(f"{status}: {count}" for status, count in sorted(statuses.items(), key=str)))
    for found, decks in sorted(offenders.items(), key=lambda item: -len(item[1])):
        print(f"  {len(decks):5} {found}   ({', '.join(map(str, decks[:6]))})")
    return 1 if offenders else 0


if __name__ == "__main__":
    sys.exit(main())
