"""docs/verification.md from regression/verification.md.in and the kept results.

A line {{CASE}} of the template becomes the case's section, {{summary}} a line for each case, {{short}} the list of known
shortfalls, {{machines}} what the results were made with.
"""

import math
import re
from collections import Counter

from mpm_regression import cases
from mpm_regression import store

TEMPLATE = cases.ROOT / "regression" / "verification.md.in"
PAGE = cases.ROOT / "docs" / "verification.md"
IMAGES = cases.ROOT / "docs" / "images"
RESULTS = {"CPU": "cpu.json", "GPU": "gpu.json"}
MARKS = {"pass": "", "short": " **short**", "FAIL": " **fails**"}


def page():
    """The text of docs/verification.md."""
    results = {label: store.load(cases.ROOT / "regression" / "results" / name) for label, name in RESULTS.items()}
    all_cases = {name: cases.Case(name) for name in cases.names()}
    text = TEMPLATE.read_text()
    missing = [name for name in all_cases if f"{{{{{name}}}}}" not in text]
    if missing:
        raise SystemExit(f"regression/verification.md.in has no place for {', '.join(missing)}")
    parts = {name: section(each, results) for name, each in all_cases.items()}
    parts |= {"summary": summary(all_cases, results), "short": shortfalls(all_cases, results), "machines": machines(results)}
    return re.sub(r"\{\{(\w+)\}\}", lambda place: parts[place[1]], text)


def write():
    PAGE.write_text(page())
    print(f"wrote {PAGE.relative_to(cases.ROOT)}")


def columns(case, results):
    """{"CPU double": [{"backend-precision": entry}, ...]}: the entries of a case by machine and precision."""
    return {f"{label} {precision}": [entry for variant, entry in sorted(kept["cases"].get(case.name, {}).items(), reverse=True)
                                     if variant.endswith(precision)]
            for label, kept in results.items() for precision in ("double", "single")
            if precision in getattr(case.module, "PRECISIONS", ("double", "single"))}


def section(case, results):
    """Title, explanation, table of answers and picture of a case."""
    entries = columns(case, results)
    entries = {label: column for label, column in entries.items() if column} or entries
    lines = [f"### {case.title()}", "", case.explanation(), "",
             f"`regression/run {case.name}`: [the deck](../{case.deck}), [the check](../{case.folder}/case.py)", "",
             "| answer | exact | allowed | " + " | ".join(entries) + " | source |", "| --- " * (len(entries) + 4) + "|"]
    described = next((column[0]["rows"] for column in entries.values() if column), [])
    for row in described:
        cells = [cell(column, row["what"]) for column in entries.values()]
        lines.append("| " + " | ".join([row["what"], exact_text(row), allowed_text(row), *cells, row["source"]]) + " |")
    if (IMAGES / f"verification_{case.name}.png").exists():
        lines += ["", f"![{case.title()}](images/verification_{case.name}.png)"]
    return "\n".join(lines)


def exact_text(row):
    return ("at least " if row["at_least"] else "") + f"{row['exact']:.5g}"


def allowed_text(row):
    return f"{100 * row['tolerance']:.3g} %" if row["relative"] else f"{row['tolerance']:.3g}"


def cell(column, what):
    """An answer with its error for each back end of a column; back ends with the same answer share an entry."""
    texts = []
    for entry in column:
        for row in entry["rows"]:
            if row["what"] == what:
                texts.append(answer_text(row))
    return " / ".join(dict.fromkeys(texts)) or "not run"


def answer_text(row):
    if row["answer"] is None:
        return "**no answer**"
    error = f" ({100 * row['error']:.3g} %)" if row["relative"] and not row["at_least"] else ""
    return f"{row['answer']:.5g}{error}{MARKS[row['verdict']]}"


def summary(all_cases, results):
    """A table for each heading of the template: a line a case, in the order of the page."""
    lines = []
    for heading, names in headings(all_cases):
        lines += [f"**{heading}**", "", "| case | worst answer | error | allowed | measured on | answers that hold | time | in `scripts/test` |",
                  "| --- " * 8 + "|"] + [summary_line(all_cases[name], results) for name in names] + [""]
    return "\n".join(lines).rstrip()


