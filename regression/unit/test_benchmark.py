#!/usr/bin/env python3
"""scripts/benchmark: a short run of each problem by the program, and the tables of made-up results.

usage: test_benchmark.py PATH_TO_mpm
"""

import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(SCRIPTS))
import benchmark_runs as runs  # noqa: E402
import benchmark_tables as tables  # noqa: E402
import benchmark_threads as threads  # noqa: E402

loader = importlib.machinery.SourceFileLoader("benchmark", str(SCRIPTS / "benchmark"))
benchmark = importlib.util.module_from_spec(importlib.util.spec_from_loader("benchmark", loader))
loader.exec_module(benchmark)


def result(backend, precision, strategy, us, particles=76800, problem="footing", **more):
    return {"problem": problem, "particles": particles, "backend": backend, "precision": precision, "strategy": strategy,
            "ran": "tile" if strategy == "auto" else strategy, "us": us, "all_us": [us],
            "functions": {name: us / 2 for name, _ in tables.SPEEDUPS.values() if name},
            "device": "a device", "machine": "a machine, 4 cores", "date": "2026-01-01", "commit": "abc", **more}


class Benchmark(unittest.TestCase):
    def test_runs(self):
        """measure() itself ends the test where the program has another number of particles."""
        self.addCleanup(setattr, runs, "UPDATES", runs.UPDATES)
        runs.UPDATES = {"serial": 1}
        for problem, particles in (("footing", 76800), ("landslide", 69120)):
            setting = runs.Setting(problem, particles, "serial", "double", "mosaic")
            with tempfile.TemporaryDirectory() as folder:
                found = runs.measure(PROGRAM, setting, 2, pathlib.Path(folder) / "run")
            self.assertEqual(found["ran"], "mosaic")
            self.assertEqual(found["us"], min(found["all_us"]))
            self.assertEqual(found["steps"], 3)
            self.assertEqual(len(found["functions"]), 7)
            self.assertGreater(found["functions"]["soil particles to nodes"], 0)
            self.assertLessEqual(sum(found["functions"].values()), 1.1 * found["us"])
            self.assertGreater(found["copy"], found["moved"] / 10)

    def test_backends(self):
        self.assertIn("serial", runs.backends(PROGRAM))

    def test_threads(self):
        """A program of two threads, and two programs at once, by numbers of particles that the program finds too."""
        if "openmp" not in runs.backends(PROGRAM):
            self.skipTest("built without OpenMP")
        self.addCleanup(setattr, threads, "UPDATES_A_THREAD", threads.UPDATES_A_THREAD)
        threads.UPDATES_A_THREAD = 1e5
        self.assertEqual(threads.cases("51200,128000", "1,2,4"), [(51200, 1), (51200, 2), (128000, 1), (128000, 2), (128000, 4)])
        with tempfile.TemporaryDirectory() as folder:
            found = threads.measure(PROGRAM, 51200, 2, "double", 1, pathlib.Path(folder) / "runs")
        self.assertGreater(found["rate"], 0)
        self.assertGreater(found["apart"], 0)
        rows = threads.text_of([{**found, "ranks": 1, "rate": 20.0, "apart": 20.0},
                                {**found, "ranks": 4, "rate": 60.0, "apart": 64.0, "copy": 100.0, "moved": 25.0}]).splitlines()
        self.assertIn("| 4 | 60.0 | 75 % | 64.0 | 94 % | 25 % |", rows)

    def test_tables(self):
        measured = tables.Measured([result("serial", "double", "auto", 6000.0), result("cuda", "single", "auto", 15.0),
                                    result("cuda", "single", "gather", 120.0)])
        (row,) = [line for line in tables.runtimes(measured, "footing").splitlines() if line.startswith("| 76,800")]
        self.assertEqual(row, "| 76,800 | 62 / 3.11 / 3.77 | 6 | 0.12 / - | 0.015 / - | 5.12 | 400 |")
        rows = tables.speedups(measured).splitlines()
        self.assertIn("| overall | ours, gather | 50 | - | - | - | - | - | - |", rows)
        self.assertIn("| nodal velocities | ours, default | 400 | - | - | - | - | - | - |", rows)
        self.assertIn("| interpolation, soil to nodes | ours, gather | 50 | - | - | - | - | - | - |", rows)
        self.assertIn("| interpolation, soil to nodes | ours, default | - | - | - | - | - | - | - |", rows)  # sums ahead
        self.assertIn("| 76,800 | `gather` | 120 (640) | - |", tables.strategies(measured).splitlines())

    def test_kept_results(self):
        """What is measured again replaces what was kept of it, and nothing else."""
        kept = {"runs": [result("cuda", "single", "tile", 10.0), result("cuda", "double", "tile", 20.0)], "curves": {}}
        benchmark.add(kept, {"runs": [result("cuda", "single", "tile", 9.0)]})
        self.assertEqual({each["precision"]: each["us"] for each in kept["runs"]}, {"single": 9.0, "double": 20.0})


if __name__ == "__main__":
    unittest.main()
