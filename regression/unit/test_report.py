#!/usr/bin/env python3
"""docs/verification.md: its line for each case, and whether it is that of the kept results."""

import sys
import unittest

sys.dont_write_bytecode = True

from mpm_regression import cases, report  # noqa: E402


def row(what, error, tolerance, relative=False, verdict="pass"):
    return {"what": what, "answer": 1.0, "exact": 1.0, "error": error, "tolerance": tolerance, "relative": relative,
            "at_least": False, "source": "", "shortfall": "", "verdict": verdict}


def results(**rows_of):
    """Kept results of the case `bar` with rows for each variant, as cpu_double."""
    kept = {"CPU": {"cases": {"bar": {}}}, "GPU": {"cases": {"bar": {}}}}
    for variant, rows in rows_of.items():
        label = "GPU" if variant.startswith("cuda") else "CPU"
        kept[label]["cases"]["bar"][variant.replace("_", "-")] = {"machine": "", "seconds": 2.0, "rows": rows}
    return kept


class Line(unittest.TestCase):
    def cells(self, kept):
        return [cell.strip() for cell in report.summary_line(cases.Case("bar"), kept).strip("|").split(" | ")]

    def test_the_worst_answer_is_the_one_that_takes_most_of_what_it_is_allowed(self):
        kept = results(serial_double=[row("large but allowed", 0.5, 1.0), row("small", 0.009, 0.01, relative=True)],
                       cuda_single=[row("small", 0.002, 0.01, relative=True)])
        self.assertEqual(self.cells(kept)[1:7], ["small", "0.9 %", "1 %", "serial (double), cuda (single)", "3 of 3", "CPU 2 s, GPU 2 s"])

    def test_a_shortfall_comes_before_what_holds(self):
        kept = results(serial_double=[row("holds", 0.99, 1.0), row("short", 1.2, 1.0, verdict="short")])
        self.assertEqual(self.cells(kept)[1:6], ["short", "1.2 **short**", "1", "serial (double)", "1 of 2, 1 short"])

    def test_no_answer_is_the_worst(self):
        kept = results(serial_double=[row("fails", 3.0, 1.0, verdict="FAIL"), row("none", None, 1.0, verdict="FAIL")])
        self.assertEqual(self.cells(kept)[1:3], ["none", "**no answer**"])

    def test_no_error_is_allowed(self):
        self.assertEqual(report.share_of_allowed(row("", 0.0, 0)), 0)
        self.assertEqual(report.share_of_allowed(row("", 1e-9, 0)), float("inf"))

    def test_a_case_that_was_not_run_says_so(self):
        self.assertEqual(self.cells(results())[1:7], ["", "", "", "not run", "not run", ""])

    def test_both_precisions_are_reported_once(self):
        self.assertEqual(report.measured_on({"cuda-double": 0, "cuda-single": 0, "serial-single": 0}), "serial (single), cuda")


class Page(unittest.TestCase):
    def test_every_case_has_one_line(self):
        names = [name for _, found in report.headings({name: None for name in cases.names()}) for name in found]
        self.assertEqual(sorted(names), sorted(cases.names()))

    def test_the_page_is_that_of_the_kept_results(self):
        self.assertEqual(report.PAGE.read_text(), report.page(), "run `regression/run --page`")


if __name__ == "__main__":
    unittest.main()
