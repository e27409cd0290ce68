"""The page of a report: what was run, checks of trust, warnings, pictures, curves, options, the certified answer."""

from __future__ import annotations

import base64
import json
import math
from html import escape
from pathlib import Path
from typing import Any, Sequence

from soil_mpm.plot.pictures import Wishes, draw_all, is_element
from soil_mpm.plot.render import can_draw
from soil_mpm.plot.view import View
from soil_mpm.problems import NoSuchResult
from soil_mpm.report.charts import Chart, charts_of, svg
from soil_mpm.report.checks import DOUBT, UNKNOWN, Check, checks_of, performance_of
from soil_mpm.report.log import Log
from soil_mpm.results import Run

FINEST = "cells_1h"  # folder of the run of a certificate on the deck's own mesh
SIGNS = {DOUBT: "!", UNKNOWN: "?"}


def write(folder: Path | str, to: Path | str | None = None, pictures: bool = True) -> Path:
    """Writes the report of an output folder, or of the folder of a certificate, and returns its path; by default report.html in that
    folder. pictures: draws them anew; else those that are there are taken. NoSuchResult where the folder holds no run."""
    folder = Path(folder)
    if is_element(folder):
        raise NoSuchResult(f"{folder}: the path of a single material point has no report; scripts/plot draws it")
    of_run = folder if (folder / "options.json").exists() else folder / FINEST
    if not (of_run / "options.json").exists():
        raise NoSuchResult(f"{folder}: holds no results of a run: there is no options.json")
    run, path = Run(of_run), Path(to) if to else folder / "report.html"
    missing = draw_pictures(run) if pictures else []
    text = page(run, Log.read(of_run / "mpm.log"), missing, certificate_of(of_run))
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
    return path


def draw_pictures(run: Run) -> list[str]:
    """Draws all pictures anew, of a run in 3D the bodies in space too, where PyVista can: lines about those without data. A picture of
    bodies in space that is newer than the last frame stays, as its camera was chosen."""
    missing, view = draw_all(run, [], Wishes())[1], run.folder / "view.png"
    stays = run.frame is None or view.exists() and view.stat().st_mtime > run.frame.stat().st_mtime
    return missing + (draw_all(run, [], Wishes(view=View()))[1] if run.dim == 3 and not stays and can_draw() else [])


def certificate_of(folder: Path) -> dict[str, Any] | None:
    """The certificate to which a run belongs, or that soil-mpm certify made of the same deck beside it."""
    near = [folder / "certificate.json", folder.parent / "certificate.json" if folder.name == FINEST else None,
            folder.parent / "certify" / folder.name / "certificate.json"]
    found = next((path for path in near if path and path.exists()), None)
    return json.loads(found.read_text(encoding="utf-8")) if found else None


def page(run: Run, log: Log, missing: Sequence[str], certificate: dict[str, Any] | None) -> str:
    here = Path(__file__).parent
    checks = checks_of(run, log)
    body = [f"<h1>{escape(run.folder.resolve().name)}</h1>", summary(checks), section("What was run", facts(run, log)),
            section("Checks of trust", table_of_checks(checks))]
    if certificate:
        body.append(section("Certified answer", answer(certificate)))
    if log.warnings:
        body.append(section("Warnings and notices of the program", "<ul>" + "".join(f"<li>{escape(line)}</li>" for line in log.warnings) + "</ul>"))
    body += [section("Pictures", images(run, missing)), section("Curves", curves(charts_of(run))),
             section("Options that were given", table([("-" + name, text) for name, text in log.given], ("option", "value")))]
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>mpm: {escape(run.folder.resolve().name)}</title><style>{(here / 'page.css').read_text()}</style></head>\n<body>"
            + "\n".join(body) + f"\n<script>{(here / 'page.js').read_text()}</script></body></html>\n")


