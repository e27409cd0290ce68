#!/usr/bin/env python3
"""Kills a run (SIGKILL) at random moments and goes on from the last checkpoint, over and over.

    kill.py MPM [--kills 200] [--seed 1] [--ranks 1] [--folder FOLDER]

After each kill every file of the output folder must be whole or absent, no checkpoint that was there may have gone
without a later one, and at most one interval may be lost; the end must be, bit by bit, that of a run that was never
killed. As many runs are made as the kills take. On several ranks all are killed, and the launcher before them.
"""
import argparse
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from mpm_regression.folders import ENVIRONMENT, checkpoints, command, differences, faults_of_folder, fresh, kill, launcher, rows, run

HERE = pathlib.Path(__file__).parent
OPTIONS = ("-backend", "serial", "-p2g", "gather")
INTERVAL = 10  # steps between checkpoints in small.opts


def options(ranks):
    return OPTIONS if ranks == 1 else (*OPTIONS, "-time_max_steps", 200)  # ranks that share cores are slow


def start(binary, folder, ranks):
    again = ("-restart", "latest") if checkpoints(folder) else ()
    return subprocess.Popen([*launcher(ranks), *command(binary, HERE / "small.opts", folder, *options(ranks), *again)],
                            env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def step_of(path):
    return int(path.stem.split("_")[1])


def check_after_kill(folder, before):
    """Faults that the kill has left; empty if there is none."""
    faults = faults_of_folder(folder)
    there = [step_of(path) for path in checkpoints(folder)]
    if before and (not there or there[-1] < before[-1]):
        faults.append(f"checkpoint {before[-1]} is lost")
    history = folder / "history.csv"
    if history.exists() and len(rows(folder)) > 1:
        lost = int(rows(folder)[-1][0]) - (there[-1] if there else 0)
        if lost > INTERVAL + 1:
            faults.append(f"{lost} steps are lost")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("binary")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--folder")
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    base = pathlib.Path(arguments.folder or tempfile.mkdtemp(prefix="mpm_kill_"))
    reference, folder = fresh(base / "whole"), fresh(base / "killed")
    began = time.time()
    run(arguments.binary, HERE / "small.opts", reference, *options(arguments.ranks), prefix=launcher(arguments.ranks))
    whole = time.time() - began  # s
    kills = in_checkpoint = unfinished = ends = 0
    while kills < arguments.kills or ends == 0:
        before = [step_of(path) for path in checkpoints(folder)]
        process = start(arguments.binary, folder, arguments.ranks)
        delay = chance.uniform(0, whole / 2) if kills < arguments.kills else 600
        try:
            _, printed = process.communicate(timeout=delay)
        except subprocess.TimeoutExpired:
            kill(process)
            kills += 1
            left = list(folder.rglob("*.tmp"))
            unfinished += bool(left)
            in_checkpoint += any(path.name.startswith("checkpoint_") for path in left)
            faults = check_after_kill(folder, before)
            if faults:
                sys.exit(f"after kill {kills} (seed {arguments.seed}), {delay:.3f} s: " + "; ".join(faults))
            continue
        if process.returncode != 0:
            sys.exit(f"after kill {kills}: exit status {process.returncode}: {printed}")
        different = differences(reference, folder)
        if different:
            sys.exit(f"after kill {kills}, the end differs: " + "; ".join(different))
        ends += 1
        fresh(folder)
    print(f"{kills} kills, {unfinished} of them while a file was being written, {in_checkpoint} a checkpoint: every "
          f"file whole or absent; {ends} runs reached the end with the same bits as one that was not killed")


if __name__ == "__main__":
    main()
