#!/usr/bin/env python3
"""The code of docs/python.md and docs/certify.md runs, from a folder with the decks.

usage: test_python_page.py PATH_TO_mpm
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()


class Page(unittest.TestCase):
    def code_of(self, page):
        blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / page).read_text(), re.MULTILINE | re.DOTALL)
        self.assertTrue(blocks)
        return "\n".join(blocks)

    def said_by(self, code):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "inputs").symlink_to(ROOT / "inputs")
            environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPM_PROGRAM": str(PROGRAM), "PYTHONDONTWRITEBYTECODE": "1"}
            done = subprocess.run([sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        return done.stdout

    def test_decks_runs_and_results(self):
        code = self.code_of("python.md")
        said = self.said_by(code)
        for expected in re.findall(r"print\(error\)  # (.*)", code):
            self.assertIn(expected, said)
        self.assertIn("has a place only where -clay_model is mohr_coulomb or drucker_prager", said)

    def test_certificates(self):
        self.assertRegex(self.said_by(self.code_of("certify.md")), r"observed order .*\n(.*\n)+.*converged: the bar is")


if __name__ == "__main__":
    unittest.main()
