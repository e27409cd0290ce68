"""Joints of rigid bodies

*Pendulum*: a rod of 1 m swings about its end from 60° to both sides; its period is that of the elliptic integral. *Drift*: the same for 100
swings: how far its energy and its joint are off. *Slow*, *fast*: two such rods on hinges, released in one of their two modes. *Top*: a heavy
top on a ball joint in steady slow precession. *Cone*: a mass on a rod that circles at 30° to the vertical. *Cable*: a body falls until its cable
is taut. *Slider*: a body slides along a line of 30° to the horizontal. *Stops*: the pendulum falls against a stop at 10°. *Welded*: two bodies,
thrown and spinning, move as the one that they are. *Tow*: a body on a cable whose other end accelerates. *Spring*, *damped*: a mass on a spring,
without and with a dashpot.
"""

import numpy as np

from mpm_regression.row import Row

LONG = True
G = 9.81


def rod(name, x, y, more=""):
    """A rod of 1 m and 12 kg, as a disc."""
    return (f" -{name}_shape disc -{name}_centre {x:.16g},{y:.16g} -{name}_radius 0.2 -{name}_motion dynamic -{name}_free x,y,rz"
            f" -{name}_mass 12 -{name}_inertia 1 {more}")


def double(first, second, end):
    """Two rods that hang from one another, at angles from the vertical."""
    x, y = 2 + np.sin(first), 3 - np.cos(first)
    return (f"-time_end {end} -history_interval 0.001 -rigid_bodies rod,low" + rod("rod", 2 + np.sin(first) / 2, 3 - np.cos(first) / 2)
            + rod("low", x + np.sin(second) / 2, y - np.cos(second) / 2)
            + f" -joints pin,knee -knee_kind hinge -knee_bodies low,rod -knee_point {x:.16g},{y:.16g}")


SPACE = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 4,4,4 -mesh_spacing 0.5 -gravity 0,0,-9.81 -bed_lower 0,0,0 -bed_upper 0.5,0.5,0.5 -mesh_zmax free "
         "-rigid_bodies top -top_shape ball -top_radius 0.3 -top_motion dynamic -top_free x,y,z,rx,ry,rz -top_mass 1 -pin_point 2,2,2")
TILT, SPIN, ARM, ACROSS, ALONG = np.radians(30), 200.0, 0.1, 0.012 - 0.1**2, 0.003  # of the top: inertia about its centre
PRECESSION = 1.68413


def top():
    axis, up = np.array([np.sin(TILT), 0, np.cos(TILT)]), np.array([0, 0, 1])
    inertia = ACROSS * np.eye(3) + (ALONG - ACROSS) * np.outer(axis, axis)
    spin = (SPIN - PRECESSION * np.cos(TILT)) * axis + PRECESSION * up
    centre, velocity = np.array([2, 2, 2]) + ARM * axis, np.cross(spin, ARM * axis)
    text = {word: ",".join(f"{x:.16g}" for x in values) for word, values in
            {"centre": centre, "velocity": velocity, "angular_velocity": spin,
             "inertia": [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[1, 2], inertia[2, 0]]}.items()}
    return SPACE + " -time_end 1 -time_step 2e-4 -pin_bodies top,ground" + "".join(f" -top_{word} {value}" for word, value in text.items())


CONE = np.sqrt(G / np.cos(TILT))  # rad/s, of a mass on a rod of 1 m
CIRCLE = (SPACE.replace("x,y,z,rx,ry,rz", "x,y,z") + f" -pin_kind rod -pin_bodies top,ground -pin_point 2.5,2,2 -top_centre 2.5,2,2"
          f" -pin_other_point 2,2,{2 + np.cos(TILT):.16g} -top_velocity 0,{0.5 * CONE:.16g},0 -time_step 5e-4")
