"""Rigid body that is free to move

Two problems. *Hit*: a rigid disc hits an elastic one, and a rigid ball an elastic one, without gravity and walls: the
total momentum must be conserved to round-off. *Fall*: under gravity alone the body must fall by $g t^2/2$.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

BALLS = ("-dim 3 -mesh_lower -2.3,-1.3,-1.3 -mesh_upper 2.9,1.3,1.3 -soil_centre 0.83,0.07,0.05 -soil_radius 0.6"
         " -ram_centre -0.61,-0.13,-0.11 -ram_velocity 1.3,0.2,-0.1 -mesh_zmin free -mesh_zmax free -mesh_spacing 0.13"
         " -time_end 0.6 -output_interval 0.6")
FALL = "-gravity 0,-9.81 -ram_velocity 0,0 -ram_centre -0.61,1.2 -time_end 0.4 -soil_centre 1.83,1.2 -output_interval 0.4"
RUNS = {"hit_2D": "", "hit_3D": BALLS, "fall_2D": FALL}


def mass(run):
    """Mass of the rigid body, kg, as its particles fill it."""
    count = len(last_frame(run, "ram")["position"])
    return count * run.number("ram_density") * (run.number("mesh_spacing") / 4) ** int(run.number("dim", 2))


def momentum(run):
    return run.columns("soil_momentum_") + mass(run) * run.columns("ram_velocity_")


def check(runs):
    for name in ("hit_2D", "hit_3D"):
        p = momentum(runs[name])
        change = np.abs(p - p[0]).max() / np.linalg.norm(p[0])
        yield Row(f"change of the momentum over the momentum, {name}", change, 0, 1e-12, "Newton's third law", single=1e-5)
        given = np.linalg.norm(runs[name].columns("soil_momentum_")[-1]) / np.linalg.norm(p[0])
        yield Row(f"share of the momentum that the soil has at the end, {name}", given, 0.2, 0, "the bodies did meet", at_least=True)
    run = runs["fall_2D"]
    t = run.number("time_end")
    yield Row("distance fallen over g t^2/2", -run.history["ram_y"][-1] / (9.81 * t**2 / 2), 1, 1e-12, "free fall", single=1e-5)


def draw(axes, runs):
    run = runs["hit_2D"]
    t, whole = run.history["time"], momentum(run)
    axes.plot(t, run.columns("soil_momentum_")[:, 0], label="soil")
    axes.plot(t, mass(run) * run.history["ram_velocity_x"], label="rigid body")
    axes.plot(t, whole[:, 0], "k--", lw=0.8, label="together")
    axes.set(xlabel="time (s)", ylabel="momentum along x (kg m/s per m)")
    axes.legend()
