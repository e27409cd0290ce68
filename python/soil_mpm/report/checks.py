"""Checks of trust of a run by its own outputs: balances, particles, time step."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from soil_mpm.certificate import MOST_GAP
from soil_mpm.closure import balances
from soil_mpm.report.log import Log
from soil_mpm.results import Run

GOOD, DOUBT, UNKNOWN = "good", "doubt", "not told"
MOST_EMPTY = 0.01     # of the cells that hold soil, as in the notice of the program
MOST_STRAYS = 1e-3    # of the particles
MOST_TAKEN = 0.2      # of the largest energy or work, by the velocity update
LEAST_STEP = 0.1      # of the first time step


@dataclass
class Check:
    """name: what is checked. found: its value in words. verdict: GOOD, DOUBT or UNKNOWN. limit: from where on there is doubt. cure: what
    to do about it, empty where nothing is to do."""
    name: str
    found: str
    verdict: str
    limit: str = ""
    cure: str = ""


def performance_of(run: Run) -> dict[str, Any]:
    """Figures of performance.json; empty where the run did not get to write it."""
    path = run.folder / "performance.json"
    return json.loads(path.read_text()) if path.exists() else {}


def checks_of(run: Run, log: Log) -> list[Check]:
    """All checks of a run, in the order of a reader."""
    checks = [outcome(run)]
    if "time" in run.history:
        checks += [*closures(run), *taken(run), *[check for check in (empty(run), alone(run), limited(run), put_back(run), lost(run)) if check],
                   time_step(run, log)]
    return [*checks, warned(log)]


def outcome(run: Run) -> Check:
    found = run.outcome or "none: the run was killed, or goes on"
    return Check("End of the run", found, GOOD if run.outcome == "finished" else DOUBT, "finished",
                 "" if run.outcome == "finished" else "the results end where the run did; -restart latest goes on from a checkpoint")


def closures(run: Run) -> list[Check]:
    cures = {"mass": "look at the particles that left", "momentum": "rows of the history that lie closer show waves (-history_interval)",
             "energy": "a smaller -time_courant, smaller cells"}
    made = []
    for name, gap in balances(run).items():
        title, limit = f"{name.capitalize()} that is missing in the balance", MOST_GAP[name]
        if isinstance(gap, str):
            made.append(Check(title, gap, UNKNOWN, cure="-output_energy on" if name == "energy" else ""))
        else:
            good = gap <= limit
            made.append(Check(title, f"{gap:.2g}", GOOD if good else DOUBT, f"at most {limit:g}", "" if good else cures[name]))
    return made


def taken(run: Run) -> list[Check]:
    """The energy that the velocity update takes, as a damping of the mesh."""
    if "work_update" not in run.history:
        return []
    parts = [run[name] for name in ("energy_kinetic", "energy_internal", "work_gravity", "work_rigids") if name in run.history]
    most = max(np.abs(values).max() for values in parts)
    share = float(np.abs(np.minimum(run["work_update"], 0)).max() / most) if most > 0 else 0.0
    return [Check("Energy that the velocity update took", f"{share:.2g} of the largest energy or work", GOOD if share <= MOST_TAKEN else DOUBT,
                  f"at most {MOST_TAKEN:g}", "" if share <= MOST_TAKEN else "smaller cells; -velocity_update flip takes least and keeps noise")]


def total(run: Run, end: str) -> np.ndarray | None:
    """Sum of a column of all bodies [rows]; None where the history has none."""
    columns = [run.history[f"{body}_{end}"] for body in run.words("bodies") if f"{body}_{end}" in run.history]
    return np.sum(columns, axis=0) if columns else None


def cells_of_soil(run: Run) -> float:
    """About the number of cells that hold soil, by particles and -NAME_particles_per_cell."""
    count = float(performance_of(run).get("particles", 0))
    a_cell = [run.number(f"{body}_particles_per_cell", 2) for body in run.words("bodies")]
    return count / max(min(a_cell, default=2), 1) ** run.dim


def empty(run: Run) -> Check | None:
    if "empty_cells" not in run.history:
        return None
    most, cells = run["empty_cells"].max(), cells_of_soil(run)
    share = most / cells if cells else 0.0
    good = share <= MOST_EMPTY
    return Check("Empty cells inside the soil, at most", f"{most:.0f}, about {share:.2g} of the cells of soil", GOOD if good else DOUBT,
                 f"at most {MOST_EMPTY:g}", "" if good else "-analysis flow keeps soil together that flows or is stretched")


def particles_check(run: Run, end: str, name: str, most: float, cure: str) -> Check | None:
    values, count = total(run, end), float(performance_of(run).get("particles", 0))
    if values is None or not count:
        return None
    good = values.max() <= most * count
    return Check(name, f"{values.max():.0f} of {count:.0f}", GOOD if good else DOUBT, f"at most {most:g} of them" if most else "none",
                 "" if good else cure)


def alone(run: Run) -> Check | None:
    return particles_check(run, "strays", "Particles that are alone, at most", MOST_STRAYS,
                           "they carry no stress; smaller cells, -analysis flow or -stray_particles")


def limited(run: Run) -> Check | None:
    return particles_check(run, "limited", "Particles with a volume at its bound, at most", 0, "a law with a limit of tension, or a stiffer one")


def put_back(run: Run) -> Check | None:
    return particles_check(run, "put_back", "Particles put back at walls", MOST_STRAYS, "a smaller -time_courant")


def lost(run: Run) -> Check | None:
    lost, mass = total(run, "lost_mass"), total(run, "mass")
    if lost is None or mass is None or not mass[0] > 0:
        return None
    return Check("Mass that left the run", f"{lost[-1] / mass[0]:.2g} of the first", GOOD if lost[-1] == 0 else DOUBT, "none",
                 "" if lost[-1] == 0 else "expected where soil flows out; else a larger mesh, or sides that are not free")


def whole_steps(run: Run) -> np.ndarray:
    """Time steps [s] of the rows, without those that are cut to end a stage or the run."""
    step, stage = run["dt"], run.history.get("stage", np.ones(len(run["dt"])))
    ends = np.append(np.diff(stage) > 0, run.outcome == "finished")
    return step[~ends] if not ends.all() else step


def time_step(run: Run, log: Log) -> Check:
    step = whole_steps(run)
    found = f"{step.min():.3g} s" if step.min() == step.max() else f"{step.min():.3g} to {step.max():.3g} s"
    if log.courant:
        found += f"; Courant number {log.courant[0]:g} at the start, at most {log.courant[1]:g}"
    good = step.min() >= LEAST_STEP * step[0]
    return Check("Time step", found, GOOD if good else DOUBT, f"at least {LEAST_STEP:g} of the first one",
                 "" if good else "what has become fast or stiff? -output_fields velocity,stress of the last frame")


def warned(log: Log) -> Check:
    count = len([line for line in log.warnings if not line.startswith("mpm: note: ")])
    return Check("Warnings of the program", f"{count}, listed below" if count else "none", DOUBT if count else GOOD, "none",
                 "each line has its cure" if count else "")
