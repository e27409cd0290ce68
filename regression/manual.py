#!/usr/bin/env python3
"""The site of scripts/manual: every link leads to a file and an anchor of the site, nothing is fetched from elsewhere, every page of docs/ is
there, formulas are drawn, and the search has its index.

usage: manual.py [SITE]    makes the site in a folder of its own where none is named; exit status 77 where MkDocs is missing
"""

import html.parser
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[1]
LACKS_TOOLS = 77
FETCHED = {("script", "src"), ("link", "href"), ("img", "src"), ("iframe", "src"), ("source", "src")}


class Page(html.parser.HTMLParser):
    """Links, anchors and paragraphs of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors, self.paragraphs, self.inside, self.in_paragraph = [], {""}, [], 0, False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}
        self.links += [(tag, name, given[name]) for name in ("href", "src") if given.get(name)]
        if tag == "p":
            self.paragraphs.append("")
            self.in_paragraph = True
        self.inside += tag in ("code", "math", "pre", "script", "style")

    def handle_endtag(self, tag):
        self.in_paragraph &= tag != "p"
        self.inside -= tag in ("code", "math", "pre", "script", "style")

    def handle_data(self, data):
        if self.in_paragraph and not self.inside:
            self.paragraphs[-1] += data


def is_elsewhere(link):
    return re.match(r"([a-z]+:|//)", link) is not None


def faults_of(path, pages, site):
    """Lines about a page."""
    page, name, text = pages[path], path.relative_to(site), path.read_text()
    faults = [f"{name}: a formula is left" for _ in re.findall(r"FORMULA\d+X", text)][:1]
    faults += [f"{name}: a list is text: {part[:80]!r}" for part in page.paragraphs if re.search(r"\n(- |\d+\. |\| )", part)]
    faults += [f"{name}: a formula is text: {part[:80]!r}" for part in page.paragraphs if re.search(r"\$[^$\s][^$]*\\[a-z]+[^$]*\$", part)]
    for tag, attribute, link in page.links:
        if is_elsewhere(link):
            if (tag, attribute) in FETCHED and not link.startswith("data:"):
                faults.append(f"{name}: {tag} fetches {link}")
            continue
        place, _, anchor = link.partition("#")
        file = (path.parent / unquote(place.partition("?")[0])).resolve() if place else path
        file = file / "index.html" if file.is_dir() else file
        if not file.exists():
            faults.append(f"{name}: ({link}): no such file")
        elif file in pages and unquote(anchor) not in pages[file].anchors and not anchor.startswith("__"):
            faults.append(f"{name}: ({link}): no such heading")
    return faults


def check(site):
    """All that is wrong with a site, a line each."""
    pages = {path: Page(path.read_text()) for path in sorted(site.rglob("*.html")) if path.name != "404.html" and "source" not in path.parts}
    faults = [line for path in pages for line in faults_of(path, pages, site)]
    for page in (ROOT / "docs").rglob("*.md"):
        place = page.relative_to(ROOT / "docs")
        if site / place.with_suffix(".html") not in pages:
            faults.append(f"{place}: is missing")
        if f"({place})" not in (site / "llms.txt").read_text():
            faults.append(f"llms.txt: {place} is missing")
    faults += [f"llms.txt: ({place}): no such file" for place in re.findall(r"\]\(([^)]+)\)", (site / "llms.txt").read_text())
               if not (site / place).exists()]
    for page in (ROOT / "docs").rglob("*.md"):
        blocks = len(re.findall(r"^```math$|^\$\$.+?\$\$", page.read_text(), re.M | re.S))
        drawn = (site / page.relative_to(ROOT / "docs").with_suffix(".html")).read_text().count('display="block"')
        if drawn < blocks:
            faults.append(f"{page.name}: {drawn} of {blocks} formulas are drawn")
    if "footing_coarse" not in (site / "search" / "search_index.js").read_text():
        faults.append("search: the index lacks footing_coarse")
    return faults, len(pages)


def main():
    with tempfile.TemporaryDirectory() as folder:
        site = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(folder) / "site"
        if len(sys.argv) == 1:
            status = subprocess.run([sys.executable, ROOT / "scripts" / "manual", site], stdout=subprocess.DEVNULL).returncode
            if status:
                return status
        faults, count = check(site.resolve())
    print("\n".join(faults) or f"{count} pages: every link holds")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
