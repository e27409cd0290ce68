"""Energy balance of a vibrating bar

An elastic bar hangs from a wall, and gravity is switched on. Friction, plastic strain and damping are absent, so the work of
gravity is the kinetic and the elastic energy at each moment. The work of the stress must be the elastic energy, and what is
[missing in the balance](method.md#what-is-measured) must fall as the time step: half of it with half the step. FLIP, XPIC and APIC
take a part of the energy at the front of the wave, which is steep; the balance says how much.
"""

import numpy as np

from mpm_regression.row import Row

RUNS = {"flip": "-time_courant 0.4", "half": "-time_courant 0.2", "quarter": "-time_courant 0.1",
        "xpic": "-time_courant 0.4 -velocity_update xpic", "apic": "-time_courant 0.4 -velocity_update apic"}


def largest(run):
    """The largest energy of the run, J."""
    return max(run.history[name].max() for name in ("energy_kinetic", "energy_internal", "work_gravity"))


def missing(run):
    return np.abs(run.history["energy_error"]).max() / largest(run)


def check(runs):
    for name in ("flip", "xpic", "apic"):
        h = runs[name].history
        yield Row(f"work of the stress less the elastic energy, over the largest energy, {name}",
                  np.abs(h["energy_internal"] - h["energy_elastic"]).max() / largest(runs[name]), 0, 1e-3, "elastic law")
        yield Row(f"largest share of the energy that is missing, {name}", missing(runs[name]), 0, 0.02, "definition")
        yield Row(f"share of the energy that the velocity update takes, {name}", -h["work_update"].min() / largest(runs[name]), 0, 0.005,
                  "no damping")
        left = h["energy_kinetic"] + h["energy_elastic"] - h["work_gravity"]
        yield Row(f"kinetic and elastic energy less the work of gravity, over the largest energy, {name}",
                  np.abs(left).max() / largest(runs[name]), 0, 0.02, "conservation of energy")
    yield Row("what is missing with half the time step over that with the whole", missing(runs["half"]) / missing(runs["flip"]), 0.5, 0.07,
              "first order in the time step")
    yield Row("with a quarter of it over that with half of it", missing(runs["quarter"]) / missing(runs["half"]), 0.5, 0.07,
              "first order in the time step")
    yield Row("cells inside the bar without particles", max(run.history["empty_cells"].max() for run in runs.values()), 0, 0, "no gap")


def draw(axes, runs):
    h = runs["flip"].history
    for name, label in (("work_gravity", "work of gravity"), ("energy_kinetic", "kinetic"), ("energy_elastic", "elastic"),
                        ("energy_error", "missing")):
        axes.plot(h["time"], h[name], label=label)
    axes.set(xlabel="time (s)", ylabel="energy (J/m)")
    axes.legend()