def section(title: str, content: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{content}</section>"


def table(rows: Sequence[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Rows of texts, which are escaped."""
    first = "<tr>" + "".join(f"<th>{escape(text)}</th>" for text in head) + "</tr>" if head else ""
    return "<table>" + first + "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows) + "</table>"


def summary(checks: Sequence[Check]) -> str:
    doubts = [check.name for check in checks if check.verdict == DOUBT]
    text = "The checks below found no reason to doubt this run." if not doubts else f"Look at: {', '.join(doubts)}."
    return f'<p class="summary {"doubt" if doubts else "good"}">{escape(text)}</p>'


def facts(run: Run, log: Log) -> str:
    told = performance_of(run)
    rows = [("program", log.begun or f"mpm {told.get('version', '')}"), *log.facts.items(), ("outcome", run.outcome or "none")]
    rows.append(("problem", f"{run.dim}D, {run.text('geometry', 'plane_strain').replace('_', ' ')}" if run.dim == 2 else "3D"))
    if run.text("mesh_spacing"):
        rows.append(("cells", f"{run.text('mesh_spacing')} m"))
    if told:
        factor = f", {told['real_time_factor']:.3g} s a second" if told.get("real_time_factor") else ""
        ranks, threads = told["ranks"], told["threads_per_rank"]
        rows += [("particles", f"{told['particles']:,}"), ("steps", f"{told['steps']:,} in {told['precision']} precision, back end {told['backend']}"),
                 ("processes", f"{ranks} rank{'s' * (ranks > 1)} of {threads} thread{'s' * (threads > 1)}, {told['device']}"),
                 ("time", f"{told['end_time_seconds']:.6g} s of motion in {span(told['wall_seconds'])}" + factor),
                 ("speed", f"{told['particle_updates_per_second'] / 1e6:.3g} million particle updates a second")]
        for key, whose in (("energy_joules", "processors"), ("gpu_energy_joules", "GPUs")):
            if told.get(key) is not None:
                rows.append(("energy", f"{told[key] / 3.6e6:.3g} kWh by the {whose}, with all that ran on them"))
    return table([(name, str(text)) for name, text in rows])


def span(seconds: float) -> str:
    """A time in words, as 2 min 5 s."""
    if seconds < 100:
        return f"{seconds:.3g} s"
    minutes, hours = int(seconds // 60), int(seconds // 3600)
    return f"{hours} h {minutes % 60} min" if hours else f"{minutes} min {seconds % 60:.0f} s"


def table_of_checks(checks: Sequence[Check]) -> str:
    rows = ["<tr><th></th><th>check</th><th>found</th><th>limit</th><th>what to do</th></tr>"]
    for check in checks:
        kind = check.verdict.replace(" ", "-")
        rows.append(f'<tr class="{kind}"><td><span class="verdict">{SIGNS.get(check.verdict, "✓")}</span> {escape(check.verdict)}</td>'
                    + "".join(f"<td>{escape(text)}</td>" for text in (check.name, check.found, check.limit, check.cure)) + "</tr>")
    return "<table>" + "".join(rows) + "</table>"


def answer(found: dict[str, Any]) -> str:
    """The certificate of soil-mpm certify: value, bar, verdict."""
    values = [(f"{h:.6g}", "-" if value is None else f"{value:.6g}") for h, value in zip(found["spacings"], found["values"])]
    bar, value = found["bar"], found["values"][0]
    text = "no value" if value is None else f"{value:.6g}" + (" without a bar" if bar is None or not math.isfinite(bar) else f" ± {bar:.2g}")
    notes = "".join(f"<li>{escape(note)}</li>" for note in found.get("notes", []))
    return (f"<p><b>{escape(found['answer'])}: {escape(text)}</b></p><p>{escape(found['verdict'])}: {escape(found['why'])}</p>"
            + table(values, ("cells (m)", "value")) + (f"<ul>{notes}</ul>" if notes else ""))


def images(run: Run, missing: Sequence[str]) -> str:
    parts = []
    for path in sorted(run.folder.glob("*.png")):
        data = base64.b64encode(path.read_bytes()).decode()
        parts.append(f'<figure><img alt="{escape(path.stem)}" src="data:image/png;base64,{data}"><figcaption>{escape(path.name)}</figcaption></figure>')
    return "".join(parts or ["<p>None.</p>"]) + "".join(f'<p class="note">{escape(line)}</p>' for line in missing)


def curves(charts: Sequence[Chart]) -> str:
    if not charts:
        return "<p>The history has fewer than two rows.</p>"
    return '<p class="note screen">Point at a curve to read its numbers.</p>' + "".join(
        f'<figure class="chart"><figcaption>{escape(chart.title)}</figcaption>{svg(chart)}</figure>' for chart in charts)
