#!/usr/bin/env python3
"""Checks that wrong input is refused, with the right words and before anything is written.

Usage: check.py PATH_TO_mpm [WORD ...]   (WORD: only rows whose options hold it)

Each row of wrong_input.tsv is run by itself in an empty folder with base.opts, a deck that is right. Checked are the
exit status, that stderr has exactly the lines expected, each of which names what was given and what is taken, that
a refused or dry run left no file behind, and that a good one wrote into its output folder and the cache only. Rows of status 3 are runs that fail on their way: their one line says where and when.
Rows of status 0 that expect lines are runs that warn, or that note a former name of an option: each line is on stdout, and in
the log if there is one.

Beside options of mpm a row may have
    !NAME         that line of base.opts is left out; !options_file: the deck is not given
    +FILE=TEXT    a file in the folder; ~ is a space in it, ; a line end. +stdin=TEXT is the standard input
    NAME=VALUE    a variable of the environment
"""
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
# Open MPI on one rank: no daemon, which takes half of a start, and no session folder, which runs at the same time would share.
QUICK_START = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_orte_create_session_dirs": "0"}


def read_rows(path):
    """(status, options, fragments) of each row."""
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            status, options, *fragments = line.split("\t")
            yield int(status), options.replace("{here}", str(HERE)), fragments


def write_deck(folder, left_out):
    lines = (HERE / "base.opts").read_text().splitlines()
    kept = [line for line in lines if line.split()[0].lstrip("-") not in left_out]
    deck = folder / "base.opts"
    deck.write_text("\n".join(kept) + "\n")
    return deck


def run(binary, options, folder, cache):
    """The result, and the files that were there before. cache: of measurements, which all runs share."""
    words = options.split()
    left_out = [word[1:] for word in words if word.startswith("!")]
    deck = write_deck(folder, left_out)
    environment = dict(os.environ, **QUICK_START, OMP_PROC_BIND="false", OMP_NUM_THREADS="1", HOME=str(folder), XDG_CACHE_HOME=str(cache))
    command = [binary] + ([] if "options_file" in left_out else ["-options_file", str(deck)])
    there, given = {deck.name}, None
    for word in words:
        name, _, text = word.partition("=")
        if word.startswith("+"):
            text = text.replace("~", " ").replace(";", "\n") + "\n"
            if name == "+stdin":
                given = text
            else:
                (folder / name[1:]).write_text(text)
                there.add(name[1:])
        elif name.isupper() and "=" in word:
            environment[name] = text
        elif not word.startswith("!"):
            command.append(word)
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120,
                          input=given), there


def match(lines, fragments):
    """Differences between the lines of stderr and the fragments expected, each in a line of its own."""
    left = list(lines)
    faults = []
    for fragment in fragments:
        found = next((line for line in left if fragment in line), None)
        if found is None:
            faults.append(f"no line has: {fragment}")
        else:
            left.remove(found)
    faults += [f"not expected: {line}" for line in left]
    return faults


def not_of_our_form(lines):
    return [f"not of our form: {line}" for line in lines
            if not (line.startswith("mpm: ") and "given" in line and ", takes " in line)]


def check(binary, cache, status, options, fragments):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        result, there = run(binary, options, folder, cache)
        written = sorted(path.name for path in folder.iterdir() if path.name not in there)
        results = {path.name for path in folder.glob("out/*/*")}
        logs = [path.read_text().splitlines() for path in folder.glob("out/*/mpm.log")]
    faults = [] if result.returncode == status else [f"status {result.returncode}, expected {status}"]
    if status == 0 and fragments:
        for lines in [result.stdout.splitlines()] + logs:
            faults += [fault for fault in match([line for line in lines if line.startswith(("warning: ", "mpm: note: "))], fragments)
                       if not fault.startswith("not expected")]
    if status == 0:
        places = set() if "-dry_run" in options.split() else {"out"}
        faults += [f"written: {path}" for path in written if path not in places]
        if "-log_view :log.txt" in options and "-dry_run" not in options and "log.txt" not in results:
            faults.append("log.txt is not in the output folder")
        faults += [f"stderr: {line}" for line in result.stderr.splitlines() if line.startswith("mpm: -")]
        if "-help" in options and not ("-mesh_spacing\n" in result.stdout and result.stdout.startswith("mpm: ")):
            faults.append("-help does not begin with the program's own words, or does not list -mesh_spacing")
        if "-version" in options and "\n  back ends   serial" not in result.stdout:
            faults.append("-version does not list the back ends")
    else:
        lines = result.stderr.splitlines()
        faults += match(lines, fragments)
        if status == 2:
            faults += not_of_our_form(lines) + [f"left behind: {path}" for path in written]
    return faults


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    binary, words = str(pathlib.Path(sys.argv[1]).resolve()), sys.argv[2:]
    rows = [row for row in read_rows(HERE / "wrong_input.tsv") if all(word in row[1] for word in words)]
    passed = failed = 0
    # A run mostly waits for MPI to start.
    with tempfile.TemporaryDirectory() as cache, concurrent.futures.ThreadPoolExecutor(3 * (os.cpu_count() or 1)) as pool:
        for (_, options, _), faults in zip(rows, pool.map(lambda row: check(binary, cache, *row), rows)):
            passed, failed = passed + (not faults), failed + bool(faults)
            for fault in faults:
                print(f"{options or '(base.opts)'}\n    {fault}")
    print(f"{passed} passed, {failed} failed")
    sys.exit(1 if failed or not passed else 0)


main()
