"""Runs of decks: on this machine, on several processes, by Slurm."""

from __future__ import annotations

import contextlib
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence

from soil_mpm.problems import NoProgram, RunFailed, WrongDeck
from soil_mpm.tree import PROGRAM, default_program, extra_mpi, launcher

if TYPE_CHECKING:
    from soil_mpm.deck import Deck
    from soil_mpm.results import Run

BAD_INPUT, FAILED, STOPPED = 2, 3, 75  # exit statuses: docs/running.md
BUSY = 0.5  # processes that run or wait to run, as a mean over the last minute
PERCENT = re.compile(r"^step (\d+)\s+t = (\S+) s\s+([\d.]+) %")


def environment(ranks: int = 1, threads: int | None = None, more: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment of a run. One process starts in half the time without a daemon of Open MPI beside it. Threads that wait give way
    where the machine has other work: they would keep the cores from the threads that they wait for, and a step would take many times as
    long."""
    made = {**os.environ}
    if os.getloadavg()[0] > BUSY:
        made.setdefault("OMP_WAIT_POLICY", "passive")
    if ranks == 1:
        made.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    else:
        made.pop("OMPI_MCA_ess_singleton_isolated", None)
        if extra_mpi():
            made.setdefault("MPM_MPI", extra_mpi())
    if threads is not None:
        made["OMP_NUM_THREADS"] = str(threads)
    return {**made, **(more or {})}


def is_finished(folder: Path) -> bool:
    """Whether the run of an output folder reached its end."""
    path = Path(folder) / "performance.json"
    return path.exists() and json.loads(path.read_text())["outcome"] == "finished"


def goes_on(folder: Path) -> list[str]:
    """Options by which a run goes on from the last checkpoint of its output folder, where there is one."""
    return ["-restart", "latest"] if list(Path(folder).glob("checkpoint_*.h5")) else []


@contextlib.contextmanager
def deck_file(deck: Deck) -> Iterator[Path]:
    """A file of the deck for the time of a run: its own where it is as it was read, else another."""
    if deck._path is not None and deck._path.exists() and deck._path.read_text(encoding="utf-8") == str(deck):
        yield deck._path
        return
    with tempfile.TemporaryDirectory(prefix="soil_mpm_") as folder:
        yield deck.write(Path(folder) / (deck._path.name if deck._path else "deck.opts"))


def start_own_program() -> None:
    """The command mpm of a wheel: becomes its program, with the words of the command line."""
    path = str(PROGRAM / "bin" / "mpm")
    os.execv(path, [path, *sys.argv[1:]])


def output_folder(deck: Deck, out: Path | str | None) -> Path:
    """Folder of the results: out, else -output_dir of the deck, else out/ and the name of the deck's file."""
    if out is not None:
        return Path(out)
    return Path(deck.given().get("output_dir") or Path("out") / (deck._path.stem if deck._path else "mpm"))


def words_of(options: Mapping[str, Any], deck: Deck) -> list[str]:
    """Words of a command line for options beside the deck, each checked against it."""
    changed = deck.copy(**options)
    given = changed.given()
    keys = [deck.schema.present_name(name) for name in options]
    return [word for key in keys if key in given for word in ([f"-{key}", given[key]] if given[key] else [f"-{key}"])]


def program_of(deck: Deck) -> str:
    path = Path(deck._program or default_program())
    if not path.is_file():
        raise NoProgram(f"{path}: there is no program; build it, or set MPM_PROGRAM to it")
    return str(path)


def check(deck: Deck) -> list[str]:
    """Mistakes that the program finds in a deck, a line each; it writes nothing."""
    done = ask(deck, "-dry_run")
    return done.stderr.strip().splitlines() if done.returncode else []


def dry_run(deck: Deck) -> str:
    """The report of the program about a run that is not made; WrongDeck with its lines where it refuses the deck."""
    done = ask(deck, "-dry_run")
    if done.returncode:
        raise WrongDeck(done.stderr.strip())
    return done.stdout


def ask(deck: Deck, *words: str) -> subprocess.CompletedProcess[str]:
    with deck_file(deck) as path:
        return subprocess.run([program_of(deck), "-options_file", str(path), *words], capture_output=True, text=True,
                              env=environment(), check=False)


class Percent:
    """Prints a line at each tenth of the run."""

    def __init__(self, name: str):
        self.name, self.shown = name, 0

    def __call__(self, fraction: float, time: float) -> None:
        if int(10 * fraction) > self.shown:
            self.shown = int(10 * fraction)
            print(f"{self.name}: {10 * self.shown} %, t = {time:.6g} s", flush=True)


def run(deck: Deck, out: Path | str | None = None, *, ranks: int = 1, threads: int | None = None, options: Mapping[str, Any] | None = None,
        progress: bool | Callable[[float, float], Any] = True, restart: bool = False, launch: Sequence[str] | None = None) -> Run:
    """Runs a deck to its end, and returns its results. RunFailed with the program's words where it does not get there; a run that
    a signal or -wall_time_limit stopped has the status 75 and goes on by restart=True.

    out: folder of the results (output_folder). ranks: processes, by mpirun; launch: words in its place, as ["srun", "-n", "4"].
    threads: of each process. options: beside those of the deck, for this run. progress: True prints a line at each tenth; a function
    gets the fraction that is done and the time [s]; False prints nothing.
    """
    from soil_mpm.results import Run
    folder = output_folder(deck, out)
    report = Percent(folder.name) if progress is True else progress or (lambda fraction, time: None)
    begin = list(launch) if launch else [launcher(), "-n", str(ranks), "--bind-to", "none"] if ranks > 1 else []
    with deck_file(deck) as path:
        words = [*begin, program_of(deck), "-options_file", str(path), *words_of(options or {}, deck), "-output_dir", str(folder),
                 "-progress", "auto" if progress else "off", *(goes_on(folder) if restart else [])]
        status, message = follow(words, environment(ranks, threads), report)
    if status in (-signal.SIGILL, 128 + signal.SIGILL):
        message = f"{program_of(deck)}: was built for another processor than this machine's; take a build of the preset ci"
    if status:
        raise RunFailed(message or f"{shlex.join(words)}: exit status {status}", status)
    return Run(folder)


def follow(words: Sequence[str], variables: Mapping[str, str], report: Callable[[float, float], Any]) -> tuple[int, str]:
    """Exit status of a command and what it says on stderr; calls report(fraction, time) at its lines of progress. An interrupt goes to
    the program too, which then writes a checkpoint."""
    said: list[str] = []
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(variables)) as process:
        assert process.stdout is not None and process.stderr is not None
        reader = threading.Thread(target=lambda: said.extend(process.stderr or ()))
        reader.start()
        for line in process.stdout:
            found = PERCENT.match(line)
            if found:
                report(float(found[3]) / 100, float(found[2]))
        reader.join()
    return process.returncode, "".join(said).strip()


