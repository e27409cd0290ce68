"""Rigid bodies that turn

*Tumbles*: a brick with three different moments of inertia turns freely; its angular velocity in space after 2 s is that of
Euler's equations, integrated by a Runge-Kutta method. *Driven*: a constant moment $M$ turns a plate by $M t^2 / (2 I)$. *Rolls*:
a wheel with a friction of 0.5 rolls down a slope of 20°: its angular velocity is its velocity over its radius. *Slips*: with a
friction of 0.05 it slips and gains the angular velocity $2 \\mu g \\cos\\theta\\, t / R$. The friction is that of the normal force
$M g \\cos\\theta$, whose mean the soil gives while the wheel shakes on it, so the rate is a slope over the run.
"""

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row

G, SLOPE = 9.81, np.radians(20)
EDGES, SPIN, DENSITY = np.array([1.0, 1.25, 0.5]), np.array([1.0, 2.0, 0.5]), 2000.0
PLATE = ("-mesh_lower 0,0 -mesh_upper 4,4 -bed_upper 4,0.5 -gravity 0,0 -time_end 1 -rigid_bodies plate -plate_shape box -plate_lower 1.5,2"
         " -plate_upper 2.5,2.25 -plate_motion dynamic -plate_density 2000 -plate_free rz -plate_moment 300 -plate_inertia 400")
BRICK = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 4,4,4 -mesh_spacing 0.25 -gravity 0,0,0 -bed_lower 0,0,0 -bed_upper 4,4,0.5 -mesh_zmin fixed"
         " -mesh_zmax free -time_end 2 -time_step 2e-4 -rigid_bodies brick -brick_shape box -brick_lower 1.5,1.375,2 -brick_upper 2.5,2.625,2.5"
         " -brick_motion dynamic -brick_density 2000 -brick_free x,y,z,rx,ry,rz -brick_angular_velocity 1,2,0.5")
RUNS = {"rolls": "", "slips": "-wheel_friction 0.05", "driven": PLATE, "tumbles": BRICK}


def tumbled(time, steps=20000):
    """Angular velocity in space of the brick after a time, rad/s."""
    moments = (EDGES @ EDGES - EDGES**2) / 12
    spin, turn, dt = SPIN.copy(), np.eye(3), time / steps

    def rates(w, r):
        skew = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return -np.cross(w, moments * w) / moments, r @ skew

    for _ in range(steps):
        k1 = rates(spin, turn)
        k2 = rates(spin + dt / 2 * k1[0], turn + dt / 2 * k1[1])
        k3 = rates(spin + dt / 2 * k2[0], turn + dt / 2 * k2[1])
        k4 = rates(spin + dt * k3[0], turn + dt * k3[1])
        spin = spin + dt / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        turn = turn + dt / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return turn @ spin


def check(runs):
    run = runs["tumbles"]
    got = run.columns("brick_angular_velocity_")[-1]
    off = np.linalg.norm(got - tumbled(run.history["time"][-1])) / np.linalg.norm(got)
    yield Row("angular velocity of a brick that tumbled for 2 s: difference over its size", off, 0, 1e-5, "Euler's equations")
    run = runs["driven"]
    t = run.history["time"][-1]
    yield Row("angle by a constant moment (rad)", run.history["plate_angle"][-1], 300 * t**2 / (2 * 400), 1e-10, "M t^2 / (2 I)")
    run = runs["rolls"]
    late = run.history["time"] > 0.4
    yield Row("mean angular velocity over the mean velocity from 0.4 s on, rolls (1/m)",
              -run.history["wheel_angular_velocity"][late].mean() / run.history["wheel_velocity_x"][late].mean(), 1, 0.01, "rolling")
    run = runs["slips"]
    yield Row("angular acceleration, slips (rad/s2)", -slope(run.history["time"], run.history["wheel_angular_velocity"], 0.2),
              2 * 0.05 * G * np.cos(SLOPE), 0.02, "Coulomb friction", relative=True)


def draw(axes, runs):
    for name in ("rolls", "slips"):
        run = runs[name]
        axes.plot(run.history["time"], -run.history["wheel_angular_velocity"], label=f"{name}: angular velocity (rad/s)")
        axes.plot(run.history["time"], run.history["wheel_velocity_x"], "--", label=f"{name}: velocity (m/s)")
    axes.set(xlabel="time (s)")
    axes.legend()
