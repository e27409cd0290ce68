#!/usr/bin/env python3
"""soil-mpm report: one HTML file of a run, whole and without a reference to anything else, with checks that find what is wrong.

usage: test_report_page.py PATH_TO_mpm

Where there is a Chromium, the page is opened in it.
"""

import contextlib
import html.parser
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
os.environ["MPM_PROGRAM"] = str(PROGRAM)

from soil_mpm import Deck, NoSuchResult, Run, __main__
from soil_mpm.report import charts, write
from soil_mpm.report.checks import checks_of
from soil_mpm.report.log import Log

EMPTY = {"meta", "img", "br", "path", "link", "input"}
COARSE = {"mesh_spacing": 0.25, "mesh_upper": (3, 4.5), "time_end": 0.1, "backend": "serial", "output_energy": True}


class Page(html.parser.HTMLParser):
    """Elements of a page with their attributes, and whether each that opens closes."""

    def __init__(self, text):
        super().__init__()
        self.open, self.found, self.text = [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        if self.open.pop() != tag:
            raise AssertionError(f"</{tag}> closes another element")

    def handle_data(self, data):
        self.text.append(data)


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name) / "a <run> & more"
        Deck.read("footing_coarse").copy(**COARSE).run(cls.folder, progress=False)
        with contextlib.redirect_stdout(io.StringIO()):
            cls.path = write(cls.folder)
        cls.text = cls.path.read_text()
        cls.page = Page(cls.text)

    def test_elements_close(self):
        self.assertEqual(self.page.open, [])
        words = "".join(self.page.text)
        for word in ("a <run> & more", "What was run", "Checks of trust", "-clay_su", "plate_force_y", "2D, plane strain"):
            self.assertIn(word, words)

    def test_nothing_is_fetched(self):
        for tag, attributes in self.page.found:
            for name in ("src", "href", "action", "data", "xlink:href", "srcset"):
                self.assertTrue(attributes.get(name, "data:").startswith("data:"), f"{tag} {name}")
            self.assertNotIn(tag, ("link", "iframe", "object", "base"))
        self.assertNotRegex(self.text, r"https?://|@import|url\(|fetch\(|XMLHttpRequest")

    def test_pictures_and_curves(self):
        images = [attributes for tag, attributes in self.page.found if tag == "img"]
        self.assertEqual(sorted(each["alt"] for each in images), ["curve", "field"])
        told = [json.loads(text) for text in re.findall(r'<script type="application/json">(.*?)</script>', self.text)]
        self.assertEqual(len(told), len([1 for tag, attributes in self.page.found if attributes.get("class") == "chart"]))
        run = Run(self.folder)
        np.testing.assert_allclose(told[0]["x"][-1], -run["plate_y"][-1], rtol=1e-5)
        np.testing.assert_allclose(told[0]["lines"][1][-1], run["plate_force_y"][-1] / 1e3, rtol=1e-5)

    def test_a_sound_run(self):
        for check in checks_of(Run(self.folder), Log.read(self.folder / "mpm.log")):
            if check.name != "Warnings of the program":
                self.assertEqual(check.verdict, "good", check)

    def test_unsound_runs(self):
        """Each fault of a history shows in its check, and in no other."""
        faults = {"soil_mass": ("Mass that is missing in the balance", 0.9), "energy_error": ("Energy that is missing in the balance", 1e6),
                  "empty_cells": ("Empty cells inside the soil, at most", 50), "soil_strays": ("Particles that are alone, at most", 50),
                  "soil_limited": ("Particles with a volume at its bound, at most", 1), "soil_put_back": ("Particles put back at walls", 9),
                  "dt": ("Time step", 1e-9), "work_update": ("Energy that the velocity update took", -1e6)}
        for column, (name, value) in faults.items():
            run, log = Run(self.folder), Log.read(self.folder / "mpm.log")
            log.warnings = []
            run.history[column] = run[column].copy()
            run.history[column][-2] = value if column != "soil_mass" else 0.9 * run[column][0]
            doubts = {check.name for check in checks_of(run, log) if check.verdict == "doubt"}
            self.assertIn(name, doubts)
            self.assertLessEqual(doubts - {name}, {"Momentum that is missing in the balance", "Energy that the velocity update took"}, column)

    def test_the_last_step_may_be_short(self):
        run = Run(self.folder)
        run.history["dt"][-1] = 1e-12
        self.assertNotIn("doubt", {check.verdict for check in checks_of(run, Log.read(self.folder / "mpm.log")) if check.name == "Time step"})

    def test_a_run_that_failed(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder) / "killed"
            shutil.copytree(self.folder, copy, ignore=shutil.ignore_patterns("*.png", "performance.json", "frames"))
            with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
                page = Page(write(copy).read_text())
            self.assertIn("End of the run", "".join(page.text).split("Look at: ")[1].split(".")[0])
            with self.assertRaisesRegex(NoSuchResult, "no results of a run"):
                write(folder)

    def test_a_certificate(self):
        found = {"answer": "plate_force_y at end", "spacings": [0.1, 0.2, 0.4], "values": [1.0, 1.1, None], "bar": 0.1, "verdict": "converged",
                 "why": "the bar is <small>", "notes": ["a note"]}
        place = self.folder.parent / "certify" / self.folder.name
        place.mkdir(parents=True)
        (place / "certificate.json").write_text(json.dumps(found))
        text = write(self.folder, self.folder.parent / "with.html", pictures=False).read_text()
        self.assertIn("plate_force_y at end: 1 ± 0.1", text)
        self.assertIn("the bar is &lt;small&gt;", text)
        shutil.rmtree(place)

    def test_command(self):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            self.assertEqual(__main__.main(["report", str(self.folder), "--no-pictures", "--out", str(self.folder / "b.html")]), 0)
        self.assertEqual(out.getvalue().strip(), str(self.folder / "b.html"))
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(__main__.main(["report", str(self.folder.parent / "none")]), 2)

    @unittest.skipUnless(shutil.which("chromium"), "there is no Chromium")
    def test_browser(self):
        """A pointer over the middle of the first chart shows its numbers there."""
        touch = ('const s=document.querySelector(".chart svg"),b=s.getBoundingClientRect();'
                 's.dispatchEvent(new PointerEvent("pointermove",{clientX:b.left+b.width/2,clientY:b.top+50}));')
        path = self.folder.parent / "touched.html"
        path.write_text(self.text.replace("</body>", f"<script>{touch}</script></body>"))
        done = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom", path.as_uri()], capture_output=True,
                              text=True, timeout=120)
        self.assertRegex(done.stdout, r'<th class="now">displacement \(m\): 0\.00\d+</th>')


class Charts(unittest.TestCase):
    def test_ticks(self):
        self.assertEqual(charts.ticks(0, 10), [0, 2, 4, 6, 8, 10])
        self.assertTrue(all(len(charts.ticks(0, high)) <= 7 for high in np.geomspace(1e-9, 1e9, 97)))
        np.testing.assert_allclose(charts.ticks(-0.3, 0.3), [-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.3], atol=1e-12)

    def test_thinning_keeps_peaks(self):
        x = np.linspace(0, 1, 100001)
        y = np.sin(x)
        y[40321], y[77777] = 50, -50
        rows = charts.thinned(x, {"y": y})
        self.assertLess(len(rows), 1000)
        self.assertEqual((y[rows].max(), y[rows].min()), (50, -50))

    def test_gaps(self):
        """A line begins anew after numbers that are none."""
        values = np.array([1.0, np.nan, 2.0, 3.0])
        self.assertEqual(charts.path_of(np.arange(4), values, float, float), "M0.0 1.0M2.0 2.0L3.0 3.0")


if __name__ == "__main__":
    unittest.main()
