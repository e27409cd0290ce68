#!/usr/bin/env python3
"""scripts/benchmark: a short run of each problem by the program, and the tables of made-up results.

usage: test_benchmark.py PATH_TO_mpm
"""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import pathlib
import re
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()

from soil_mpm.bench import laws, runs, tables, threads  # noqa: E402

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"

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

    def test_performance_json(self):
        """The figures are those of the log, to the digits that it has."""
        options = "-options_file inputs/footing_coarse.opts -backend serial -p2g tile -time_max_steps 40 -p2g_rebuild_interval 7 "
        with tempfile.TemporaryDirectory() as name:
            report = runs.run(PROGRAM, options + runs.HISTORY, pathlib.Path(name) / "run")
            log = (pathlib.Path(name) / "run" / "mpm.log").read_text()
            version = json.loads((pathlib.Path(name) / "run" / "options.json").read_text())["version"]
        self.assertEqual((report["program"], report["version"], report["outcome"]), ("mpm", version, "finished"))
        self.assertEqual((report["dim"], report["precision"], report["backend"], report["strategy"]), (2, "double", "serial", "tile"))
        self.assertEqual((report["ranks"], report["threads_per_rank"], report["first_step"], report["steps"]), (1, 1, 0, 40))
        self.assertIn(f", {report['processor']}, {report['cores']} cores, 1 rank\n", log)
        for each in report["functions"]:
            row = f"  {each['name']:30} {each['calls']:9} {each['seconds']:11.3f} {100 * each['seconds'] / report['wall_seconds']:6.1f} %"
            self.assertIn(row + (f" {each['bytes'] / 1e9:11.2f}" if each["bytes"] else ""), log)
        self.assertEqual(len(re.findall(r" +\d+ +[\d.]+ +[\d.]+ %", log)), len(report["functions"]))
        self.assertRegex(log, rf"wall time +{report['wall_seconds']:.3f} ")
        rebuilds = [report["rebuilds"][name] for name in ("count", "shortest_interval_steps", "longest_interval_steps", "mean_interval_steps")]
        self.assertIn("were rebuilt {} times, after {} to {} steps, {:.1f} on average\n".format(*rebuilds), log)
        self.assertEqual(rebuilds, [5, 7, 7, 7])
        self.assertIn(f"40 steps, checked by the host {report['looks_of_host']} times\n", log)
        self.assertIn(f"strategy tile; {report['memory_bytes'] / 1e6:.1f} MB on the device, "
                      f"{report['memory_bytes'] / report['particles']:.1f} bytes a particle\n", log)
        copy, moved = report["copy_bandwidth_bytes_per_second"], report["moved_bytes_per_second"]
        self.assertIn(f"{report['device']}: a copy reads and writes {copy / 1e9:.1f} GB/s; the steps move {moved / 1e9:.1f} GB/s, "
                      f"{100 * moved / copy:.1f} % of it\n", log)
        rate = report["particle_updates_per_second"]
        written = f"{rate / 1e6:.1f} M/s" if rate >= 999.95e3 else f"{rate / 1e3:.1f} k/s"
        self.assertIn(f"{1e6 * report['stepping_seconds'] / 40:.4g} us a step without output; {written} particle updates\n", log)
        self.assertIsNone(report["between_ranks"])

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

    def test_laws(self):
        """A few steps with three laws, which take turns, and the table of made-up results."""
        self.addCleanup(setattr, laws, "STEPS", laws.STEPS)
        laws.STEPS = {"serial": 8}
        self.assertEqual(laws.cases(["double"], "linear_elastic,tresca"),
                         [("double", False, ["von_mises", "linear_elastic", "tresca"]), ("double", True, ["von_mises", "tresca"])])
        with self.assertRaises(SystemExit):
            laws.cases(["double"], "tresca,wood")
        with tempfile.TemporaryDirectory() as folder:
            found = laws.measure(PROGRAM, "double", True, ["von_mises", "tresca"], 2, pathlib.Path(folder))
        self.assertEqual([each["problem"] for each in found], ["von_mises", "tresca"])
        for each in found:
            self.assertEqual(each["us"], min(each["all_us"]))
            self.assertEqual((each["particles"], len(each["all_us"]), each["soil"]), (76800, 2, "weak"))
            self.assertTrue(each["yields"] is None or 0 < each["yields"] <= 1)
        made_up = [{**each, "us": us, "yields": share} for each, us, share in zip(found, (2000.0, 2500.0), (0.6012, None))]
        rows = laws.text_of(made_up).splitlines()
        self.assertIn("| `von_mises` | 2,000 (1.00, 60.1 %) |", rows)
        self.assertIn("| `tresca` | 2,500 (1.25) |", rows)

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

    def test_pages(self):
        """The page of each measurement holds the tables of its kept results between its marks."""
        for what in ("strategies", "threads", "scaling", "paper", "laws"):
            kept = benchmark.load([benchmark.ROOT / "docs" / "benchmarks" / f"{what}.json"])
            page = benchmark.page_of(what).read_text()
            self.assertIn(f"<!-- {what}: begin, by scripts/benchmark -->\n\n{benchmark.text_of(what, kept)}\n\n", page)
            self.assertEqual(page.count(f"<!-- {what}: end, by scripts/benchmark -->"), 1)

    def test_fill(self):
        """fill() replaces the text between the marks, and nothing else; a page without marks stays."""
        begin, end = "<!-- paper: begin, by scripts/benchmark -->", "<!-- paper: end, by scripts/benchmark -->"
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            page.write_text(f"before\n\n{begin}\n\nformer\n\n{end}\n\nafter\n")
            with contextlib.redirect_stdout(io.StringIO()):
                benchmark.fill(page, "paper", r"a \1 b")
            self.assertEqual(page.read_text(), f"before\n\n{begin}\n\na \\1 b\n\n{end}\n\nafter\n")
            with self.assertRaises(SystemExit):
                benchmark.fill(page, "threads", "a")
            self.assertIn("before", page.read_text())

    def test_kept_results(self):
        """A new measurement replaces the one that was kept of the same run, and nothing else."""
        kept = {"runs": [result("cuda", "single", "tile", 10.0), result("cuda", "double", "tile", 20.0)], "curves": {}}
        benchmark.add(kept, {"runs": [result("cuda", "single", "tile", 9.0)]})
        self.assertEqual({each["precision"]: each["us"] for each in kept["runs"]}, {"single": 9.0, "double": 20.0})


if __name__ == "__main__":
    unittest.main()
