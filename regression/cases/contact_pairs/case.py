"""Deformable bodies that touch

*Block*: an elastic block slides down an elastic slope of 25 degrees, with friction, and with a limited shear stress, with its face on nodes and between them. *Bars*: a bar of 1 m
hits one of 1 m, or of 2 m, along the axis. *Discs*: two discs meet on a diagonal of the mesh. *Balls*: two balls meet on the axis of a body of
revolution. *Halves*: two welded halves of a block of clay against the whole, where they share a velocity field, and where a third body gives each one of its own.
*Pressed*: a rigid plate presses two bodies side by side between smooth walls, against one body. *On two*: a body rests on two that stick to each other.
"""

import numpy as np

from mpm_regression.row import Row

BARS = ("-materials soft -soft_model linear_elastic -soft_density 1000 -soft_young 1e6 -soft_poisson 0 -bodies a,b -a_material soft -a_shape box"
        " -a_lower 0.3,0 -a_upper 1.3,0.05 -a_velocity 0.2,0 -b_material soft -b_shape box -b_lower 1.3125,0 -contact_pairs a:b"
        " -gravity 0,0 -mesh_spacing 0.0125 -mesh_ymin roller -mesh_ymax roller -mesh_upper 4,0.05")
DISCS = ("-materials soft -soft_model linear_elastic -soft_density 1000 -soft_young 1000 -soft_poisson 0.3 -bodies a,b -a_material soft -a_shape disc"
         " -a_centre 0.2,0.2 -a_radius 0.2 -a_velocity 0.1,0.1 -b_material soft -b_shape disc -b_centre 0.8,0.8 -b_radius 0.2 -b_velocity -0.1,-0.1"
         " -contact_pairs a:b -gravity 0,0 -mesh_upper 1,1 -mesh_spacing 0.025 -mesh_ymin free -time_end 1.8")
BALLS = ("-geometry axisymmetric -mesh_lower 0,-0.048 -mesh_upper 0.248,0.852 -mesh_spacing 0.004 -mesh_xmin roller -mesh_ymin free -gravity 0,0"
         " -materials soft -soft_model linear_elastic -soft_density 1000 -soft_young 1e7 -soft_poisson 0.3 -f_bar_fraction 0 -bodies a,b"
         " -a_material soft -a_shape disc -a_centre 0,0.2 -a_radius 0.2 -a_fill cut -a_velocity 0,0.1"
         " -b_material soft -b_shape disc -b_centre 0,0.601 -b_radius 0.2 -b_fill cut -contact_pairs a:b -time_end 0.06 -history_interval 0.0005")
CLAY = ("-gravity 0,-9.81 -time_end 0.2 -mesh_upper 2,1 -materials clay -clay_model von_mises -clay_density 1800 -clay_young 1e6 -clay_poisson 0.3"
        " -clay_su 2e3 -f_bar_fraction 0")
WHOLE = CLAY + " -bodies all -all_material clay -all_shape box -all_lower 0.5,0 -all_upper 1.5,0.8 -contact_pairs"
PART = " -{0}_material clay -{0}_shape box -{0}_lower {1} -{0}_upper {2}"
CUT = CLAY + PART.format("low", "0.5,0", "1.5,0.35") + PART.format("high", "0.5,0.35", "1.5,0.8") + " -low_high_contact weld"
THIRD = PART.format("stone", "1.75,0", "1.95,0.2")
SIDES = " -mesh_xmin roller -mesh_xmax roller -mesh_upper 2,1.5"
PLATE = (SIDES + " -gravity 0,0 -mesh_ymin roller -rigid_bodies plate -plate_shape box -plate_lower 0,1 -plate_upper 2,1.3 -plate_motion prescribed"
         " -plate_velocity 0,-0.05 -damping 0.05 -time_end 0.1")
BESIDE = PART.format("left", "0,0", "1,{0}") + PART.format("right", "1,0", "2,{0}")
ON_TWO = (SIDES + " -gravity 0,-9.81 -damping 0.1 -time_end 1" + BESIDE.format(0.5) + PART.format("top", "0,0.5", "2,1")
          + " -bodies left,right,top -contact_pairs left:top,right:top")
