"""docs/verification.md from regression/verification.md.in and the kept results.

A line {{CASE}} of the template becomes the case's section, {{summary}} a table of all cases, {{short}} the list of known
shortfalls, {{machines}} what the results were made with.
"""

import re
from collections import Counter

import case as cases
import store

TEMPLATE = cases.ROOT / "regression" / "verification.md.in"
PAGE = cases.ROOT / "docs" / "verification.md"
IMAGES = cases.ROOT / "docs" / "images"
RESULTS = {"CPU": "cpu.json", "GPU": "gpu.json"}


def write():
    results = {label: store.load(cases.ROOT / "regression" / "results" / name) for label, name in RESULTS.items()}
    all_cases = {name: cases.Case(name) for name in cases.names()}
    text = TEMPLATE.read_text()
    missing = [name for name in all_cases if f"{{{{{name}}}}}" not in text]
    if missing:
        raise SystemExit(f"regression/verification.md.in has no place for {', '.join(missing)}")
    parts = {name: section(each, results) for name, each in all_cases.items()}
    parts |= {"summary": summary(all_cases, results), "short": shortfalls(all_cases, results), "machines": machines(results)}
    PAGE.write_text(re.sub(r"\{\{(\w+)\}\}", lambda place: parts[place[1]], text))
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
             f"`regression/run {case.name}`: [the deck](../{case.deck}), [the check](../regression/cases/{case.name}/case.py)", "",
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
    """An answer with its error for each back end of a column; back ends that say the same are told once."""
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
    mark = {"pass": "", "short": " **short**", "FAIL": " **fails**"}[row["verdict"]]
    return f"{row['answer']:.5g}{error}{mark}"


def summary(all_cases, results):
    """A line a case: rows that pass on each machine, and the time of all its variants."""
    lines = ["| case | " + " | ".join(f"{label} | time" for label in results) + " | in `scripts/test` |",
             "| --- " + "| --- | --- " * len(results) + "| --- |"]
    for name, case in all_cases.items():
        cells = []
        for kept in results.values():
            variants = kept["cases"].get(name, {}).values()
            verdicts = [row["verdict"] for entry in variants for row in entry["rows"]]
            cells += [passed_text(verdicts), f"{sum(entry['seconds'] for entry in variants):.0f} s" if verdicts else ""]
        lines.append(f"| {case.title()} (`{name}`) | " + " | ".join(cells) + f" | {'--all' if case.is_long() else 'yes'} |")
    return "\n".join(lines)


def passed_text(verdicts):
    if not verdicts:
        return "not run"
    others = [f"{verdicts.count(verdict)} {word}" for verdict, word in (("short", "short"), ("FAIL", "**fail**"))
              if verdict in verdicts]
    return ", ".join([f"{verdicts.count('pass')} of {len(verdicts)}", *others])


def shortfalls(all_cases, results):
    """What falls short, how far, and why: a line for each answer, with its worst variant."""
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
    """What the results were made with, the machine of most of them first."""
    told = []
    for label, kept in results.items():
        made = Counter(entry["machine"] for variants in kept["cases"].values() for entry in variants.values())
        if made:
            told.append(f"{label}: {', '.join(name for name, _ in made.most_common())}, mpm {kept['version']}")
    return "; ".join(told)


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
