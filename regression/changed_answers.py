#!/usr/bin/env python3
"""Table in Markdown of the answers of the suite that changed since an earlier revision of its results.

    changed_answers.py REVISION [--least 0.1]

An answer is listed where its error changed by more than `least` of what it is allowed, on some back end in some precision: the one
where it changed most. Answers that one of the two does not have are counted, not listed.
"""
import argparse
import json
import subprocess

from mpm_regression import cases
from mpm_regression import store

RESULTS = ["regression/results/cpu.json", "regression/results/gpu.json"]


def kept_then(revision, path):
    return json.loads(subprocess.run(["git", "show", f"{revision}:{path}"], cwd=cases.ROOT, check=True, stdout=subprocess.PIPE).stdout)


def answers(results):
    """{(case, answer): {variant: row}}."""
    found = {}
    for name, variants in results["cases"].items():
        for variant, entry in variants.items():
            for row in entry["rows"]:
                found.setdefault((name, row["what"]), {})[variant] = row
    return found


def change(before, now):
    """Change of the error over what is allowed."""
    if before["error"] is None or now["error"] is None:
        return 0
    return abs(now["error"] - before["error"]) / max(now["tolerance"], 1e-30)


def text_of(row):
    size = f"{100 * row['error']:.2g} %" if row["relative"] else f"{row['error']:.2g}"
    return size + {"pass": "", "short": " short", "FAIL": " fails"}[row["verdict"]]


def table(before, now, least):
    lines, same, lost = [], 0, 0
    for key in sorted(before.keys() | now.keys()):
        both = [variant for variant in before.get(key, {}) if variant in now.get(key, {})]
        if not both:
            lost += 1
            continue
        variant = max(both, key=lambda each: change(before[key][each], now[key][each]))
        old, new = before[key][variant], now[key][variant]
        if change(old, new) <= least and old["verdict"] == new["verdict"]:
            same += 1
            continue
        allowed = f"{100 * new['tolerance']:.2g} %" if new["relative"] else f"{new['tolerance']:.2g}"
        lines.append(f"| `{key[0]}` | {key[1]} | {text_of(old)} | {text_of(new)} | {allowed} | {variant} |")
    return lines, same, lost


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("revision")
    parser.add_argument("--least", type=float, default=0.1, help="share of the allowed error (default: 0.1)")
    given = parser.parse_args()
    before, now = {}, {}
    for path in RESULTS:
        for of, results in ((before, kept_then(given.revision, path)), (now, store.load(cases.ROOT / path))):
            for key, rows in answers(results).items():
                of.setdefault(key, {}).update(rows)
    lines, same, lost = table(before, now, given.least)
    print(f"{len(lines)} answers changed by more than {given.least:g} of what they are allowed, {same} did not; "
          f"{lost} are in one of the two alone.\n")
    print("| case | answer | error before | error now | allowed | where it changed most |\n| --- | --- | --- | --- | --- | --- |")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