MODES = {"slow": 2.34437, "fast": 0.87404}
MASS, STIFFNESS = 12.0, 12.0 * np.pi**2
RUNS = {
    "pendulum": "-time_end 2 -history_interval 0.001",
    "drift": "-time_end 176",
    "slow": double(0.01, 0.014305, 5),
    "fast": double(0.01, -0.020972, 2),
    "top": top(),
    "cone": CIRCLE,
    "cable": "-pin_kind cable -pin_other_point 2.4330127018922192,3 -pin_length 1 -rod_centre 2.4330127018922192,2.75 -pin_point 2.4330127018922192,2.75 -time_end 1",
    "slider": "-pin_kind slider -pin_axis 1.7320508075688772,1 -rod_centre 3,3 -pin_point 3,3 -time_end 0.5",
    "stops": "-pin_kind hinge -pin_stop_deg -50,10 -time_end 1.5",
    "welded": "-gravity 0,0 -rigid_bodies rod,low" + rod("rod", 1.5, 2, "-rod_velocity 0.1,0 -rod_angular_velocity 1") + rod("low", 2.5, 2, "-low_velocity 0.1,1 -low_angular_velocity 1")
    + " -pin_kind weld -pin_bodies low,rod -pin_point 2,2 -time_end 2",
    "tow": "-gravity 0,0 -rod_centre 1,2 -pin_kind cable -pin_point 1,2 -pin_other_point 2,2 -pin_velocity_table -1:-1:0,0:0:0,2:1:0 -time_end 1",
    "spring": f"-gravity 0,0 -joints -rod_velocity 1,0.5 -rod_stiffness {STIFFNESS},{4 * STIFFNESS},{np.pi**2} -rod_angular_velocity 2",
    "damped": f"-gravity 0,0 -joints -rod_velocity 1,0 -rod_stiffness {STIFFNESS},0,0 -rod_viscosity {0.2 * MASS * np.pi},0,0",
}


def crossings(t, y):
    """Times at which y passes 0, in s."""
    at = np.flatnonzero(np.sign(y[1:]) * np.sign(y[:-1]) < 0)
    return t[at] - y[at] * (t[at + 1] - t[at]) / (y[at + 1] - y[at])


def energy(run):
    """Kinetic energy and energy of height of the rod, J."""
    return run.history["rod_kinetic_energy"] + 12 * G * run.history["rod_y"]


def at_joint(run):
    """Where the joint's point of the pendulum is, less where it is held, m."""
    angle, arm = run.history["rod_angle"], np.array([2 - 2.4330127018922192, 3 - 2.75])
    x = 2.4330127018922192 + run.history["rod_x"] + np.cos(angle) * arm[0] - np.sin(angle) * arm[1] - 2
    y = 2.75 + run.history["rod_y"] + np.sin(angle) * arm[0] + np.cos(angle) * arm[1] - 3
    return np.hypot(x, y)


