"""A cylinder and a sphere that drain

A saturated elastic cylinder in plane strain and a sphere, of the radius 1 m and drained at their surface, under a pressure $q$ = 10 kPa all
round (Cryer 1963; bodies of revolution). The surface drains and shrinks first, and presses the middle: the pressure there rises above $q$.
Both begin with the stress and pressure of the undrained load. The displacement of the surface is that of the outermost particles
of the cylinder and the strain of the quarter of a cell beyond their centres. The time is $T = c_v t / R^2$.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, time_of

LOAD, RATE, MODULUS, LAME = 10e3, 1.19457, 12e6, 4e6  # Pa, cv [m2/s] as scaled, Pa, Pa
CELL = {"cylinder": 0.025, "sphere": 0.05}  # m
START = 157.5 / 16e6  # strain of the cylinder under its undrained load
ANGLES = np.linspace(0, np.pi / 2, 91)
SPHERE = ",".join(["0", "0", *(f"{v:.6f}" for a in ANGLES for v in (np.cos(a), np.sin(a)))])
RUNS = {"cylinder": "", "sphere": f" -mesh_upper 1.1,1.1 -mesh_ymax free -mesh_spacing 0.05 -soil_polygon {SPHERE} -time_end 0.18"
                                  " -soil_stress -131.6,-131.6,-131.6,0 -soil_pore_pressure 9868.4"}
# T: pressure over q in the middle, displacement of the surface [m]: Laplace transform.
EXACT = {"cylinder": {0.05: (1.13644, 2.2185e-4), 0.1: (1.05185, 3.0826e-4), 0.2: (0.71997, 4.2104e-4), 0.5: (0.19858, 5.6905e-4)},
         "sphere": {0.05: (1.28467, None), 0.1: (1.09567, None), 0.2: (0.59150, None)}}
PRECISIONS = ("double",)
LONG = True


def check(runs):
    for name, run in runs.items():
        start = read_frame(run.frames[0])[1]["soil"]["position"]
        middle, outer = np.linalg.norm(start, axis=1) < CELL[name], start[:, 0] > start[:, 0].max() - 0.1 * CELL[name]
        for t, (pressure, displacement) in EXACT[name].items():
            frames = [read_frame(path)[1]["soil"] for path in run.frames if abs(time_of(path) - t / RATE) < 0.0051]
            found = np.mean([frame["pore_pressure"][middle].mean() for frame in frames]) / LOAD
            yield Row(f"pressure over the load in the middle, {name}, T = {t:g}", found, pressure, 0.03, "Laplace transform")
            if displacement is None:
                continue
            moved = START - np.mean([(frame["position"][outer, 0] - start[outer, 0]).mean() for frame in frames])
            moved += (LOAD - LAME * displacement) / MODULUS * CELL[name] / 4  # drained strain beyond their centres
            yield Row(f"displacement of the surface over the exact one, {name}, T = {t:g}", moved / displacement, 1, 0.02, "Laplace transform")
