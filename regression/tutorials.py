#!/usr/bin/env python3
"""Holds the pages of docs/tutorials against the program: each figure of a page is the one that its commands and its code give.

usage: tutorials.py PATH_TO_mpm NAME ... [--docs] [--out FOLDER [--again]]    runs the tutorials of these names (all: every one)
       tutorials.py --index                           compares the table of docs/tutorials/index.md and the decks with the pages, without a run

A page has one table of figures, | figure | here | exact or published | within | source |, which is the source of the test: `here` is what the
page says, `within` how far a run may be from it. The commands are the lines of its ```sh blocks, run in a folder of their own that has inputs/ and
scripts/; `mpm` lines are for readers without Python and are left out, as are pictures. Its ```python blocks, run after them as one text,
make a dict `figures` with a number for each row. --docs writes the numbers into the table, and copies pictures: docs/images/tutorials/NAME_x.png is x.png of a run.
--out keeps the results in FOLDER/NAME; --again reads them there and runs nothing.
"""

import argparse
import contextlib
import json
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "tutorials"
HEAD = "| figure | here | exact or published | within | source |"
LARGE = 145e3  # bytes of a picture
PICTURES = ("soil-mpm plot", "soil-mpm report", "scripts/plot")
ROW = re.compile(r"^\| \[[^\]]*\]\((\w+)\.md\) \|(.*)\| (fast|long) \|$", re.M)


def names():
    """Names of the tutorials, in the order of the index."""
    return [found[0] for found in ROW.findall((PAGES / "index.md").read_text())]


def deck_of(name):
    """The deck of a tutorial, as the index has it."""
    return next(cells_of(rest)[0].strip("`") for each, rest, _ in ROW.findall((PAGES / "index.md").read_text()) if each == name)


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


class Page:
    """A tutorial: its commands, its code and the rows of its figures."""

    def __init__(self, name):
        self.name, self.path = name, PAGES / f"{name}.md"
        self.text = self.path.read_text()
        shell = re.findall(r"^```sh\n(.*?)^```", self.text, re.M | re.S)
        self.commands = [line for line in "".join(shell).splitlines() if line and not line.startswith("#")]
        self.code = "\n".join(re.findall(r"^```python\n(.*?)^```", self.text, re.M | re.S))
        table = self.text.split(HEAD)[1].split("\n\n")[0].splitlines()[2:]
        self.rows = [cells_of(line) for line in table]
        self.lines = table

    def pictures(self):
        """Names of its pictures in docs/images/tutorials."""
        return re.findall(rf"\(\.\./images/tutorials/({self.name}_\w+\.png)\)", self.text)

    def write_figures(self, figures):
        """Puts numbers of a run into the column `here`, with as many digits as are there."""
        for line, row in zip(self.lines, self.rows):
            digits = len(re.sub(r"[^0-9]", "", row[1]).lstrip("0")) or 3
            row[1] = f"{figures[row[0]]:#.{max(digits, 2)}g}".rstrip(".")
            self.text = self.text.replace(line, f"| {' | '.join(row)} |")
        self.path.write_text(self.text)


def run_command(line, folder, environment, with_pictures):
    """Runs a line of a page; the lines of a run that says why it failed."""
    if line.startswith("mpm ") or (line.startswith(PICTURES) and not with_pictures):
        return ""
    words = shlex.split(line.partition("  #")[0])
    if words[0] == "soil-mpm":
        words[0] = str(ROOT / "scripts" / "soil-mpm")
        words += ["--no-pictures"] * (words[1] == "run" and not with_pictures)
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True)
    return "" if done.returncode == 0 else f"{line}: exit status {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}"


def figures_of(page, folder, environment):
    """The dict that the code of a page makes, read in a process of its own; and what it said where it failed."""
    code = page.code + "\nimport json as _json\nprint('\\nfigures ' + _json.dumps({name: float(value) for name, value in figures.items()}))\n"
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        return {}, done.stderr[-2000:]
    return json.loads(done.stdout.rpartition("\nfigures ")[2]), ""


def faults_of(page, figures):
    """Lines about figures that differ from the page."""
    if sorted(figures) != sorted(row[0] for row in page.rows):
        return [f"the code has the figures {sorted(figures)}, the page {sorted(row[0] for row in page.rows)}"]
    faults = []
    for name, here, known, within, _ in page.rows:
        value, says, share = figures[name], float(here), float(within.rstrip(" %")) / 100
        print(f"    {name}: {value:.6g}, the page says {here} within {within}; exact or published {known}", flush=True)
        if not abs(value - says) <= share * abs(says):
            faults.append(f"{name}: {value:.6g}, the page says {here} within {within}")
    return faults


