"""Slab pushed over clay by a force

A rigid slab of mass $M$ that is free to move is pressed on clay by a vertical force and pushed over it by a horizontal one,
$F$, larger than what the interface can hold, $\\tau_{max} A$. It must take the acceleration $(F - \\tau_{max} A)/M$. The
vertical force (5.8 kPa, a third of the bearing capacity) acts at once, so the slab bounces at first; the acceleration is
taken from 0.15 s on, when its bounces are over.
"""

import numpy as np

from curves import last_frame, slope
from row import Row

LIMIT = 1000.0
FACES = "Nodes below the underside and beside the slab's ends touch it too."
RUNS = {
    "2D": "",
    "3D": ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 2.8,1.6,0.9 -mesh_spacing 0.1 -mesh_ymin roller -mesh_ymax roller -mesh_zmin fixed"
           " -mesh_zmax free -soil_lower 0,0,0 -soil_upper 2.8,1.6,0.5 -slab_lower 0.43,0.48,0.5 -slab_upper 1.27,1.13,0.8"
           " -slab_force 1500,0,-3000"),
}
LONG = True


def mass(run):
    """Mass of the slab, kg, as its particles fill it."""
    count = len(last_frame(run, "slab")["position"])
    return count * run.number("slab_density") * (run.number("mesh_spacing") / 4) ** int(run.number("dim", 2))


def resistance(run):
    """What holds the slab, F - M a, over tau_max A."""
    area = np.prod(np.subtract(run.numbers("slab_upper"), run.numbers("slab_lower"))[:-1])
    a = slope(run.history["time"], run.history["slab_velocity_x"], 0.15)
    return (run.number("slab_force") - mass(run) * a) / (LIMIT * area)


def check(runs):
    for name, run in runs.items():
        yield Row(f"resistance F - M a over tau_max A, {name}", resistance(run), 1, 0.01, "Newton's second law", relative=True,
                  shortfall=FACES, bound=3)


def draw(axes, runs):
    for name, run in runs.items():
        t = run.history["time"]
        axes.plot(t, run.history["slab_velocity_x"], label=name)
    axes.set(xlabel="time (s)", ylabel="speed of the slab (m/s)")
    axes.legend()
