#!/usr/bin/env python3
"""The PBS script in a chain of jobs, with a qsub of our own: nothing here is a PBS.

    pbs.py MPM

That qsub keeps the variables that it is given and the script; each job then runs as PBS would run it, from its home folder
with PBS_O_WORKDIR set, one after the other until none follows. The end must be that of one run without a limit.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from mpm_regression.folders import ENVIRONMENT, differences, faults_of_folder, run

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parent.parent
DECK = HERE / "small.opts"
OPTIONS = "-p2g gather -time_max_steps 600 -gravity 0,-10 -progress off"  # with a comma, as values may have
QSUB = """#!/bin/bash
[ "$1" = -v ] || exit 1
{ IFS=,; for name in $2; do printf '%s=%s\\n' "$name" "${!name}"; done; } > "$QUEUE.part"
echo "$3" > "$QUEUE.script"; mv "$QUEUE.part" "$QUEUE"
"""


def main():
    binary = pathlib.Path(sys.argv[1]).absolute()
    with tempfile.TemporaryDirectory(prefix="mpm_pbs_") as temporary:
        base = pathlib.Path(temporary)
        began = time.time()
        run(binary, DECK, base / "whole", "-backend", "openmp", *OPTIONS.split())
        limit = (time.time() - began) / 4
        (base / "bin").mkdir()
        (base / "bin/qsub").write_text(QSUB)
        (base / "bin/qsub").chmod(0o755)
        queue = base / "queue"
        environment = {**ENVIRONMENT, "PATH": f"{base / 'bin'}:{os.environ['PATH']}", "QUEUE": str(queue),
                       "PBS_O_WORKDIR": str(ROOT)}
        given = {"DECK": str(DECK), "OPTIONS": OPTIONS, "LIMIT": f"{limit:.3f}", "MPM": str(binary),
                 "MPM_OUTPUT": str(base / "chain")}
        subprocess.run(["qsub", "-v", ",".join(given), "scripts/site/pbs/cpu_node.pbs"], env={**environment, **given}, check=True)
        printed = []
        while queue.exists() and len(printed) < 100:
            job = dict(line.split("=", 1) for line in queue.read_text().splitlines())
            queue.unlink()
            done = subprocess.run(["bash", ROOT / queue.with_suffix(".script").read_text().strip()], cwd=base,
                                  env={**environment, **job, "PBS_JOBID": str(len(printed))}, capture_output=True, text=True)
            printed += [line for line in done.stdout.splitlines() if line.startswith("job ")] or [done.stdout + done.stderr]
        stopped = sum("exit status 75" in line for line in printed)
        assert stopped >= 2 and "exit status 0" in printed[-1], printed
        found = differences(base / "whole", base / "chain") + faults_of_folder(base / "chain")
        assert not found, found
    print(f"{len(printed)} jobs, {stopped} of them stopped before their limit: the same bits as one run that was not stopped")


if __name__ == "__main__":
    main()
