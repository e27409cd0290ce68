#!/usr/bin/env python3
"""Clay that collapses, slides and strikes: every run reaches its end, and every kilogram is accounted for.

    collapses.py MPM [--count 200] [--seed 1] [--only K,...] [--jobs 2] [--keep FOLDER] [--precisions double,single] [--limit 300]
                     [--particle_domain WORD] [--every N]

First the collapse of a column in nine variants, then --count random decks (collapse_decks.py) with all strengths, shapes,
sides, velocity updates, strategies, back ends and one to four ranks. --only runs some of them: numbers of random decks, or
names of variants; --every 4 takes every fourth variant. Of each run:

- the exit status is 0, and the last row is that of the end;
- mass in the mesh + mass lost = mass of the first row, in each row, up to round-off; where no side is free none is lost;
- every number of the history is finite, and each body lies inside the mesh;
- kinetic energy never exceeds that of the start and what gravity has given since.

A deck that fails is printed whole, with the command that runs it again. --keep keeps the folders of those.
"""
import argparse
import collections
import concurrent.futures
import csv
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.dont_write_bytecode = True
from collapse_decks import named_decks, random_deck  # noqa: E402
from folders import ENVIRONMENT, fresh  # noqa: E402

ROUND_OFF = {"double": 1e-12, "single": 1e-6}  # of the mass
TIME_LIMIT = 300  # s a run
ENERGY_SLACK = 0.05  # of the energy so far: steps are explicit, and nodes see the particles' mass spread


