"""Rigid bodies that meet

*Line*: a disc hits two others on a line; with a restitution of 1 the velocity is passed on, with 0.5 the velocities are those of one
impact after the other. *Rolls*, *slips*: a wheel on a rigid plane. *Sets*: a wheel that is set on a level plane while it slides rolls
after $v / (3 \\mu g)$, with 2/3 of the velocity. *Slides*: a block on a plane with a friction less than its slope. *Rocks*: a slender
block that is let go beside its upright place turns about one corner, and after the impact about the other one; its quarter periods and
the loss of spin are Housner's. *Sphere*: a sphere slips or rolls down a plane of 45° in 3D. *Stack*: ten blocks on each other rest.
"""

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row

G, HOUSNER, ROCKING = 9.81, "Housner (1963)", "integral of the motion about a corner"
SIN, COS = np.sin(np.radians(20)), np.cos(np.radians(20))
DISC = "-{0}_shape disc -{0}_radius 0.4 -{0}_motion dynamic -{0}_mass 100 -{0}_restitution {1}"


def line(restitution):
    discs = " ".join(DISC.format(name, restitution) for name in "abc")
    return (f"-gravity 0,0 -rigid_bodies a,b,c {discs} -a_centre 2,2 -b_centre 3,2 -c_centre 4.1,2 -a_velocity 2,0"
            " -mesh_xmin free -mesh_xmax free")


STEEP = np.radians(40)
FLOOR = " -rigid_bodies {0},floor -floor_shape half_plane -floor_point 0,0.5 -floor_normal 0,1 -floor_particles_per_cell 1"
SETS = FLOOR.format("wheel") + " -wheel_centre 2,1 -wheel_velocity 1,0 -rigid_friction 0.2 -time_end 0.5"
BLOCK = (" -rigid_bodies block,slope -block_shape box -block_lower 1,3 -block_upper 1.6,3.3 -block_angle_deg -20 -block_motion dynamic"
         " -block_density 2600 -block_free x,y,rz")
ALPHA = np.arctan(0.2 / 0.8)


def rocks(share):
    """A block that is turned by a share of alpha about its left lower corner."""
    return (FLOOR.format("block") + " -rigid_friction 2 -block_shape box -block_lower 4,0.5 -block_upper 4.2,1.3 -block_motion dynamic"
            f" -block_density 2600 -block_free x,y,rz -block_angle_deg {np.degrees(share * ALPHA):.17g} -time_step 2e-4 -time_end 0.6"
            " -history_interval 1e-3")


SPHERE = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 26,4,26 -mesh_ymax roller -mesh_zmax free -mesh_spacing 0.5 -gravity 0,0,-9.81 -pad_lower 25,0,25 -pad_upper 25.5,0.5,25.5"
          f" -wheel_shape ball -wheel_radius 1 -wheel_centre {1 + 0.5**0.5!r},2,{24 + 0.5**0.5!r} -wheel_free x,y,z,rx,ry,rz"
          " -slope_point 1,2,24 -slope_normal 1,0,1 -time_end 3 -history_interval 0.1 -rigid_friction {0}")
SPHERES = (0, 0.1, 0.2, 0.4, 1)  # friction
NAMES = [f"b{n}" for n in range(10)]
STACK = FLOOR.format(",".join(NAMES)) + " -rigid_friction 0.5 -time_end 5 -history_interval 0.1" + "".join(
    f" -b{n}_shape box -b{n}_lower 4,{0.5 + 0.3 * n!r} -b{n}_upper 4.3,{0.8 + 0.3 * n!r} -b{n}_motion dynamic -b{n}_density 2600"
    f" -b{n}_free x,y,rz" for n in range(10))
RUNS = {"line": line(1), "line_half": line(0.5), "rolls": "",
        "slips": f"-rigid_friction 0.1 -slope_normal {np.sin(STEEP):.17g},{np.cos(STEEP):.17g} -wheel_centre {1 + 0.5 * np.sin(STEEP):.17g},"
                 f"{3 + 0.5 * np.cos(STEEP):.17g} -time_end 0.6",
        "sets": SETS, "slides": BLOCK, "rocks_25": rocks(0.25), "rocks_50": rocks(0.5), "rocks_75": rocks(0.75), "stack": STACK,
        **{f"sphere_{friction:g}": SPHERE.format(friction) for friction in SPHERES}}


def along(run, name):
    """Velocity down the slope of 20 degrees."""
    return COS * run.history[f"{name}_velocity_x"] - SIN * run.history[f"{name}_velocity_y"]