def headings(all_cases):
    """[(heading, [names of cases])] of the template, without headings that have no case."""
    found = []
    for heading, place in re.findall(r"^## (.*)$|^\{\{(\w+)\}\}$", TEMPLATE.read_text(), re.M):
        if heading:
            found.append((heading, []))
        elif found and place in all_cases:
            found[-1][1].append(place)
    return [(heading, names) for heading, names in found if names]


def summary_line(case, results):
    """A case in one line: the answer that takes most of what it is allowed, in all variants, and where it was measured."""
    variants = {variant: entry for kept in results.values() for variant, entry in kept["cases"].get(case.name, {}).items()}
    rows = [row for entry in variants.values() for row in entry["rows"]]
    times = [(label, sum(entry["seconds"] for entry in kept["cases"].get(case.name, {}).values())) for label, kept in results.items()]
    time = ", ".join(f"{label} {seconds:.0f} s" for label, seconds in times if seconds)
    worst = max(rows, key=share_of_allowed, default=None)
    answer = [worst["what"], error_text(worst), allowed_text(worst)] if worst else ["", "", ""]
    cells = [f"[{case.title()}](#{anchor(case.title())}) (`{case.name}`)", *answer, measured_on(variants),
             passed_text([row["verdict"] for row in rows]), time, "--all" if case.is_long() else "yes"]
    return "| " + " | ".join(cells) + " |"


def share_of_allowed(row):
    """Error over tolerance of an answer; infinite where there is no answer, or any error is too large."""
    if row["error"] is None:
        return math.inf
    return row["error"] / row["tolerance"] if row["tolerance"] else math.inf if row["error"] else 0.0


def error_text(row):
    if row["error"] is None:
        return "**no answer**"
    return (f"{100 * row['error']:.2g} %" if row["relative"] else f"{row['error']:.2g}") + MARKS[row["verdict"]]


def anchor(title):
    """The anchor that GitHub gives to a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def measured_on(variants):
    """The back ends of some variants, with the precision where a back end has one alone."""
    precisions = {}
    for backend, precision in (variant.split("-") for variant in sorted(variants)):
        precisions.setdefault(backend, []).append(precision)
    order = ["serial", "openmp", "cuda"]
    return ", ".join(backend if len(found) > 1 else f"{backend} ({found[0]})"
                     for backend, found in sorted(precisions.items(), key=lambda item: order.index(item[0]))) or "not run"


def passed_text(verdicts):
    if not verdicts:
        return "not run"
    others = [f"{verdicts.count(verdict)} {word}" for verdict, word in (("short", "short"), ("FAIL", "**fail**"))
              if verdict in verdicts]
    return ", ".join([f"{verdicts.count('pass')} of {len(verdicts)}", *others])


def shortfalls(all_cases, results):
    """Known shortfalls: a line for each answer, with its worst variant, its error and the reason."""
    worst = {}
    for label, kept in results.items():
        for name in all_cases:
            for variant, entry in kept["cases"].get(name, {}).items():
                for row in entry["rows"]:
                    key = (name, row["what"])
                    if row["verdict"] == "short" and row["error"] > worst.get(key, ({"error": 0},))[0]["error"]:
                        worst[key] = (row, variant)
    lines = [f"- {all_cases[name].title()}, {what}: {answer_text(row).replace(' **short**', '')} against {exact_text(row)} "
             f"(allowed {allowed_text(row)}; {variant}). {row['shortfall']}" for (name, what), (row, variant) in worst.items()]
    return "\n".join(lines) or "None."


def machines(results):
    """Machines and versions that made the results, the machine of most of them first."""
    made_by = []
    for label, kept in results.items():
        made = Counter(entry["machine"] for variants in kept["cases"].values() for entry in variants.values())
        if made:
            made_by.append(f"{label}: {', '.join(name for name, _ in made.most_common())}, mpm {kept['version']}")
    return "; ".join(made_by)


def draw(drawn):
    """docs/images/verification_CASE.png of each (case, runs) whose case.py can draw; the names of these cases."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    names = []
    for case, runs in drawn:
        if not hasattr(case.module, "draw") or not runs:
            continue
        figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
        case.module.draw(axes, runs)
        figure.savefig(IMAGES / f"verification_{case.name}.png", dpi=110)
        plt.close(figure)
        names.append(case.name)
    return names
