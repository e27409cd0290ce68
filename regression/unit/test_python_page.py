#!/usr/bin/env python3
"""The code of docs/python.md runs, from a folder with the decks.

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
    def test_the_code_of_the_page_runs(self):
        blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / "python.md").read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreater(len(blocks), 5)
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "inputs").symlink_to(ROOT / "inputs")
            environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPM_PROGRAM": str(PROGRAM), "PYTHONDONTWRITEBYTECODE": "1"}
            done = subprocess.run([sys.executable, "-c", "\n".join(blocks)], cwd=folder, env=environment, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        for expected in re.findall(r"print\(error\)  # (.*)", "\n".join(blocks)):
            self.assertIn(expected, done.stdout)
        self.assertIn("has a place only where -clay_model is mohr_coulomb or drucker_prager", done.stdout)


if __name__ == "__main__":
    unittest.main()
