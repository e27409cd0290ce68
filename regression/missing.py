#!/usr/bin/env python3
"""Checks that the program refuses what docs/method.md lists under "What is not there yet".

Usage: missing.py PATH_TO_mpm

Each item of the list names options in code, as `-clay_permeability 1e-9`. The program gets each of these texts with
wrong_input/base.opts, a deck that it accepts. It must end with status 2 and with a line on stderr that names the last option
of the text, and write nothing.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "method.md"
HEADING = "## What is not there yet\n"


def items():
    """[(title, [options])] of the list: the texts in code that begin with a dash, each on one line."""
    section = PAGE.read_text().split(HEADING)[1].split("\n## ")[0]
    found = []
    for item in re.split(r"^- ", section, flags=re.M)[1:]:
        title = re.match(r"\*(.+?)\.\*", item)
        found.append((title[1] if title else item.splitlines()[0], re.findall(r"`(-[a-z][^`]*)`", item)))
    return found


def run(binary, options):
    """The result of a dry run of base.opts with the options, and the names of the files that it leaves."""
    with tempfile.TemporaryDirectory() as folder:
        command = [binary, "-options_file", str(HERE / "wrong_input" / "base.opts"), "-backend", "serial", *options.split(), "-dry_run"]
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
        return result, sorted(path.name for path in pathlib.Path(folder).iterdir())


def faults_of(binary, options):
    """Yields the faults of the program's answer to options that it should refuse."""
    name = re.findall(r"(?:^|\s)(-[a-z]\w*)", options)[-1]
    result, files = run(binary, options)
    faults = [] if result.returncode == 2 else [f"status {result.returncode}, expected 2"]
    if not re.search(rf"^mpm: {name}\b", result.stderr, re.M):
        faults.append(f"no line names {name}: {result.stderr.strip()}")
    return faults + [f"left behind: {name}" for name in files]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    binary = str(pathlib.Path(sys.argv[1]).resolve())
    accepted, _ = run(binary, "")
    faults = [] if accepted.returncode == 0 else [f"base.opts alone: status {accepted.returncode}: {accepted.stderr}"]
    listed = items()
    for title, texts in listed:
        faults += [] if texts else [f"{title}: names no option"]
        faults += [f"{title}: {options}: {fault}" for options in texts for fault in faults_of(binary, options)]
    if not listed:
        faults.append(f"{PAGE.name} has no list under \"{HEADING.strip()}\"")
    print("\n".join(faults) or f"{sum(len(texts) for _, texts in listed)} options of {len(listed)} items: the program refuses each")
    sys.exit(1 if faults else 0)


main()
