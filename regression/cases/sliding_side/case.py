"""Block on a side of the mesh with friction

A block on the lower side of the mesh, `-mesh_ymin friction`, under gravity that is turned by 25°. It slides with
$a = g (\\sin\\theta - \\mu \\cos\\theta)$, or stays if $\\mu \\ge \\tan\\theta = 0.466$. With a limit $\\tau_{max}$ of the
shear stress instead, $a = g \\sin\\theta - \\tau_{max} / \\rho h$. If the side moves like a belt with the acceleration of gravity
along it, the block moves with it whatever the friction. The block starts with the stress of its weight. The acceleration is that of the centre
of mass after 0.2 s, the force of the block on the side the mean after 0.2 s.
"""

import numpy as np

from mpm_regression.checks.incline import DENSITY, HEIGHT, LENGTH, acceleration, centre, final_speed, write_block
from mpm_regression.row import Row

G, THETA = 9.81, np.radians(25)
DRIVE, PUSH = G * np.sin(THETA), G * np.cos(THETA)
IN_3D = (" -dim 3 -mesh_lower 0,0,0 -mesh_upper 4.5,0.8,1 -gravity 4.145885118,0,-8.890879309 -mesh_ymin free -mesh_ymax free -mesh_zmin friction"
         " -mesh_zmax free")
SIDES = {"friction 0.35": "friction 0.35", "friction 0.6": "friction 0.6",
         "shear limit 2 kPa": "friction 1 -mesh_ymin_shear_limit 2000"}
BELT = f"friction 0.2 -mesh_ymin_velocity_table 0:0:0,1:{float(DRIVE)!r}:0"
RUNS = {f"{name} {dim}".replace(" ", "_"): "-block_file {start}" + more + f" -mesh_{side}_" + option.replace("mesh_ymin", f"mesh_{side}")
        for name, option in SIDES.items() for dim, side, more in (("2D", "ymin", ""), ("3D", "zmin", IN_3D))}
RUNS["belt_2D"] = "-block_file {start} -mesh_ymin_" + BELT


def prepare(run, path, options):
    dim = int(run[-2])
    write_block(path, (0.537, 0) if dim == 2 else (0.537, 0.163, 0), 0.05, PUSH, dim)


def check(runs):
    for dim in ("2D", "3D"):
        for name, exact in (("friction 0.35", DRIVE - 0.35 * PUSH), ("shear limit 2 kPa", DRIVE - 2000 / (DENSITY * HEIGHT))):
            run = runs[f"{name} {dim}".replace(" ", "_")]
            yield Row(f"{name}: acceleration, {dim} (m/s2)", acceleration(run), exact, 0.005, "Newton's second law", relative=True)
        sticks = runs[f"friction 0.6 {dim}".replace(" ", "_")]
        yield Row(f"friction 0.6: speed after 1 s, {dim} (m/s)", abs(final_speed(sticks)), 0, 1e-3, "it sticks")
    run = runs["friction_0.35_2D"]
    late = run.history["time"] > 0.2
    push = DENSITY * HEIGHT * LENGTH * PUSH
    for axis, exact in (("x", 0.35 * push), ("y", -push)):
        force = run.history[f"wall_ymin_force_{axis}"][late].mean()
        yield Row(f"friction 0.35: force on the side along {axis}, 2D (N/m)", force, exact, 0.005, "weight", relative=True)
    yield Row("belt: acceleration, 2D (m/s2)", acceleration(runs["belt_2D"]), DRIVE, 0.005, "it moves with the belt", relative=True)


def draw(axes, runs):
    for name in SIDES:
        run = runs[f"{name} 2D".replace(" ", "_")]
        t = run.history["time"]
        axes.plot(t, centre(run), label=name)
    axes.set(xlabel="time (s)", ylabel="movement of the block (m)")
    axes.legend()