@contextlib.contextmanager
def folder_of(name, out):
    """A folder for the runs of a tutorial, which goes where no --out is given, with links to what its commands name."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(out).resolve() / name if out else pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for part in ("inputs", "scripts", "python"):
            if not (folder / part).is_symlink():
                (folder / part).symlink_to(ROOT / part)
        yield folder


def run_page(name, given):
    """Runs a tutorial; lines about what is wrong."""
    page, program = Page(name), str(pathlib.Path(given.program).resolve())
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPM_PROGRAM": program, "MPM": program, "MPM_PYTHON": sys.executable,
                   "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg", "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "2")}
    with folder_of(name, given.out) as folder:
        for line in [] if given.again else page.commands:
            fault = run_command(line, folder, environment, given.docs)
            if fault:
                return [fault]
        figures, fault = figures_of(page, folder, environment)
        if fault:
            return [fault]
        if given.docs:
            page = Page(name)  # as it is by now, after runs of minutes
            page.write_figures(figures)
            copy_pictures(page, folder)
    return faults_of(page, figures)


def copy_pictures(page, folder):
    """Copies the pictures of the runs of a page; large ones lose pixels and colours until they are small."""
    for name in page.pictures():
        stem = name.removeprefix(f"{page.name}_")
        found = sorted((folder / "out").rglob(stem), key=lambda path: (path.parent.name != deck_of(page.name), path))
        if not found:
            sys.exit(f"tutorials: {page.name}: no run has drawn {stem}")
        place = ROOT / "docs" / "images" / "tutorials" / name
        shutil.copyfile(found[0], place)
        if place.stat().st_size > LARGE:
            shrink(place, 1300)


def shrink(place, width):
    """Writes a picture with fewer pixels and 256 colours, of which few are spent on a grey background."""
    from PIL import Image
    picture = Image.open(place).convert("RGB")
    if picture.width > width:
        picture = picture.resize((width, round(width * picture.height / picture.width)), Image.Resampling.LANCZOS)
    picture.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(place, optimize=True)


def key_of(option):
    """An option without the name of its owner, and with the same number in all names: fill_2_shape is that of fill_1_shape."""
    return re.sub(r"\d+", "1", option).partition("_")[2]


def check_deck(page):
    """Lines about options of the deck that the page does not explain, by themselves or by the same one of another name, and about values that
    differ from the deck's; a value that ends with ... is the beginning of one."""
    path = next(path for path in (ROOT / "inputs").rglob(f"{deck_of(page.name)}.opts"))
    lines = [line.split("#")[0].split(maxsplit=1) for line in path.read_text().splitlines()]
    deck = {words[0]: words[1].strip() if len(words) > 1 else "" for words in lines if words}
    said = dict.fromkeys(re.findall(r"`(-[a-z]\w*)[ `]", page.text))
    keys = {key_of(name) for name in said}
    faults = [f"{page.name}: {name} of {path.name} is not explained" for name in deck if name not in said and key_of(name) not in keys]
    for name, value in re.findall(r"`(-[a-z]\w*) ([^`]+)`", page.text.split("## The deck")[1].split("\n## ")[0]):
        given = deck.get(name)
        if given is not None and given != value and not (value.endswith("...") and given.startswith(value[:-3])):
            faults.append(f"{page.name}: {name} is {given} in {path.name}, the page says {value}")
    return faults


def check_index():
    """Lines about rows of the index that differ from the pages, about decks, and about pictures that are too large or missing."""
    index = {name: cells_of(rest) for name, rest, _ in ROW.findall((PAGES / "index.md").read_text())}
    pages = {path.stem for path in PAGES.glob("*.md")} - {"index"}
    faults = [f"{name}: is not in the index" for name in sorted(pages - set(index))]
    for name in index:
        page = Page(name)
        figure, here, known = page.rows[0][:3]
        faults += check_deck(page)
        if index[name][1:4] != [figure, here, known]:
            faults.append(f"{name}: the index says {index[name][1:4]}, the page {[figure, here, known]}")
        for picture in page.pictures():
            place = ROOT / "docs" / "images" / "tutorials" / picture
            if not place.exists() or place.stat().st_size > LARGE:
                faults.append(f"{picture}: is missing, or larger than {LARGE / 1e3:.0f} kB")
    return faults


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("names", nargs="+")
    parser.add_argument("--docs", action="store_true")
    parser.add_argument("--out")
    parser.add_argument("--again", action="store_true")
    return parser.parse_args()


def main():
    if sys.argv[1:] == ["--index"]:
        faults = check_index()
        print("\n".join(faults) or "the index has what the pages have")
        return 1 if faults else 0
    given, failed = parse(), 0
    for name in names() if given.names == ["all"] else given.names:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        faults = run_page(name, given)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"{name}: {after.ru_utime - before.ru_utime:.1f} s of processor time", *faults, sep="\n    ", flush=True)
        failed += bool(faults)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