def check(runs):
    run = runs["pendulum"]
    yield Row("pendulum from 60°: half a period (s)", crossings(run.history["time"], run.history["rod_angular_velocity"])[0], 1.75781 / 2, 1e-3,
              "elliptic integral", relative=True)
    run = runs["drift"]
    yield Row("100 swings: largest change of the energy over that of the fall", np.abs(energy(run) - energy(run)[0]).max() / (12 * G / 4), 0, 1e-4, "no work")
    yield Row("100 swings: largest distance of the joint from its place (m)", at_joint(run).max(), 0, 1e-9, "held")
    for name, period in MODES.items():
        run = runs[name]
        yield Row(f"double pendulum, {name} mode: period (s)", 2 * np.diff(crossings(run.history["time"], 0.01 + run.history["rod_angle"]))[-1], period, 1e-3,
                  "small swings", relative=True)
    run = runs["top"]
    x, y = 2 * ARM * np.sin(TILT) / 2 + run.history["top_x"], run.history["top_y"]
    yield Row("heavy top: precession (rad/s)", np.unwrap(np.arctan2(y, x))[-1] / run.history["time"][-1], PRECESSION, 1e-3, "steady precession", relative=True)
    run = runs["cone"]
    x, y = 0.5 + run.history["top_x"], run.history["top_y"]
    yield Row("conical pendulum: angular velocity (rad/s)", np.unwrap(np.arctan2(y, x))[-1] / run.history["time"][-1], CONE, 1e-4, "sqrt(g / (l cos a))", relative=True)
    yield Row("conical pendulum: force of the rod (N)", np.linalg.norm([run.history["pin_force_z"][-1]]) / np.cos(TILT), G / np.cos(TILT), 1e-3, "m g / cos a", relative=True)
    run = runs["cable"]
    length = 0.25 - run.history["rod_y"]
    yield Row("cable: largest length (m)", length.max(), 1, 1e-9, "taut")
    yield Row("cable: length after 0.3 s (m)", np.interp(0.3, run.history["time"], length), 0.25 + G * 0.3**2 / 2, 1e-9, "free fall")
    yield Row("cable: force at the end (N)", run.history["pin_force_y"][-1], 12 * G, 1e-6, "weight", relative=True)
    run = runs["slider"]
    t = run.history["time"][-1]
    yield Row("slider: way down a line of 30° (m)", np.hypot(run.history["rod_x"][-1], run.history["rod_y"][-1]), G / 2 * t**2 / 2, 1e-9, "g sin a t^2 / 2")
    yield Row("slider: angle (rad)", np.abs(run.history["rod_angle"]).max(), 0, 1e-12, "held")
    run = runs["stops"]
    yield Row("stop: largest angle (degrees)", np.degrees(run.history["rod_angle"].min()), -50, 1e-7, "-50")
    yield Row("stop: moment at the end (N m)", run.history["pin_moment"][-1], 12 * G * 0.5 * np.sin(np.radians(10)), 1e-6, "m g l / 2 sin 10°", relative=True)
    run = runs["welded"]
    spin = (2 * 1 + 2 * 12 * 0.5**2 * 1) / (2 * (1 + 12 * 0.5**2))
    t = run.history["time"][-1]
    yield Row("weld: angle of two bodies as one (rad)", run.history["rod_angle"][-1], spin * t, 1e-6, "angular momentum; of second order in the step")
    yield Row("weld: angle between them (rad)", np.abs(run.history["rod_angle"] - run.history["low_angle"]).max(), 0, 1e-9, "held")
    yield Row("weld: way of their centre (m)", (run.history["rod_y"] + run.history["low_y"])[-1] / 2, 0.5 * t, 1e-9, "momentum")
    run = runs["tow"]
    yield Row("tow: distance of both ends at the end (m)", 1 + run.history["time"][-1]**2 / 4 - run.history["rod_x"][-1], 1, 2e-3, "cable")
    yield Row("tow: force at the end (N)", run.history["pin_force_x"][-1], 12 * 0.5, 1e-3, "m a", relative=True)
    run = runs["spring"]
    t = run.history["time"]
    for what, size, period in (("x", 1 / np.pi, 2), ("y", 0.25 / np.pi, 1), ("angle", 2 / np.pi, 2)):
        got = run.history[f"rod_{what}"]
        yield Row(f"spring, {what}: period (s)", 2 * np.diff(crossings(t[1:], got[1:]))[-1], period, 1e-4, "2 pi sqrt(m / k)", relative=True)
        yield Row(f"spring, {what}: amplitude", np.abs(got[t > 2]).max(), size, 1e-3, "kept", relative=True)
    run = runs["damped"]
    t, w = run.history["time"], np.pi * np.sqrt(1 - 0.01)
    exact = np.exp(-0.1 * np.pi * t) * np.sin(w * t) / w
    yield Row("spring with a dashpot of 0.1 of the critical one: largest error over the amplitude", np.abs(run.history["rod_x"] - exact).max() * np.pi, 0, 1e-3, "damped oscillator")


def draw(axes, runs):
    for name in ("slow", "fast"):
        run = runs[name]
        axes.plot(run.history["time"], 0.01 + run.history["rod_angle"], label=f"upper rod, {name} mode")
    axes.set(xlabel="time (s)", ylabel="angle (rad)")
    axes.legend()