# ---------------------------------------------------------------------------------------------- Slurm


@dataclass
class Job:
    """A job of Slurm and its output folder."""
    number: str
    folder: Path

    def state(self) -> str:
        """PENDING, RUNNING and so on; FINISHED where the run has reached its end, GONE where Slurm does not list the job any more."""
        if is_finished(self.folder):
            return "FINISHED"
        done = subprocess.run(["squeue", "-h", "-j", self.number, "-o", "%T"], capture_output=True, text=True, check=False)
        return done.stdout.strip() or "GONE"

    def wait(self, every: float = 30.0) -> Run:
        """Waits for the end, asks each `every` seconds, and returns the results; RunFailed where the job ends without them. A job that
        has stopped at its limit goes on in another one (scripts/site/slurm), and is waited for."""
        from soil_mpm.results import Run
        while (state := self.state()) != "FINISHED":
            if state == "GONE" and Run(self.folder).outcome != "stopped":
                raise RunFailed(f"job {self.number} has ended, and {self.folder} holds no run that has finished", FAILED)
            time.sleep(every)
        return Run(self.folder)


def submit(deck: Deck, script: Path | str, out: Path | str | None = None, *, sbatch: Sequence[str] = (),
           options: Mapping[str, Any] | None = None) -> Job:
    """Hands a deck to Slurm by a job script (scripts/site/slurm/*.sbatch, whose first argument is the deck), and returns the job. The
    deck is written to the output folder. sbatch: options of sbatch, as ["--time=2:00:00"]."""
    folder = output_folder(deck, out)
    path = deck.write(folder.parent / f"{folder.name}.opts")
    return submit_words([str(path), *words_of(options or {}, deck)], script, folder, program_of(deck), sbatch)


def submit_words(words: Sequence[str], script: Path | str, folder: Path, program: str, sbatch: Sequence[str] = ()) -> Job:
    """A job whose script gets some words; it writes to a folder (MPM_OUTPUT) by a program (MPM)."""
    variables = {"MPM_OUTPUT": str(folder), "MPM": program}
    done = subprocess.run(["sbatch", *sbatch, str(script), *words], env=environment(more=variables), capture_output=True, text=True,
                          check=False)
    if done.returncode:
        raise RunFailed(f"sbatch: {done.stderr.strip()}", done.returncode)
    return Job(done.stdout.strip().rpartition(" ")[2], folder)
