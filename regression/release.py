#!/usr/bin/env python3
"""Sets the version of the program in every file that has it, and gives the changes of CHANGELOG.md this version.

    regression/release.py VERSION       such as 0.3.0; the steps of a release: docs/CONTRIBUTING.md

Exit status 1, with nothing written, where a file does not have the present version as often as it should.
"""
import re
import sys
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PLACES = {  # file: the text round the version, and how often it is there
    "CMakeLists.txt": ("project(mpm VERSION {} ", 1),
    "lib/include/mpm/simulation.hpp": ('k_version = "{}"', 1),
    "CITATION.cff": ("version: {}\n", 1),
    "python/soil_mpm/__init__.py": ('__version__ = "{}"', 1),
    "docs/running.md": ("mpm-{}-x86_64", 2),
}


def changed(old, new):
    """{path: text} of the files with the new version."""
    texts = {}
    for name, (form, count) in PLACES.items():
        text = (ROOT / name).read_text()
        if text.count(form.format(old)) != count:
            raise SystemExit(f"{name}: has {form.format(old)!r} {text.count(form.format(old))} times instead of {count}")
        texts[ROOT / name] = text.replace(form.format(old), form.format(new))
    log = ROOT / "CHANGELOG.md"
    heading = re.compile(r"## \[Unreleased\]\n(\nThis will be version [\d.]+\.\n)?")
    texts[log], found = heading.subn(f"## [Unreleased]\n\n## [{new}] - {date.today()}\n", log.read_text())
    if found != 1:
        raise SystemExit(f"CHANGELOG.md: has {found} headings [Unreleased] instead of 1")
    return texts


def main():
    if len(sys.argv) != 2 or not re.fullmatch(r"\d+\.\d+\.\d+", sys.argv[1]):
        raise SystemExit(__doc__)
    old = re.search(r"project\(mpm VERSION ([\d.]+) ", (ROOT / "CMakeLists.txt").read_text())[1]
    for path, text in changed(old, sys.argv[1]).items():
        path.write_text(text)


if __name__ == "__main__":
    main()
