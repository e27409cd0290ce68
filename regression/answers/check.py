#!/usr/bin/env python3
"""Runs small decks whose right answers stand in their own comments, and checks these answers.

Usage: check.py PATH_TO_mpm [DECK ...]      default: every deck of this folder

A comment of a deck holds one of
  # run NAME: OPTIONS     a run of the deck with more options; a deck without such a line has the one run `deck`
  # holds: EXPRESSION     must be true after all runs of the deck
  # prints: WORDS         each run must print a line with these words
  # status: NUMBER        exit status of each run, where it is not 0
  # ranks NAME: NUMBER    ranks of the run NAME, where it is not 1
  # long                  the test is left out of the fast ones
An expression is of Python, with numpy as np, of these:
  at(column, time)        value of a column of history.csv at a time [s], linear between its rows
  column(name)            all rows of a column
  frame(time)             {body: {field: array}} of the frame nearest to a time
  uneven(body, time)      standard deviation of the depth of a column of cells from the mean of both neighbours, over the mean
                          depth, in 2D (unevenness of scripts/soil_mpm/flow.py)
  near(value, exact, by)  |value - exact| <= by |exact|
Each takes `run=NAME` where the deck has several runs; the first one is the default.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import numpy as np

from soil_mpm.flow import depths, unevenness
from soil_mpm.results import Run, read_frame

HERE = pathlib.Path(__file__).resolve().parent


class Deck:
    """A deck and the answers that its comments hold."""

    def __init__(self, path):
        self.path = path
        text = path.read_text()
        self.runs = dict(re.findall(r"^# run (\w+): *(.*)$", text, re.M)) or {"deck": ""}
        self.ranks = {name: int(n) for name, n in re.findall(r"^# ranks (\w+): *(\d+)$", text, re.M)}
        self.holds = re.findall(r"^# holds: *(.*)$", text, re.M)
        self.prints = re.findall(r"^# prints: *(.*)$", text, re.M)
        self.status = int((re.findall(r"^# status: *(\d+)$", text, re.M) or ["0"])[0])
        if not (self.holds or self.prints or self.status):
            sys.exit(f"answers: {path.name} holds no answer")


def run_deck(binary, deck, name, folder):
    """Exit status and output of one run, whose results go to `folder`."""
    ranks = deck.ranks.get(name, 1)
    launch = [os.environ.get("MPIEXEC", "mpirun"), "-n", str(ranks)] if ranks > 1 else []
    command = [*launch, binary, "-options_file", str(deck.path), "-output_dir", str(folder), "-progress", "off",
               *shlex.split(deck.runs[name])]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=deck.path.parent)
    return done.returncode, done.stdout


def words_of(results):
    """The functions that an expression may use, on the runs of a deck."""
    first = next(iter(results))

    def column(name, run=first):
        return results[run].history[name]

    def at(name, time, run=first):
        return float(np.interp(time, column("time", run), column(name, run)))

    def frame(time, run=first):
        return read_frame(results[run].frame_near(time))[1]

    def uneven(body, time, run=first):
        of_run, soil = results[run], frame(time, run)[body]
        cell, per_cell = of_run.number("mesh_spacing"), of_run.number(f"{body}_particles_per_cell")
        half = soil.get("half_length_x", np.full(len(soil["position"]), cell / (2 * per_cell)))
        (lower, upper) = (of_run.numbers("mesh_lower"), of_run.numbers("mesh_upper"))
        return unevenness(depths(soil["position"], soil["volume"], half, lower, cell, round((upper[0] - lower[0]) / cell)))

    def near(value, exact, by):
        print(f"    {value:.6g}, exact {exact:.6g}, allowed {100 * by:g} %")
        return abs(value - exact) <= by * abs(exact)

    return {"np": np, "column": column, "at": at, "frame": frame, "uneven": uneven, "near": near}


def check(binary, deck):
    """Faults of a deck, a line each."""
    faults, results = [], {}
    with tempfile.TemporaryDirectory(prefix="mpm_answers_") as root:
        for name in deck.runs:
            folder = pathlib.Path(root) / name
            status, printed = run_deck(binary, deck, name, folder)
            if status != deck.status:
                return [f"run {name} ended with status {status}, not {deck.status}:\n{printed[-2000:]}"]
            faults += [f"run {name} does not print: {words}" for words in deck.prints if words not in printed]
            if status == 0:
                results[name] = Run(folder)
        for expression in deck.holds:
            if not eval(expression, words_of(results)):
                faults.append(f"does not hold: {expression}")
    return faults


def main():
    binary = str(pathlib.Path(sys.argv[1]).resolve())
    names = sys.argv[2:] or sorted(path.stem for path in HERE.glob("*.opts"))
    failed = 0
    for name in names:
        print(f"{name}", flush=True)
        faults = check(binary, Deck(HERE / f"{name}.opts"))
        failed += bool(faults)
        print("\n".join(f"  FAIL {fault}" for fault in faults) if faults else "  right", flush=True)
    print(f"{len(names) - failed} passed, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