RUNS = {"friction": "-block_base_friction 0.35", "limit": "-block_base_shear_limit 1500",
        "off_grid": "-block_base_shear_limit 1500 -base_upper 5,0.53 -block_lower 1,0.53 -block_upper 2,1.03",
        "bars": BARS + " -b_upper 2.3125,0.05 -time_end 0.25 -history_interval 0.001",
        "long_bar": BARS + " -b_upper 3.3125,0.05 -time_end 0.28 -history_interval 0.001",
        "discs": DISCS, "balls": BALLS, "whole": WHOLE,
        "halves": CUT + " -bodies low,high -contact_pairs low:high",
        "pressed": (PLATE + BESIDE.format(1) + " -bodies left,right -contact_pairs left:right").replace("clay", "rock"),
        "pressed_whole": (PLATE + PART.format("all", "0,0", "2,1") + " -bodies all -contact_pairs").replace("clay", "rock"),
        "on_two": ON_TWO.replace("clay", "rock"),
        "own_fields": CUT + THIRD + " -bodies low,high,stone -contact_pairs low:high,stone:high"}


def momentum(run, bodies="ab", axis="x"):
    return sum(run.history[f"{body}_momentum_{axis}"] for body in bodies)


def touch(run, axis="x", least=0.01):
    """Times of the first and the last row with a force, from the largest."""
    force = np.abs(run.history[f"a_b_force_{axis}"])
    rows = np.flatnonzero(force > least * force.max())
    return run.history["time"][rows[0]], run.history["time"][rows[-1]]


def check(runs):
    for name, exact in (("friction", 1.0341), ("limit", 2.6459), ("off_grid", 2.6459)):
        speed = runs[name].history["block_momentum_x"] / 1000
        yield Row(f"speed of a block after 1 s down a slope, {name} (m/s)", speed[-1], exact, 0.01 * exact, "Coulomb; Newton")
    along, across = (runs["friction"].history[f"block_base_force_{axis}"].sum() for axis in "xy")
    yield Row("force along over force across, mean over the run, friction", -along / across, 0.35, 0.0035, "Coulomb")
    bars = runs["bars"]
    middle = (bars.history["time"] > 0.07) & (bars.history["time"] < 0.115)
    yield Row("stress between two equal bars (Pa)", -bars.history["a_b_force_x"][middle].mean() / 0.05, 3162.3, 0.05 * 3162.3, "rho c v / 2")
    first, last = touch(bars)
    yield Row("duration of their contact (s)", last - first, 0.06325, 0.05 * 0.06325, "2 L / c")
    for name in ("bars", "long_bar", "discs"):
        total = momentum(runs[name])
        size = np.abs(runs[name].history["a_momentum_x"]).max()
        yield Row(f"momentum, largest change over that of a body, {name}", np.abs(total - total[0]).max() / size, 0, 1e-12, "Newton's third law", single=1e-4)
    yield Row("velocity of the second of two equal bars afterwards (m/s)", bars.history["b_momentum_x"][-1] / 50, 0.2, 0.02 * 0.2, "velocities change places")
    yield Row("velocity of a bar of 2 m that one of 1 m hits (m/s)", runs["long_bar"].history["b_momentum_x"][-1] / 100, 0.1, 0.03 * 0.1, "one-dimensional waves")
    yield Row("first touch of two discs (s)", touch(runs["discs"], least=0.001)[0], 1.5858, 0.125, "geometry; a cell over their speed")
    balls = runs["balls"]
    yield Row("largest force between two balls (N)", -balls.history["a_b_force_y"].min(), 137.6, 0.05 * 137.6, "Hertz")
    first, last = touch(balls, "y")
    # The whole contact lasts 0.0448 s; the force is below a hundredth of the largest while the balls come closer by the first 4.64 % of 1.522 mm,
    # at 0.1 m/s, and as long at the end.
    yield Row("duration of a force above a hundredth of it (s)", last - first, 0.0434, 0.05 * 0.0434, "Hertz")
    whole = runs["whole"].history
    for name in ("halves", "own_fields"):
        ours, exact = momentum(runs[name], ("low", "high"), "y"), whole["all_momentum_y"]
        yield Row(f"momentum of welded halves off that of the whole, over the largest, {name}", np.abs(ours - exact).max() / np.abs(exact).max(), 0,
                  1e-10, "the whole block", single=1e-4)
    pressed, one = (runs[name].history["plate_force_y"] for name in ("pressed", "pressed_whole"))
    yield Row("force of a plate on two bodies beside each other off that on one, over the largest", np.abs(pressed - one).max() / np.abs(one).max(), 0, 1e-10,
              "no shear between them", single=1e-4)
    rests = runs["on_two"].history
    left, right = (rests[f"{side}_top_force_y"][rests["time"] > 0.8].mean() for side in ("left", "right"))
    yield Row("force of a body on the left of two that stick, over that on the right", left / right, 1, 0.01, "symmetry")
