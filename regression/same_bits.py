#!/usr/bin/env python3
"""Whether two programs give the same bits: for a change that must not change a result.

    regression/same_bits.py BEFORE AFTER [--steps 100] [--precisions double,single] [--strategies tile,gather] [--long]
        [--dims 2,3] [--tree-before TREE] [CASE ...]

Runs each case of the suite with both programs on the back end serial, and compares histories and frames bit by bit. --long
takes the long cases too. --tree-before: the source tree of BEFORE, whose decks BEFORE then reads; cases and runs that it
lacks are left out. The exit status is 1 where anything differs, which is listed.
"""
import argparse
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from mpm_regression import cases  # noqa: E402
from mpm_regression.folders import differences  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--precisions", default="double,single")
    parser.add_argument("--strategies", default="tile,gather")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--dims", default="2,3", help="those that both programs have")
    parser.add_argument("--tree-before", type=Path, default=cases.ROOT)
    parser.add_argument("cases", nargs="*")
    return parser.parse_intermixed_args()


def dim_of(case, run):
    """2 or 3: -dim of the run's options, else of its deck."""
    words = (case.root / case.deck).read_text().split() + case.runs[run].split()
    return words[len(words) - words[::-1].index("-dim")] if "-dim" in words else "2"


def compare(given, both, run, variant, strategy, base):
    """Differences between the two programs in one run."""
    more = f"-p2g {strategy} -time_max_steps {given.steps}"
    folders = []
    for name, program, case in (("before", given.before, both[0]), ("after", given.after, both[1])):
        folders.append(base / name)
        cases.run_program(program.absolute(), case, run, variant, base / name, more)
    return differences(*(folder / run for folder in folders))


def main():
    given = arguments()
    count = different = 0
    for name in given.cases or cases.names():
        if name not in cases.places(given.tree_before):
            continue
        former, case = cases.Case(name, given.tree_before.resolve()), cases.Case(name)
        if case.is_long() and not given.long:
            continue
        for variant in case.variants(["serial"], given.precisions.split(",")):
            both = [run for run in case.runs if run in former.runs]
            for run in (run for run in both if dim_of(case, run) in given.dims.split(",")):
                for strategy in given.strategies.split(","):
                    with tempfile.TemporaryDirectory(prefix="mpm_bits_") as folder:
                        found = compare(given, (former, case), run, variant, strategy, Path(folder))
                    count, different = count + 1, different + bool(found)
                    if found:
                        print(f"{name} {run} {variant[1]} {strategy}: {'; '.join(found[:5])}", flush=True)
    print(f"{count} runs with both programs, {different} differ")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