def check(runs):
    run = runs["line"]
    for name, speed in zip("abc", (0, 0, 2)):
        yield Row(f"velocity of disc {name} at the end, restitution 1 (m/s)", run.history[f"{name}_velocity_x"][-1], speed, 1e-9,
                  "conservation", single=1e-6)
    run = runs["line_half"]
    for name, speed in zip("abc", (0.5, 0.375, 1.125)):
        yield Row(f"velocity of disc {name} at the end, restitution 0.5 (m/s)", run.history[f"{name}_velocity_x"][-1], speed, 1e-9,
                  "Newton's law of impact", single=1e-6)
    run = runs["rolls"]
    yield Row("acceleration of a wheel that rolls down 20 degrees (m/s2)", slope(run.history["time"], along(run, "wheel"), 0.2), 2 / 3 * G * SIN,
              1e-3, "rolling", relative=True)
    run, t = runs["slips"], runs["slips"].history["time"]
    down = np.cos(STEEP) * run.history["wheel_velocity_x"] - np.sin(STEEP) * run.history["wheel_velocity_y"]
    yield Row("acceleration of a wheel that slips down 40 degrees (m/s2)", slope(t, down, 0.2), G * (np.sin(STEEP) - 0.1 * np.cos(STEEP)), 1e-3,
              "Coulomb friction", relative=True)
    yield Row("its angular acceleration times the radius (m/s2)", -0.5 * slope(t, run.history["wheel_angular_velocity"], 0.2),
              2 * 0.1 * G * np.cos(STEEP), 1e-3, "Coulomb friction", relative=True)
    run = runs["sets"]
    slip = run.history["wheel_velocity_x"] + 0.5 * run.history["wheel_angular_velocity"]
    yield Row("time at which a sliding wheel rolls (s)", np.interp(0, -slip[slip > 1e-3], run.history["time"][slip > 1e-3])
              + slip[slip > 1e-3][-1] / (3 * 0.2 * G), 1 / (3 * 0.2 * G), 0.01, "Coulomb friction", relative=True)
    yield Row("its velocity then (m/s)", run.history["wheel_velocity_x"][-1], 2 / 3, 1e-3, "Coulomb friction", relative=True)
    run = runs["slides"]
    yield Row("acceleration of a block that slides down 20 degrees (m/s2)", slope(run.history["time"], along(run, "block"), 0.2),
              G * (SIN - 0.3 * COS), 1e-3, "Coulomb friction", relative=True)
    yield Row("its rotation at the end (rad)", run.history["block_angle"][-1], 0, 1e-6, "equilibrium")
    for share, name, period in ((0.25, "rocks_25", 0.75552), (0.5, "rocks_50", 1.24923), (0.75, "rocks_75", 1.95549)):
        run = runs[name]
        spin, t = run.history["block_angular_velocity"], run.history["time"]
        peak = np.argmax(np.abs(spin))
        yield Row(f"period of a rocking block, from {share:g} alpha (s)", 2 * (t[peak] + t[peak + 1]), period, 0.01, ROCKING,
                  relative=True)
        yield Row("its spin after the impact over that before", spin[peak + 2] / spin[peak], 1 - 1.5 * np.sin(ALPHA) ** 2, 0.01, HOUSNER,
                  relative=True)
    for friction in SPHERES:
        way = 9 / 2 * G * 0.5**0.5 * max(5 / 7, 1 - friction)  # m, by 3 s: it rolls where it does not slip
        h = runs[f"sphere_{friction:g}"].history
        yield Row(f"way of a sphere down 45 degrees after 3 s, friction {friction:g} (m)", np.hypot(h["wheel_x"][-1], h["wheel_z"][-1]), way, 1e-3,
                  "rolling" if friction > 2 / 7 else "Coulomb friction", relative=True)
    run = runs["stack"]
    drift = max(np.abs(run.columns(f"{name}_")[:, 0]).max() for name in NAMES)
    sink = max(-run.columns(f"{name}_")[:, 1].min() for name in NAMES)
    yield Row("largest drift of a block of a stack over its edge", drift / 0.3, 0, 0.01, "equilibrium")
    yield Row("largest way down of a block of a stack over its edge", sink / 0.3, 0, 0.02, "equilibrium")


def draw(axes, runs):
    for name in ("rocks_25", "rocks_50", "rocks_75"):
        axes.plot(runs[name].history["time"], runs[name].history["block_angle"], label=name)
    axes.set(xlabel="time (s)", ylabel="rotation (rad)")
    axes.legend()
