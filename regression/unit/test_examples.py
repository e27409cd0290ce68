#!/usr/bin/env python3
"""The decks of inputs/ and the pages about them: docs/examples.md, the first deck in README.md, docs/first_job.md."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def lines_of(deck):
    """The options of a deck, a line each, without comments."""
    lines = [line.split("#")[0].strip() for line in (ROOT / "inputs" / deck).read_text().splitlines()]
    return [line for line in lines if line]


class Examples(unittest.TestCase):
    def test_the_page_has_every_deck_and_no_other(self):
        listed = re.findall(r"^\| `([^`]+)`", (ROOT / "docs" / "examples.md").read_text(), re.M)
        there = [path.name for path in (ROOT / "inputs").glob("*.opts")] + [f"{path.name}/" for path in (ROOT / "inputs").iterdir() if path.is_dir()]
        self.assertEqual(sorted(listed), sorted(there))

    def test_the_readme_explains_every_line_of_the_first_deck(self):
        section = (ROOT / "README.md").read_text().split("## The first deck\n")[1].split("\n## ")[0]
        explained = re.findall(r"`(-[^`]+)`", "\n".join(row.split(" | ")[0] for row in section.splitlines() if row.startswith("| `")))
        self.assertEqual(explained, lines_of("footing_coarse.opts"))

    def test_the_first_job_shows_every_line_of_its_deck(self):
        blocks = re.findall(r"^    (-.*)$", (ROOT / "docs" / "first_job.md").read_text(), re.M)
        self.assertEqual([line.split("#")[0].strip() for line in blocks], lines_of("trench_beside_building.opts"))


if __name__ == "__main__":
    unittest.main()
