"""Block on an incline

A block on a plane of 30°. *Limiting shear* $\\tau_{max}$: it slides with $a = g \\sin\\theta - \\tau_{max} A/m$, whatever
its weight, or stays if $\\tau_{max} A > m g \\sin\\theta$. *Coulomb friction*: $a = g (\\sin\\theta - \\mu \\cos\\theta)$,
or it stays if $\\mu \\ge \\tan\\theta$. The block starts from rest with the vertical stress of its weight. The shear stress
has to build up, which rocks the block a little. The acceleration is therefore that of the centre of mass after 0.2 s, and
the speed of a block that stays is the mean over the last 0.1 s of 1 s. The ends of the block do not lie on nodes.
"""

import numpy as np

from mpm_regression.checks.incline import DENSITY, HEIGHT, acceleration, centre, final_speed, write_block
from mpm_regression.row import Row

G, THETA = 9.81, np.radians(30)
DRIVE, PUSH = G * np.sin(THETA), G * np.cos(THETA)
IN_3D = (" -dim 3 -mesh_lower 0,0,-0.4 -mesh_upper 4.5,0.8,1 -base_lower 0,0,-0.4 -base_upper 4.5,0.8,0 -base_particles_per_cell 2 -gravity 4.905,0,-8.495709211"
         " -mesh_ymin free -mesh_ymax free -mesh_zmin free -mesh_zmax free")
LONG = True
INTERFACES = {"shear limit 2 kPa": "-base_shear_limit 2000", "shear limit 6 kPa": "-base_shear_limit 6000",
              "friction 0.3": "-base_friction 0.3", "friction 0.6": "-base_friction 0.6", "friction 0.7": "-base_friction 0.7"}
EXACT = {"shear limit 2 kPa": (DRIVE - 2000 / (DENSITY * HEIGHT), 0.002), "friction 0.3": (DRIVE - 0.3 * PUSH, 0.005)}
RUNS = {f"{name} {dim}".replace(" ", "_"): "-block_file {start} " + options + more for name, options in INTERFACES.items()
        for dim, more in (("2D", ""), ("3D", IN_3D))}


def prepare(run, path, options):
    dim = int(run[-2])
    write_block(path, (0.537, 0) if dim == 2 else (0.537, 0.163, 0), 0.05, PUSH, dim)


def check(runs):
    for name in INTERFACES:
        for dim in ("2D", "3D"):
            run = runs[f"{name} {dim}".replace(" ", "_")]
            if name in EXACT:
                a, tolerance = EXACT[name]
                yield Row(f"{name}: acceleration, {dim} (m/s2)", acceleration(run), a, tolerance, "Newton's second law", relative=True)
            else:
                yield Row(f"{name}: speed after 1 s, {dim} (m/s)", abs(final_speed(run)), 0, 1e-3, "it sticks")


def draw(axes, runs):
    for name in INTERFACES:
        run = runs[f"{name} 2D".replace(" ", "_")]
        t = run.history["time"]
        line, = axes.plot(t, centre(run), label=name)
        a = EXACT.get(name, (0, 0))[0]
        axes.plot(t, a * t**2 / 2, "k--", lw=0.8)
    axes.set(xlabel="time (s)", ylabel="distance (m; dashed: exact)")
    axes.legend()
