"""Slab pushed over clay by a force

A rigid slab of mass $M$ that is free to move is pressed on a strip of clay that lies wholly under it, and pushed over it by a
horizontal force $F$, larger than the resistance of the interface, $\\tau_{max} A$. The slab must have the acceleration
$(F - \\tau_{max} A)/M$. The clay carries the vertical force (3 kPa) from the start. The acceleration is taken from
0.05 s on, when the shear has built up. The check compares the resistance $F - M a$ with $\\tau_{max} A$.
"""

import numpy as np

from mpm_regression.curves import last_frame, slope
from mpm_regression.row import Row

LIMIT = 1000.0
RUNS = {
    "2D": "",
    "3D": ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 2.4,1.2,0.7 -mesh_spacing 0.1 -soil_lower 0.537,0.313,0 -soil_upper 1.587,0.863,0.2"
           " -slab_lower 0.2,0.1,0.2 -slab_upper 1.8,1.1,0.5 -mesh_zmin fixed -mesh_zmax free -slab_force 1100,0,-1732.5 -soil_stress 0,0,-3000,0,0,0"),
}
LONG = True


def mass(run):
    """Mass of the slab, kg, as its particles fill it."""
    count = len(last_frame(run, "slab")["position"])
    return count * run.number("slab_density") * (run.number("mesh_spacing") / 4) ** int(run.number("dim", 2))


def resistance(run):
    """Force that holds the slab, F - M a, over tau_max A."""
    area = np.prod(np.subtract(run.numbers("soil_upper"), run.numbers("soil_lower"))[:-1])
    a = slope(run.history["time"], run.history["slab_velocity_x"], 0.05)
    return (run.number("slab_force") - mass(run) * a) / (LIMIT * area)


def check(runs):
    for name, run in runs.items():
        yield Row(f"resistance F - M a over tau_max A, {name}", resistance(run), 1, 0.01, "Newton's second law", relative=True)


def draw(axes, runs):
    for name, run in runs.items():
        t = run.history["time"]
        axes.plot(t, run.history["slab_velocity_x"], label=name)
    axes.set(xlabel="time (s)", ylabel="speed of the slab (m/s)")
    axes.legend()
