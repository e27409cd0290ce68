#!/usr/bin/env python3
"""One table of the results that `run --json` has written: pairs that were compared and that differ, and the largest difference, by image.

    summary.py FILE.json ...

A difference is relative to the largest value of a field. Those of round-off, and those that are meant (meant.py), count as no difference.
"""
import json
import math
import sys


def count_pairs(decks):
    """Numbers of pairs that agree and that do not."""
    failed = [bool(image["failure"]) for deck in decks for image in deck["images"].values()]
    return failed.count(False), failed.count(True)


def table_of(decks):
    """The table as Markdown."""
    decks = list(decks)
    rows = ["| image | compared | differ | largest difference | of those that agree | where |", "| --- | --- | --- | --- | --- | --- |"]
    for name in sorted({name for deck in decks for name in deck["images"]}):
        images = [deck["images"][name] for deck in decks if name in deck["images"]]
        largest = max(images, key=lambda image: image["largest"])
        agree = max((image["largest"] for image in images if not image["failure"]), default=0)
        failed = sum(bool(image["failure"]) for image in images)
        rows.append(f"| {name} | {len(images)} | {failed} | {number_of(largest['largest'])} | {number_of(agree)} | {largest['where']} |")
    passed, failed = count_pairs(decks)
    kinds = [f"{deck['dim']}D {deck['precision']}" for deck in decks]
    printed = ", ".join(f"{kinds.count(kind)} in {kind}" for kind in sorted(set(kinds)))
    return "\n".join([*rows, "", f"{len(decks)} decks ({printed}) with {passed + failed} images, of which {failed} differ"])


def number_of(x):
    return "0" if x == 0 else ("all" if math.isinf(x) else f"{x:.1e}")


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        return 2
    runs = [json.loads(open(path).read()) for path in sys.argv[1:]]
    decks = {(run["seed"], *run["features"], number): deck for run in runs for number, deck in run["decks"].items()}
    print(table_of(decks.values()))
    return int(count_pairs(decks.values())[1] > 0)


if __name__ == "__main__":
    sys.exit(main())
