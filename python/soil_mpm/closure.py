"""Balances of a run by its history: what is missing of mass, momentum and energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from soil_mpm.results import Run

TINY = 1e-300


def mass_gap(run: Run) -> float:
    """Largest change of the mass of all bodies with what has left, over the mass. Stages that place or remove bodies have none."""
    bodies = [body for body in run.words("bodies") if f"{body}_mass" in run.history]
    if not bodies or run.words("stages"):
        return float("nan")
    total: np.ndarray = sum(run[f"{body}_mass"] + run.history.get(f"{body}_lost_mass", 0) for body in bodies)
    return float(np.abs(total - total[0]).max() / max(abs(total[0]), TINY))


def why_no_momentum(run: Run) -> str:
    """What acts on the soil beside gravity, rigid bodies and sides of the mesh, so that the history does not tell all forces."""
    sides = [run.text(f"mesh_{axis}{end}") for axis in "xyz" for end in ("min", "max")]
    acting = {"damping": run.number("damping"), "Rayleigh damping": run.number("rayleigh_ratio"),
              "a table of gravity": "gravity_table" in run.options,
              "water": "water_level" in run.options, "loads": run.words("loads"), "stages": run.words("stages"),
              "an axis of revolution": run.text("geometry") == "axisymmetric", "position correction": run.text("position_correction") == "delta",
              "periodic sides": "periodic" in sides, "a free field": "free_field" in sides}
    return ", ".join(name for name, there in acting.items() if there)


def momentum_gap(run: Run) -> float:
    """Largest difference of the momentum of the soil and the impulse of gravity, rigid bodies and sides, over the sum of the impulses'
    sizes. Forces on sides are those at the rows, so that a wave between two rows counts as a gap."""
    time = run["time"]
    step, worst, size = np.diff(time), 0.0, 0.0
    bodies, gravity = run.words("bodies"), run.numbers("gravity", [0.0] * run.dim)
    for k, axis in enumerate("xyz"[:run.dim]):
        momentum = sum(run[f"{body}_momentum_{axis}"] + run.history.get(f"{body}_lost_momentum_{axis}", 0) for body in bodies)
        mass = sum(run[f"{body}_mass"] for body in bodies)
        impulse, own = mass[0] * gravity[k] * (time - time[0]), np.abs(mass[0] * gravity[k] * (time - time[0]))
        for name, force in run.history.items():
            if name.endswith(f"_force_{axis}") and (name.startswith("wall_") or name[:-len(f"_force_{axis}")] in run.words("rigid_bodies")):
                mean = (force[1:] + force[:-1]) / 2 if name.startswith("wall_") else force[1:]
                impulse = impulse - np.concatenate([[0.0], np.cumsum(mean * step)])
                own = own + np.concatenate([[0.0], np.cumsum(np.abs(mean) * step)])
        worst = max(worst, float(np.abs(momentum - momentum[0] - impulse).max()))
        size = max(size, float(own.max()), float(np.abs(momentum).max()))
    return worst / max(size, TINY)


def energy_gap(run: Run) -> float:
    """Largest missing energy over the largest energy or work of the balance; NaN without -output_energy on."""
    if "energy_error" not in run.history:
        return float("nan")
    parts = [values for name, values in run.history.items() if name.startswith(("energy_", "work_")) and name != "energy_error"]
    return float(np.abs(run["energy_error"]).max() / max(max(np.abs(values).max() for values in parts), TINY))


def balances(run: Run) -> dict[str, Any]:
    """{mass, momentum, energy}: what is missing, as a fraction; a text instead where the history does not tell it."""
    why = why_no_momentum(run)
    mass, energy = mass_gap(run), energy_gap(run)
    return {"mass": mass if np.isfinite(mass) else "stages change it", "momentum": f"not told with {why}" if why else momentum_gap(run),
            "energy": energy if np.isfinite(energy) else "not told without -output_energy on"}
