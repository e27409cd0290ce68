"""Slab dragged over clay

A slab whose interface slips at $\\tau_{max}$ is dragged over clay, and needs the force $\\tau_{max} A$: whatever the clay does
below, and wherever the ends of the slab stand in their cells. The interface must touch for that, so the slab is lowered by
1.2 mm while it moves by 0.3 m (six cells); the clay ahead of its front face, over that height, adds less than 0.1 % at
a pressure of $s_u$. The mean force over the last two thirds is compared.
"""

import numpy as np

from row import Row

LIMIT = 1000.0
FACES = "Nodes below the underside and beside the slab's ends touch it too."
RUNS = {
    "on_nodes": "",
    "off_nodes": "-slab_lower 1.2623,1 -slab_upper 2.2801,1.25",
    "3D": ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 2.4,1.6,0.9 -mesh_spacing 0.1 -soil_lower 0,0,0 -soil_upper 2.4,1.6,0.5"
           " -slab_lower 0.43,0.48,0.5 -slab_upper 1.27,1.13,0.8 -slab_velocity 0.5,0,-0.002 -mesh_ymin roller -mesh_ymax roller"
           " -mesh_zmin fixed -mesh_zmax free"),
}
LONG = True


def area(run):
    """Area of the underside, m2 (2D: m)."""
    lower, upper = np.array(run.numbers("slab_lower")), np.array(run.numbers("slab_upper"))
    return np.prod((upper - lower)[:-1])


def force(run):
    """Force that drags the slab over its exact value, at each row of the history."""
    return -run.history["slab_force_x"] / (LIMIT * area(run))


def check(runs):
    for name, run in runs.items():
        late = run.history["time"] > run.number("time_end") / 3
        yield Row(f"force over tau_max A, {name}", force(run)[late].mean(), 1, 0.01, "definition", relative=True,
                  shortfall=FACES, bound=6)
        yield Row(f"standard deviation of the force over tau_max A, {name}", force(run)[late].std(), 0, 0.05, "definition",
                  shortfall=FACES, bound=0.5)


def draw(axes, runs):
    for name, run in runs.items():
        axes.plot(0.5 * run.history["time"], force(run), lw=1, label=name)
    axes.axhline(1, color="k", lw=0.8)
    axes.set(xlabel="distance dragged (m)", ylabel="force over $\\tau_{max} A$", ylim=(0.7, 1.3))
    axes.legend()
