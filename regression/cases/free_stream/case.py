"""Free flight

A body that moves with one velocity must keep that velocity, must not be strained, and must move by $v t$. In `mpm`
this holds to round-off if the weights of each particle sum to 1 and their gradients to 0, wherever the particle is, and if
nodes with almost no mass at the edge of the body cause no error. The mesh begins at odd numbers; the body crosses 28 cells.
"""

import numpy as np

from mpm_regression.curves import first_frame, last_frame
from mpm_regression.row import Row

IN_3D = ("-dim 3 -mesh_lower -17.31,4.77,2.11 -mesh_upper -8.21,12.57,9.91 -body_centre -15,7,5 -body_radius 0.6"
         " -body_velocity 0.73,0.41,-0.37 -mesh_spacing 0.26 -time_end 3 -output_interval 3 -mesh_zmin free -mesh_zmax free")
RUNS = {"2D": "", "3D": IN_3D}


def check(runs):
    for name, run in runs.items():
        dim = int(run.number("dim", 2))
        velocity = np.array(run.numbers("body_velocity"))
        start, end = first_frame(run, "body"), last_frame(run, "body")
        moved = end["position"][:, :dim].mean(axis=0) - start["position"][:, :dim].mean(axis=0)
        error = np.abs(end["velocity"][:, :dim] - velocity).max() / np.linalg.norm(velocity)
        yield Row(f"largest change of velocity over the velocity, {name}", error, 0, 1e-12, "Newton's first law", single=1e-5)
        error = np.abs(end["stress"]).max() / run.number("elastic_young")
        yield Row(f"largest stress over Young's modulus, {name}", error, 0, 1e-12, "rigid motion", single=1e-5)
        error = np.abs(moved - velocity * run.number("time_end")).max() / run.number("mesh_spacing")
        yield Row(f"error of the distance flown, cells, {name}", error, 0, 1e-9, "Newton's first law", single=1e-3)
