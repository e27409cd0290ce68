"""Level ground at rest

Three layers under gravity begin with the stress of level ground (`-NAME_stress k0`): 0.5 m of gravel of 20 kN/m³, which is a
surcharge of 10 kPa; 2 m of sand of 18 kN/m³, whose $K_0$ is $1 - \\sin 30° = 0.5$; and 3 m of clay of 20 kN/m³ under water with
$K_0$ = 0.6. The effective stresses 1 m below the top of the sand are 28 and 14 kPa, and 4 m below it 66 and 39.6 kPa. This stress is in
equilibrium with gravity to round-off, so that in 1000 steps no node may reach $10^{-9}$ of the speed of the waves. The second
run has a boundary of layers within a row of cells and the level of water within a row of particles; the third is in 3D.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

WITHIN = "-fill_lower 0,4.75 -fill_upper 2,5.25 -middle_upper 2,4.75 -water_level 2.9"
SOLID = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 2,1,6 -gravity 0,0,-10 -mesh_ymin roller -mesh_ymax roller -mesh_zmin fixed"
         " -mesh_zmax free -fill_lower 0,0,5 -fill_upper 2,1,5.5 -middle_lower 0,0,3 -middle_upper 2,1,5")
RUNS = {"layers": "", "within": WITHIN, "3D": SOLID}


def effective(run, body, up):
    """Heights, m, and effective stresses (tension positive), Pa, of a body's particles at the end."""
    fields = last_frame(run, body)
    stress = fields["stress"] + fields["pore_pressure"][:, None] * np.array([1, 1, 1, 0, 0, 0])
    return fields["position"][:, up], stress


def at_height(heights, values, height):
    """Mean of the rows of particles next to a height that lies between two of them."""
    near = np.abs(heights - height) < 0.13
    return values[near].mean()


def wave_speed(run, material):
    young, poisson = run.number(f"{material}_young"), run.number(f"{material}_poisson")
    return np.sqrt(young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)) / run.number(f"{material}_density"))


def check(runs):
    for name, run in runs.items():
        up = int(run.number("dim", 2)) - 1
        for body, material in (("fill", "gravel"), ("middle", "sand"), ("bottom", "clay")):
            speed = run.history[f"{body}_grid_velocity"].max() / wave_speed(run, material)
            yield Row(f"largest speed over that of the waves, {body}, {name}", speed, 0, 1e-9, "equilibrium", single=1e-6)
        if name == "within":
            continue
        for body, height, vertical, across in (("middle", 4, 28e3, 14e3), ("bottom", 1, 66e3, 39.6e3)):
            heights, stress = effective(run, body, up)
            yield Row(f"vertical stress at {height} m over the exact one, {name}", -at_height(heights, stress[:, up], height) / vertical,
                      1, 1e-6, "weight of the layers", single=1e-5)
            yield Row(f"horizontal stress at {height} m over the exact one, {name}", -at_height(heights, stress[:, 0], height) / across,
                      1, 1e-6, "K0", single=1e-5)


def draw(axes, runs):
    for body in ("fill", "middle", "bottom"):
        heights, stress = effective(runs["layers"], body, 1)
        axes.plot(-stress[:, 1] / 1e3, heights, "k.", ms=3, label="vertical" if body == "fill" else None)
        axes.plot(-stress[:, 0] / 1e3, heights, "r.", ms=3, label="horizontal" if body == "fill" else None)
    axes.set(xlabel="effective stress, compression positive (kPa)", ylabel="height (m)")
    axes.legend()
