#!/usr/bin/env python3
"""The ways of a halo between ranks (-halo_path, -halo_overlap): whether each gives what one rank gives, and how long a step takes.

    regression/halo_paths.py [--binary MPM] [--backend cuda] [--ranks 2] [--paths auto,host,peer] [--no-times] [--no-checks]

Checks: short runs of some decks, by `tile` and `gather`, in double precision, against one rank, with the bounds of compare.py;
`tile` with rebuilds and rows in between as well. Times: the footing strip, 5,898,240 particles a rank (on processors a
64th), us a step on one rank and on several, the time that devices were held up by the halo, and the efficiency. Ends with
status 1 where a run failed or differs. Meant for a machine with a GPU a rank.
"""

import argparse
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from mpm_regression import cases, differences  # noqa: E402
from mpm_regression.compare import BOUNDS  # noqa: E402
from soil_mpm.bench.runs import HISTORY, Setting, performance  # noqa: E402
from soil_mpm.results import Run  # noqa: E402
from soil_mpm.tree import default_program  # noqa: E402

# deck, options, steps. Stresses of the footing grow to what is compared only with time; margins of 0.02 cells make rebuilds.
CHECKS = [("inputs/landslide_coarse.opts", "", 1), ("inputs/landslide_coarse.opts", "", 100),
          ("inputs/footing_coarse.opts", "-f_bar_fraction 0", 100), ("regression/cases/rigid_body/case.opts", "", 100),
          ("inputs/landslide_coarse.opts", "-rebuild_margin 0.02 -history_interval 0.005", 400)]


def run(given, options, ranks, folder):
    """Runs the program; its performance.json, or None where it failed."""
    command = [str(given.binary), "-backend", given.backend, *shlex.split(options), "-output_dir", str(folder), "-progress", "off"]
    if ranks > 1:
        command = [cases.launcher(), "-n", str(ranks), "--bind-to", "none", *command]
    done = subprocess.run(command, cwd=cases.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env={"OMP_NUM_THREADS": "1", **cases.environment()}, timeout=300)
    if done.returncode == 0:
        return performance(folder)
    print(f"FAILED {shlex.join(command)}: exit status {done.returncode}\n{done.stdout[-1500:]}", flush=True)
    return None


def ways(given):
    return [f"-halo_path {path} -halo_overlap {overlap}" for path in given.paths.split(",") for overlap in ("on", "off")]


def check(given, folder):
    """Number of runs that failed or differ."""
    wrong = 0
    for n, (deck, more, steps) in enumerate(CHECKS):
        for strategy in ("gather", "tile"):
            options = f"-options_file {deck} {more} -p2g {strategy} -time_max_steps {steps} -output_interval 1e9"
            alone = folder / f"alone_{n}_{strategy}"
            if run(given, options, 1, alone) is None:
                wrong += 1
                continue
            bound = BOUNDS[1 if steps == 1 else 100]["double"]
            for way in ways(given):
                for partition in ("box", "metis"):
                    if run(given, f"{options} {way} -partition {partition}", given.ranks, folder / "several") is None:
                        wrong += 1
                        continue
                    apart, where = differences.largest(Run(folder / "several"), Run(alone))
                    wrong += not apart <= bound
                    print(f"{'pass' if apart <= bound else 'FAIL'} {deck} {more} {steps} steps, {strategy}, {partition}, {way}: "
                          f"{apart:.2g} apart at {where}, bound {bound:g}", flush=True)
    return wrong


def us_of(report):
    """us a step, without output."""
    return 1e6 * report["stepping_seconds"] / report["steps"]


def times(given, folder):
    particles, wrong = 5898240 // (1 if given.backend == "cuda" else 64), 0
    for precision in ("single", "double"):
        def options(ranks):
            size = Setting("footing", ranks * particles, given.backend, precision, "tile").size()
            return (f"-options_file inputs/footing.opts -precision {precision} -p2g tile -time_max_steps {given.steps}"
                    f" {size} {HISTORY}")
        report = run(given, options(1), 1, folder / "time")
        if report is None:
            wrong += 1
            continue
        alone = us_of(report)
        print(f"{precision}, {particles:,} particles a rank: {alone:.0f} us a step on one rank", flush=True)
        for way in ways(given):
            report = run(given, f"{options(given.ranks)} {way}", given.ranks, folder / "time")
            if report is None:
                wrong += 1
                continue
            us, ranks = us_of(report), report["between_ranks"]
            halo, wait, held = (ranks[name] for name in ("halo_seconds", "wait_seconds", "held_seconds"))
            print(f"  {way}: {us:.0f} us ({100 * alone / us:.1f} %), {ranks['halo_path']}; halo (pack and sum)"
                  f" {halo['least']:.3f} to {halo['most']:.3f} s, wait {wait['least']:.3f} to {wait['most']:.3f} s"
                  + (f"; held up {1e6 * held['most'] / given.steps:.1f} us a step" if held else ""), flush=True)
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=Path, default=default_program())
    parser.add_argument("--backend", default="cuda")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--paths", default="auto,host,peer")
    parser.add_argument("--steps", type=int, default=400)
    parser.add_argument("--no-checks", action="store_true")
    parser.add_argument("--no-times", action="store_true")
    given = parser.parse_args()
    given.binary = given.binary.absolute()  # the launcher of a bundle starts the program that a link names
    with tempfile.TemporaryDirectory() as folder:
        wrong = 0 if given.no_checks else check(given, Path(folder))
        wrong += 0 if given.no_times else times(given, Path(folder))
    print("all agree" if wrong == 0 else f"{wrong} wrong")
    return wrong != 0


if __name__ == "__main__":
    sys.exit(main())
