"""Rolling cylinder and ball

A cylinder rolls down a slope of $\\theta$ = 20° without slip if $\\mu \\ge \\tan\\theta/3$, by $x = g \\sin\\theta\\, t^2/3$;
with less friction it slips, $x = g t^2 (\\sin\\theta - \\mu \\cos\\theta)/2$. A ball that does not slip takes
$x = 5 g \\sin\\theta\\, t^2/14$. The body is elastic and stiff (its weight flattens it by $10^{-3}$ of its radius), and
contact begins at a gap of a twentieth of a cell. The check compares the acceleration of its centre of mass from 0.2 s on: with 20
cells over the radius of the cylinder, with 10, and with 5 over the radius of the ball.
"""

import numpy as np

from mpm_regression.curves import slope
from mpm_regression.row import Row

G, SLOPE = 9.81, np.radians(20)
LONG = True
BALL = ("-dim 3 -mesh_lower 0,0,-0.2 -mesh_upper 3.2,1.2,1.3 -mesh_spacing 0.1 -wheel_centre 0.75,0.6,0.5"
        " -base_lower 0,0,-0.2 -base_upper 3.2,1.2,0 -base_particles_per_cell 2 -gravity 3.355218,0,-9.218385 -mesh_zmin free -mesh_zmax free"
        " -wheel_particles_per_cell 2")
COARSE = {"rolls_coarse": "The cylinder has ten cells over its radius; with twenty it is within the tolerance.",
          "ball_rolls": "The ball has five cells over its radius; with ten it takes 2.334 m/s2 (2.6 %)."}
APART = ("The force of the ball's first touch is 240 to 900 times round-off apart (28 times in double precision between the same two), "
         "and only with this reach: probably of nodes whose gap is just below it, where little force is left.", 1e-4)
RUNS = {"rolls": "-mesh_spacing 0.025", "rolls_coarse": "", "slips": "-base_friction 0.08", "ball_rolls": BALL}
EXACT = {"rolls": 2 / 3 * G * np.sin(SLOPE), "rolls_coarse": 2 / 3 * G * np.sin(SLOPE), "slips": G * (np.sin(SLOPE) - 0.08 * np.cos(SLOPE)),
         "ball_rolls": 5 / 7 * G * np.sin(SLOPE)}


def speed(run):
    """Speed of the centre of mass along the slope, m/s."""
    place, t = run.history["wheel_centre_x"], run.history["time"]
    return np.gradient(place, t)


def check(runs):
    for name, run in runs.items():
        yield Row(f"acceleration, {name.replace('_', ' ')} (m/s2)", slope(run.history["time"], speed(run), 0.2), EXACT[name],
                  0.02, "rigid body mechanics", relative=True, shortfall=COARSE.get(name, ""), bound=0.06)


def draw(axes, runs):
    for name, run in runs.items():
        t = run.history["time"]
        line, = axes.plot(t, speed(run), lw=1, label=name.replace("_", " "))
        axes.plot(t, EXACT[name] * t, "--", color=line.get_color(), lw=0.8)
    axes.set(xlabel="time (s)", ylabel="speed of the centre (m/s; dashed: exact)")
    axes.legend()
