"""Fields of particles by their names: those of the frames, and those that follow from them. Needs numpy.

Datasets are {name: array [N], [N, 3] or [N, 6]} of a body in a frame, in SI units: docs/results.md. Stress is xx, yy, zz, xy, yz, zx,
tension positive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping

import numpy as np

from soil_mpm.runout import grid_velocity

STRESSES = ["xx", "yy", "zz", "xy", "yz", "zx"]
PORE_PRESSURES = ["pore_pressure", "excess_pore_pressure"]
KILO = 1e3

Datasets = Mapping[str, Any]


@dataclass(frozen=True)
class Derived:
    """A number at each particle that follows from datasets: its title, its SI unit, the datasets that it needs (one of each tuple),
    its values [N], and whether its colours are about 0."""
    title: str
    unit: str
    needs: tuple[tuple[str, ...], ...]
    of: Callable[[Datasets], np.ndarray]
    signed: bool = False

    def is_in(self, datasets: Datasets) -> bool:
        return all(any(name in datasets for name in names) for names in self.needs)


def mises_of(f: Datasets) -> np.ndarray:
    """sqrt(3 J2), Pa."""
    stress = f["stress"][:]
    normal, shear = stress[:, :3], stress[:, 3:]
    deviator = normal - normal.mean(axis=1, keepdims=True)
    return np.sqrt(1.5 * ((deviator ** 2).sum(axis=1) + 2 * (shear ** 2).sum(axis=1)))


def pressure_of(f: Datasets) -> np.ndarray:
    """Mean total stress in compression, Pa."""
    return -f["stress"][:, :3].mean(axis=1)


def derived_fields() -> dict[str, Derived]:
    """{name: Derived}; older frames hold no velocity of the nodes."""
    both, stress = (("velocity", "grid_velocity"),), (("stress",),)
    found = {"grid_velocity": Derived("velocity of the nodes", "m/s", both, lambda f: np.linalg.norm(grid_velocity(f), axis=1)),
             "velocity": Derived("velocity of the particles", "m/s", (("velocity",),),
                                 lambda f: np.linalg.norm(f["velocity"][:], axis=1))}
    for k, axis in enumerate("xyz"):
        found[f"velocity_{axis}"] = Derived(f"velocity in {axis}", "m/s", (("velocity",),), lambda f, k=k: grid_velocity(f)[:, k], True)
    found["pressure"] = Derived("mean pressure", "Pa", stress, pressure_of, True)
    found["effective_pressure"] = Derived("mean effective pressure", "Pa", (*stress, ("pore_pressure",)),
                                          lambda f: pressure_of(f) - f["pore_pressure"][:], True)
    found["mises"] = Derived("von Mises stress", "Pa", stress, mises_of)
    for k, name in enumerate(STRESSES):
        found[f"stress_{name}"] = Derived(f"stress {name}", "Pa", stress, lambda f, k=k: f["stress"][:, k], True)
    return found


DERIVED = derived_fields()


@dataclass
class Field:
    """A number at each particle as pictures show it: how it is titled, its values [N], and whether its colours are about 0, else
    from 0 on. Stresses and strengths are in kPa."""
    title: str
    of: Callable[[Datasets], np.ndarray]
    signed: bool


def in_kilo(derived: Derived) -> Field:
    """A derived field as pictures show it."""
    if derived.unit != "Pa":
        return Field(f"{derived.title} ({derived.unit})", derived.of, derived.signed)
    return Field(f"{derived.title} (kPa)", lambda f: derived.of(f) / KILO, derived.signed)


def known_fields(datasets: Datasets, units: Mapping[str, str] | None = None) -> dict[str, Field]:
    """{name: Field} of all datasets of a body, with their units {name: unit}."""
    known = {name: in_kilo(derived) for name, derived in DERIVED.items() if derived.is_in(datasets)}
    for name, values in datasets.items():
        if name not in known and values.ndim == 1:
            known[name] = scalar_field(name, values, (units or {}).get(name, ""))
    return known


def scalar_field(name: str, values: np.ndarray, unit: str) -> Field:
    """The Field of a dataset with one number a particle: pressures and strengths in kPa."""
    size = KILO if unit == "Pa" or name in PORE_PRESSURES else 1.0
    text = "kPa" if size > 1 else unit
    title = "plastic shear strain" if name == "plastic_strain" else name.replace("_", " ")
    return Field(f"{title} ({text})" if text else title, lambda f, name=name: f[name] / size,
                 bool(name != "plastic_strain" and (values < 0).any()))
