"""Solid cylinders

Cylinders of elastic soil from their axis on (`-geometry axisymmetric`). *Weight*: gravity is applied within 0.5 s to a cylinder whose
side a smooth wall holds, so that it settles as a column: $\\sigma_{zz} = -\\rho g (H - z)$, and $\\sigma_{rr} = \\sigma_{\\theta\\theta} = \\nu/(1-\\nu) \\sigma_{zz}$ at each radius.
*K0*: the same cylinder begins with this stress, and must stay at rest. *Rise*: without gravity, with free sides, a cylinder moves along its axis at
1 m/s; no particle may move across, and no stress may come up. *Widening*: the radial velocity $c r$ with $c$ = 0.1 /s makes the same strain at every
radius (each particle has the velocity at the centre of its mass), so that in 2 ms, before the wave from the side is there, the stress at the axis is even, and that of the law: $d\\sigma_{rr} = d\\sigma_{\\theta\\theta} =
2 (K + G/3) c\\,dt$. The mass is that of the whole cylinder in each.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row

SETTLE = "-gravity_table 0:0,0.5:1,2:1 -gravity_table_interpolation smooth -damping 0.2 -time_end 1.5 -output_interval 1.5"
BOX = " -cylinder_shape box -cylinder_lower 0,0 -cylinder_upper "
FREE = "-gravity 0,0 -mesh_xmax free -mesh_ymin free -mesh_upper 1.5,2.5"
RUNS = {
    "weight": SETTLE + BOX + "1,2",
    "k0": "-cylinder_stress k0" + BOX + "1,2",
    "rise": FREE + BOX + "1,1 -cylinder_velocity 0,1 -time_end 0.5 -output_interval 0.5",
    "widening": FREE.replace("ymin free", "ymin roller").replace("1.5,2.5", "1.5,2")
    + " -mesh_ymax roller -cylinder_shape particles -cylinder_file {start} -velocity_update apic -time_end 0.002 -output_interval 0.002"
    " -history_interval 0.0005",
}
DENSITY, G, HEIGHT, RATE = 2000.0, 10.0, 2.0, 0.1
SPEED = np.sqrt(1e7 * 0.75 / (1.25 * 0.5) / DENSITY)  # of waves, m/s


def prepare(run, path, options):
    spacing = 0.0625
    position = particles.lattice((0, 0), (1, HEIGHT), spacing)
    velocity = np.zeros_like(position)
    radius = position[:, 0]
    velocity[:, 0] = RATE * (radius + (spacing / 2) ** 2 / (3 * radius))
    particles.write(path, "cylinder", position, spacing, velocity=velocity, volume=2 * np.pi * radius * spacing**2)


def check(runs):
    for name, run in runs.items():
        mass = DENSITY * np.pi * (1 if name == "rise" else HEIGHT)
        if name != "widening":
            yield Row(f"mass of the whole cylinder over the exact one, {name}", run.history["cylinder_mass"][-1] / mass, 1, 1e-9, "Pappus", single=1e-5)
    fields = last_frame(runs["weight"], "cylinder")
    stress, z = fields["stress"], fields["position"][:, 1]
    down = -DENSITY * G * (HEIGHT - fields["reference_height"])
    for component, share, what in ((1, 1, "vertical"), (0, 1 / 3, "radial"), (2, 1 / 3, "hoop")):
        error = np.abs(stress[:, component] - share * down).max() / (share * DENSITY * G * HEIGHT)
        yield Row(f"largest error of the {what} stress under the weight, of the largest", error, 0, 0.02, "column")
    speed = runs["k0"].history["cylinder_grid_velocity"].max() / SPEED
    yield Row("largest speed over that of the waves, k0", speed, 0, 1e-9, "equilibrium", single=1e-6)
    rise = runs["rise"]
    yield Row("rise of the centre (m)", rise.history["cylinder_centre_y"][-1] - rise.history["cylinder_centre_y"][0], 0.5, 1e-9, "constant velocity", single=1e-5)
    yield Row("change of the radius in the rise (m)", np.ptp(rise.history["cylinder_xmax"]), 0, 1e-10, "constant velocity", single=1e-5)
    yield Row("largest stress in the rise (Pa)", np.abs(last_frame(rise, "cylinder")["stress"]).max(), 0, 1e-4, "constant velocity", single=500)
    yield from check_widening(runs["widening"])


def check_widening(run):
    fields = last_frame(run, "cylinder")
    near = fields["position"][:, 0] < 0.4
    bulk, shear = 1e7 / (3 * (1 - 0.5)), 1e7 / 2.5
    exact = 2 * (bulk + shear / 3) * RATE * 0.002
    for component, what in ((0, "radial"), (2, "hoop")):
        values = fields["stress"][near, component]
        yield Row(f"mean {what} stress of the widening over the exact one", values.mean() / exact, 1, 1e-3, "even strain", single=1e-2)
        yield Row(f"largest deviation of the {what} stress within 0.4 m, of the exact one", np.abs(values - values.mean()).max() / exact, 0, 3e-3, "even strain", single=1e-2)
