#!/usr/bin/env python3
"""scripts/factor_of_safety on a layer whose factor is known.

Usage: test_factor_of_safety.py PATH_TO_mpm
"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SCRIPT = HERE.parents[1] / "scripts" / "factor_of_safety"
EXACT = 0.25 * 9.81 / 1.5
MPM = ""


class Search(unittest.TestCase):
    def search(self, *words):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        done = subprocess.run([sys.executable, str(SCRIPT), str(HERE / "factor_of_safety.opts"), "--mpm", MPM, "--out", place.name,
                               *words, "-backend", "serial"], capture_output=True, text=True,
                              env=dict(os.environ, OMP_NUM_THREADS="1"))
        return done, pathlib.Path(place.name)

    def test_the_interval_holds_the_exact_factor(self):
        done, folder = self.search("--stage", "reduce", "--low", "1.5", "--high", "1.8", "--tolerance", "0.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        low, high = map(float, done.stdout.splitlines()[-1].removeprefix("factor of safety ").split(" to "))
        self.assertLess(low, EXACT)
        self.assertGreater(high, EXACT)
        self.assertLessEqual(high - low, 0.1)
        with open(folder / "factors.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertTrue(all((row["end"] == "rest") == (float(row["factor"]) < EXACT) for row in rows))

    def test_an_interval_without_the_factor_is_reported(self):
        done, _ = self.search("--stage", "reduce", "--low", "1.7", "--high", "1.8")
        self.assertIn("the soil fails with --low 1.7 already", done.stderr)
        done, _ = self.search("--stage", "reduce", "--low", "1.5", "--high", "1.6")
        self.assertIn("the soil comes to rest with --high 1.6", done.stderr)
        done, _ = self.search("--stage", "push")
        self.assertIn("ended with status 2", done.stderr)
        self.assertNotEqual(done.returncode, 0)


if __name__ == "__main__":
    MPM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