def launch(program, deck, folder):
    """Runs a deck: (exit status or None where it took too long, what it printed on stderr)."""
    folder.mkdir(parents=True)
    if deck.ground:
        deck.ground.write(folder / "start.h5")
        deck.options.update({name: folder / "start.h5" for name in deck.options if name.endswith("_file")})
    (folder / "deck.opts").write_text(deck.text())
    ranks = ["mpirun", "-n", str(deck.ranks), "--bind-to", "none"] if deck.ranks > 1 else []
    command = [*ranks, str(program), "-options_file", str(folder / "deck.opts"), "-output_dir", str(folder / "out"),
               "-output_frames", "on" if deck.frames else "off", "-progress", "off"]
    environment = {**ENVIRONMENT, "OMP_NUM_THREADS": str(deck.threads), "OMP_WAIT_POLICY": "passive",
                   "OMPI_MCA_orte_tmpdir_base": str(folder)}  # runs at once clear each other's
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               errors="replace", start_new_session=True)
    try:
        _, stderr = process.communicate(timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        _, stderr = process.communicate()
        return None, stderr
    return process.returncode, stderr


def read_history(path):
    """{column: array [rows]}."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).T))


# ---------------------------------------------------------------------------------------------- what must hold


def mass_faults(deck, history, body):
    missing = [name for name in (f"{body}_mass", f"{body}_lost_mass") if name not in history]
    if missing:
        yield f"history.csv has no column {', '.join(missing)}"
        return
    kept, lost = history[f"{body}_mass"], history[f"{body}_lost_mass"]
    if not kept[0] > 0 or lost[0] != 0:
        yield f"{body} starts with {kept[0]:.17g} kg and {lost[0]:.17g} kg lost"
        return
    error = np.abs(kept + lost - kept[0]) / kept[0]
    row = int(error.argmax())
    if not error[row] <= ROUND_OFF[deck.options.get("precision", "double")]:
        yield (f"mass of {body}: row {row} (t = {history['time'][row]:.6g} s) has {kept[row]:.17g} kg and {lost[row]:.17g} kg"
               f" lost of {kept[0]:.17g} kg: {error[row]:.2g} of it")
    if (np.diff(lost) < 0).any():
        yield f"lost mass of {body} grows smaller"
    sides = [deck.options.get(f"mesh_{axis}{end}") for axis in "xyz"[:deck.dim] for end in ("min", "max")]
    if "free" not in sides and deck.options.get("stray_particles") != "remove" and lost.any():
        yield f"{body} lost {lost.max():.6g} kg where no side is free"


def finite_faults(history):
    for name, values in history.items():
        if not np.isfinite(values).all():
            row = int((~np.isfinite(values)).argmax())
            yield f"{name} is {values[row]} in row {row} (t = {history['time'][row]:.6g} s)"


def place_faults(deck, history, body):
    """A body, while there is any of it, lies inside the mesh."""
    there = history.get(f"{body}_mass", np.ones(len(history["time"]))) > 0
    slack = (1e-9 if deck.options.get("precision", "double") == "double" else 1e-4) * float(deck.value("mesh_spacing"))
    for axis, lower, upper in zip("xyz", *deck.mesh()):
        least, most = (history[f"{body}_{axis}{end}"][there] for end in ("min", "max"))
        # What has passed a free side leaves at the next rebuild of the bins, after half a cell at most.
        below, above = (slack + (deck.options.get(f"mesh_{axis}{end}") == "free") * float(deck.value("mesh_spacing")) / 2
                        for end in ("min", "max"))
        if there.any() and (least.min() < lower - below or most.max() > upper + above):
            yield (f"{body} reaches {axis} = {least.min():.12g} to {most.max():.12g} m, the mesh {lower:.12g} to"
                   f" {upper:.12g} m")


def energy_faults(deck, history):
    """Kinetic energy beyond that of the start and what gravity gave: each particle that is lost may have left at the
    place of the mesh where gravity gives the most. Water carries up to the share deck.lift of soil that rises."""
    g = np.array([float(x) for x in deck.value("gravity").split(",")])
    corners = deck.mesh()
    lowest = sum(max(a * lower, a * upper) for a, lower, upper in zip(g, *corners))  # J/kg
    kinetic = given = heavy = 0
    for body in deck.bodies():
        mass = history[f"{body}_mass"]
        lost = history[f"{body}_lost_mass"]
        height = sum(a * history[f"{body}_centre_{axis}"] for a, axis in zip(g, "xyz"))
        kinetic = kinetic + history[f"{body}_kinetic_energy"]
        given = given + np.where(mass > 0, mass * height, 0) + lost * lowest - mass[0] * height[0]
        heavy += mass[0]
    given = np.where(given < 0, (1 - deck.lift) * given, given)
    cell = float(deck.value("mesh_spacing"))
    scale = kinetic[0] + np.maximum.accumulate(np.abs(given)) + heavy * np.linalg.norm(g) * cell
    excess = kinetic - kinetic[0] - given - ENERGY_SLACK * scale
    row = int(excess.argmax())
    if not excess[row] <= 0:
        yield (f"energy grows without a source: row {row} (t = {history['time'][row]:.6g} s) has {kinetic[row]:.6g} J, the start"
               f" {kinetic[0]:.6g} J, and gravity gave {given[row]:.6g} J")


def faults_of(deck, status, stderr, folder):
    """What is wrong with a run that has ended."""
    lines = sorted((line for line in stderr.splitlines() if line.strip()), key=lambda line: not line.startswith("mpm:"))
    told = "".join(f"\n    {line}" for line in lines[:5])  # ours before those of the launcher
    if status is None:
        return [f"no end within {TIME_LIMIT:g} s{told}"]
    if status != 0:
        return [f"exit status {status}{told}"]
    history = read_history(folder / "out" / "history.csv")
    end = float(deck.value("time_end"))
    faults = [] if abs(history["time"][-1] - end) <= 1e-9 * end else [f"the last row is of {history['time'][-1]:.9g} s"]
    faults += finite_faults(history)
    for body in deck.bodies():
        faults += [*mass_faults(deck, history, body), *place_faults(deck, history, body)]
    if not deck.loaded and all(f"{body}_{column}" in history for body in deck.bodies() for column in ("mass", "lost_mass")):
        faults += energy_faults(deck, history)
    return faults


def more_faults(program, deck, folder):
    """What else a deck of a script that imports this one demands of a run that is sound so far."""
    return []


# ---------------------------------------------------------------------------------------------- all of them


def try_deck(program, deck, folder):
    """(seconds, faults) of a deck."""
    started = time.monotonic()
    try:
        faults = faults_of(deck, *launch(program, deck, folder), folder) or more_faults(program, deck, folder)
    except (OSError, ValueError, KeyError) as error:
        faults = [f"{type(error).__name__}: {error}"]
    return time.monotonic() - started, faults


def kind_of(fault):
    """A fault without its numbers, to count those alike: what the program told, else the first line."""
    lines = [line.strip() for line in fault.splitlines()]
    told = next((line for line in lines if line.startswith("mpm: ")), lines[0])
    return re.sub(r"-?\d[\d.e+-]*", "N", told)


def report(number, deck, seconds, faults, arguments):
    key = deck.name if number is None else str(number)
    how = f"{deck.ranks} ranks" if deck.ranks > 1 else f"{deck.threads} threads" if deck.threads > 1 else "1 core"
    print(f"{'FAIL' if faults else 'ok  '} {deck.name}, {deck.dim}D, {how}, {seconds:.1f} s", flush=True)
    if not faults:
        return
    for fault in faults:
        print(f"  {fault}")
    again = [sys.argv[0], arguments.program, "--seed", str(arguments.seed), "--only", key]
    again += ["--particle_domain", arguments.particle_domain] if arguments.particle_domain else []
    print(f"  again: {shlex.join(again)}\n  OMP_NUM_THREADS={deck.threads}, {deck.ranks} ranks of")
    print("".join(f"    {line}\n" for line in deck.text().splitlines()), flush=True)


def chosen_decks(arguments):
    """(number or None, deck) of all that is to be run."""
    wanted = arguments.only.split(",") if arguments.only else None
    decks = [(None, deck) for deck in named_decks()[::arguments.every] if wanted is None or deck.name in wanted]
    numbers = range(arguments.count) if wanted is None else [int(word) for word in wanted if word.isdigit()]
    decks += [(k, random_deck(arguments.seed, k)) for k in numbers]
    known = arguments.precisions.split(",")
    for _, deck in decks:
        if arguments.particle_domain:
            deck.options["particle_domain"] = arguments.particle_domain
        if deck.options.get("precision", "double") not in known:
            deck.options["precision"] = known[0]
    return decks


def main():
    global TIME_LIMIT
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=200, help="of random decks")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="numbers of random decks and names of variants, with commas")
    parser.add_argument("--jobs", type=int, default=1, help="runs at once")
    parser.add_argument("--keep", type=pathlib.Path, help="where folders of decks that fail are kept")
    parser.add_argument("--precisions", default="double,single", help="those that the program is built for")
    parser.add_argument("--limit", type=float, default=TIME_LIMIT, help="s that a run may take")
    parser.add_argument("--every", type=int, default=1, help="of the variants every such one")
    parser.add_argument("--particle_domain", help="of all runs, in lieu of the default")
    arguments = parser.parse_args()
    TIME_LIMIT = arguments.limit
    decks, kinds = chosen_decks(arguments), collections.Counter()
    if not decks:
        parser.error(f"--only: no deck is {arguments.only}")
    program, failed = pathlib.Path(arguments.program).absolute(), []
    with tempfile.TemporaryDirectory(prefix="mpm_collapses_") as place, \
            concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        folders = [pathlib.Path(place) / str(k) for k in range(len(decks))]
        runs = pool.map(lambda pair: try_deck(program, pair[0][1], pair[1]), zip(decks, folders))
        for (number, deck), folder, (seconds, faults) in zip(decks, folders, runs):
            report(number, deck, seconds, faults, arguments)
            if faults:
                failed.append(deck.name)
                kinds.update({kind_of(fault) for fault in faults})
                if arguments.keep:
                    kept = fresh(arguments.keep / deck.name.replace(": ", "_").replace(" ", "_"))
                    shutil.move(folder, kept)
    for kind, count in kinds.most_common():
        print(f"  {count:4} {kind}")
    print(f"{len(decks) - len(failed)} of {len(decks)} runs reached their end with all their mass")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
