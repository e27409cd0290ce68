#!/usr/bin/env python3
"""Writes docs/options.md, one long table, and docs/options/, a page for each group, from what `mpm -schema` prints.

Usage: regression/options_doc.py PATH_TO_mpm [--check]   (--check: only report whether the file is up to date)
"""
import json
import os
import pathlib
import subprocess
import sys

import option_pages

TREE = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = TREE / "docs" / "options.md"
CHANGES = {"restart": "at a restart", "restart_change": "by -restart_change", "stage": "at a stage"}
HEAD = """# Options

Made from `mpm -schema` by `regression/options_doc.py`; edit the tables of `lib/input/options`, not this file. `mpm -help NAME` prints one option.

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


def dashed(word):
    """An option with its dash; what follows the name of a rigid body with NAME before it."""
    return f"-NAME_{word}" if word.startswith(("contact_", "penalty_", "shear_")) else f"-{word}"


def text_of(condition):
    """A condition of the schema in words."""
    words = condition["is"]
    either = " or ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
    return f"-{condition['option']} " + (f"is {either}" if words else "is given" if condition["given"] else "is not given")


def row(option):
    """A line of the table of an option. The group of a law says of which model its options are."""
    where = [text_of(each) for each in option.get("where", []) if each["option"] != "NAME_model"]
    default = "required" if option["required"] else "none" if option["default"] is None else option["default"]
    changes = ", ".join(CHANGES[each] for each in option.get("changes", []))
    takes = "; ".join([option["takes"], *option.get("restrictions", [])])
    return f"| `-{option['name']}` | {option['meaning']} | {takes} | {default} | {' and '.join(where)} | {changes} |\n"


def document(schema):
    parts = [HEAD] + [f"| `{dashed(former)}` | `{dashed(name)}` |\n" for former, name in schema["former"]]
    group = None
    for option in schema["options"]:
        if option["group"] != group:
            group = option["group"]
            parts.append(f"\n## {group}\n\n[With an example and related options of each](options/{option_pages.file_of(group)})\n\n"
                         "| option | meaning | takes | default | only where | may change |\n"
                         "| --- | --- | --- | --- | --- | --- |\n")
        parts.append(row(option))
    return "".join(parts)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    program = pathlib.Path(sys.argv[1]).resolve()
    os.chdir(option_pages.ROOT)  # decks include others by paths from there
    text = subprocess.run([program, "-schema"], capture_output=True, text=True, check=True).stdout
    schema = json.loads(text)
    if not schema["options"]:
        sys.exit(f"options_doc: {sys.argv[1]} -schema lists no option")
    pages = {DOCUMENT: document(schema)}
    pages |= {option_pages.FOLDER / name: page for name, page in option_pages.Pages(text, schema, program).all().items()}
    stale = sorted(set(option_pages.FOLDER.glob("*.md")) - set(pages))
    if "--check" in sys.argv[2:]:
        differ = [path for path, page in pages.items() if not path.exists() or path.read_text() != page]
        if differ or stale:
            sys.exit(f"options_doc: {', '.join(map(str, differ + stale))}: out of date; run regression/options_doc.py {sys.argv[1]}")
        return
    option_pages.FOLDER.mkdir(exist_ok=True)
    for path, page in pages.items():
        path.write_text(page)
    for path in stale:
        path.unlink()
    print(f"wrote {DOCUMENT} and {len(pages) - 1} pages of {option_pages.FOLDER}")


if __name__ == "__main__":
    main()
