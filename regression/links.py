#!/usr/bin/env python3
"""Every link of the pages leads to a file or a heading that exists, and every page is found from README.md.

usage: links.py [ROOT]
"""
import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[1]).resolve()
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def prose(page):
    """The text without blocks of code, in which brackets are no links."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.S | re.M)
    return "\n".join("" if line.startswith("    ") else re.sub(r"`[^`]*`", "`", line) for line in text.splitlines())


def anchors(page):
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ +(.*?) *$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.S | re.M), re.M)
    found = []
    for heading in headings:
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-")
        found.append(f"{name}-{found.count(name)}" if name in found else name)
    return found


def main():
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    faults, linked = [], {ROOT / "README.md"}
    for page in pages:
        for target in LINK.findall(prose(page).replace("\n", " ")):
            name, _, anchor = target.partition("#")
            if re.match(r"[a-z]+:", target):
                continue
            file = (page.parent / name).resolve() if name else page
            linked.add(file)
            if not file.exists():
                faults.append(f"{page.relative_to(ROOT)}: ({target}): no such file")
            elif anchor and anchor not in anchors(file):
                faults.append(f"{page.relative_to(ROOT)}: ({target}): no such heading")
    faults += [f"{page.relative_to(ROOT)}: no page links to it" for page in pages if page not in linked]
    print("\n".join(faults) or f"{len(pages)} pages: every link holds")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
