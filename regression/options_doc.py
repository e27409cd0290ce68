#!/usr/bin/env python3
"""Writes docs/options.md from what `mpm -help` prints.

Usage: regression/options_doc.py PATH_TO_mpm [--check]   (--check: only report whether the file is up to date)
"""
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = TREE / "docs" / "options.md"
RENAMED = TREE / "lib" / "input" / "deck" / "renamed.cpp"
HEAD = """# Options

Made from `mpm -help` by `regression/options_doc.py`; edit the help, not this file.

    mpm -options_file DECK [-NAME VALUE] ...

A deck holds one option a line; `#` begins a comment. What the command line gives takes precedence over the deck, and the
last of an option given twice holds. Units are SI; in 2D every force and mass is per metre of width, or of the whole
revolution with `-geometry axisymmetric`. A list has commas and no spaces. NAME stands for a name of `-materials`, `-bodies`, `-rigid_bodies` or `-probes`; names are of letters, digits and _, begin
with a letter, and are compared without regard to case. The vertical axis is the last one.

Every mistake is reported in a line of its own before anything is written, and the exit status is then 2. Some options
of PETSc are [taken too](running.md#options-of-petsc).

Some options have new names. Their former names stay accepted, and the log has one line for each: `mpm: note: -rigids is now
-rigid_bodies`. Both names of an option in one file, or both on the command line, are a mistake.

| former name | name |
| --- | --- |
"""


def former_names():
    """[(former, name)] of lib/input/deck/renamed.cpp."""
    table = RENAMED.read_text().partition("k_renamed = {{")[2].partition("}};")[0]
    return re.findall(r'\{"(\w+)", "(\w+)"\}', table)


def dashed(word):
    """An option with its dash; what follows the name of a rigid body with NAME before it."""
    return f"-NAME_{word}" if word.startswith(("contact_", "penalty_", "shear_")) else f"-{word}"


def sections(text):
    """[(title, [(option, meaning, takes, default, when it may change)])] of the help text: blocks of three or four lines under titles."""
    result = []
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if line.startswith("  -"):
            meaning, takes = lines[number + 1].strip(), lines[number + 2].strip()
            takes, _, default = takes.removeprefix("takes ").rpartition("; ")
            after = lines[number + 3].strip() if number + 3 < len(lines) else ""
            changes = after.removeprefix("may change ") if after.startswith("may change ") else ""
            result[-1][1].append((line.strip(), meaning, takes, default.removeprefix("default "), changes))
        elif line and not line.startswith(" ") and number + 1 < len(lines) and lines[number + 1].startswith("  -"):
            result.append((line, []))
    return result


def document(text):
    parts = [HEAD] + [f"| `{dashed(former)}` | `{dashed(name)}` |\n" for former, name in former_names()]
    for title, options in sections(text):
        parts.append(f"\n## {title}\n\n| option | meaning | takes | default | may change |\n| --- | --- | --- | --- | --- |\n")
        parts += [f"| `{option}` | {meaning} | {takes} | {default} | {changes} |\n" for option, meaning, takes, default, changes in options]
    return "".join(parts)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    help_text = subprocess.run([sys.argv[1], "-help"], capture_output=True, text=True, check=True).stdout
    if not sections(help_text):
        sys.exit(f"options_doc: {sys.argv[1]} -help lists no option")
    text = document(help_text)
    if "--check" in sys.argv[2:]:
        if not DOCUMENT.exists() or DOCUMENT.read_text() != text:
            sys.exit(f"options_doc: {DOCUMENT} is out of date; run regression/options_doc.py {sys.argv[1]}")
    else:
        DOCUMENT.write_text(text)
        print(f"wrote {DOCUMENT}")


if __name__ == "__main__":
    main()
