"""Slab dragged over clay

A slab whose interface slips at $\\tau_{max}$ is dragged over clay, and needs the force $\\tau_{max} A$: whatever the clay does
below, and wherever its ends are in their cells. The interface must stay in contact, so the clay carries a pressure of 3 kPa from the
start; the slab moves by 0.3 m (six cells), and is lowered by 0.3 mm meanwhile. The clay is a strip that lies wholly under the slab,
so $A$ is that of the strip. In one more run the clay is wider than the slab, whose front end then meets clay: the slab pushes nodes
at the surface, up to a cell ahead, which raises the force by 29 %. The mean force over the last two thirds is compared.
"""

import numpy as np

from mpm_regression.row import Row

LIMIT = 1000.0
PLOUGHS = "The front end of the slab pushes the nodes at the surface that are less than a cell ahead of it."
RUNS = {
    "ends on nodes": "",
    "ends off nodes": "-soil_lower 1.0123,0 -soil_upper 3.0373,0.25",
    "3D": ("-dim 3 -mesh_lower -0.6,-0.2,0 -mesh_upper 2.4,1.4,0.7 -mesh_spacing 0.1 -soil_lower 0.537,0.313,0 -soil_upper 1.587,0.863,0.2"
           " -slab_lower -0.4,-0.1,0.2 -slab_upper 2,1.3,0.5 -slab_velocity 0.5,0,-0.001 -mesh_zmin fixed -mesh_zmax free -soil_stress 0,0,-3000,0,0,0"),
    "wider clay": "-soil_lower 0,0 -soil_upper 5,0.5 -slab_lower 1.25,0.5 -slab_upper 2.25,0.75 -soil_stress 0,0,0,0 -slab_velocity 0.5,-0.002 -clay_su 3000",
}
RUNS = {name.replace(" ", "_"): options for name, options in RUNS.items()}
LONG = True


def area(run):
    """Area of the interface, m2 (2D: m): of the clay, or of the slab where that is smaller."""
    soil, slab = (np.subtract(run.numbers(f"{name}_upper"), run.numbers(f"{name}_lower"))[:-1] for name in ("soil", "slab"))
    return min(np.prod(soil), np.prod(slab))


def force(run):
    """Force that drags the slab over its exact value, at each row of the history."""
    return -run.history["slab_force_x"] / (LIMIT * area(run))


def check(runs):
    for run_name, run in runs.items():
        name, why = run_name.replace("_", " "), PLOUGHS if run_name == "wider_clay" else ""
        late = run.history["time"] > run.number("time_end") / 3
        yield Row(f"force over tau_max A, {name}", force(run)[late].mean(), 1, 0.01, "definition", relative=True,
                  shortfall=why, bound=0.4)


def draw(axes, runs):
    for name, run in runs.items():
        axes.plot(0.5 * run.history["time"], force(run), lw=1, label=name.replace("_", " "))
    axes.axhline(1, color="k", lw=0.8)
    axes.set(xlabel="distance dragged (m)", ylabel="force over $\\tau_{max} A$", ylim=(0, None))
    axes.legend()
