"""Moving sides

*Base motion*: a column of elastic soil between rollers on its lower side. That side moves along the vertical by a table, `-mesh_ymin_velocity_table`,
which gives a wave that runs up the column; before the wave reaches the top, the force of the soil on the side is
$\\rho c V$ more in compression. *Shaking*: the column on a fixed side that moves to and fro horizontally between free sides, $V(t)$ through
$(0, 0), (1, 1), (2, -1), (3, 0)$ times 0.05 s and 0.01 m/s; a stiff block follows it, and travels with its base. *Absorbing base*: the dashpots of the lower side hold on to
a base with the velocity $V$; a wave of velocity $V / 2$ runs up, as in an outcrop that moves by $V$ (Joyner & Chen 1975).
"""

import numpy as np

from mpm_regression.row import Row

SPEED, DENSITY, V = np.sqrt(2e6 / 2000), 2000.0, 0.01
COLUMN = " -mesh_xmin roller -mesh_xmax roller -mesh_upper 0.5,5 -layer_upper 0.5,5 -mesh_ymax free"
RUNS = {
    "base": f"-mesh_ymin_velocity_table 0:0:0,0.04:0:{V},1:0:{V} -time_end 0.15" + COLUMN,
    "absorbing": f"-mesh_ymin absorbing -mesh_ymin_velocity_table 0:0:0,0.04:0:{V},1:0:{V} -time_end 0.15" + COLUMN,
    "block": ("-mesh_xmin free -mesh_xmax free -mesh_lower -1,0 -mesh_upper 1.5,1 -mesh_ymax free -elastic_young 2e9 -layer_upper 0.5,0.5 -time_end 0.15"
              f" -mesh_ymin_velocity_table 0:0:0,0.05:{V}:0,0.1:{-V}:0,0.15:0:0 -history_interval 0.001"),
}


def check(runs):
    for name, speed in (("base", V), ("absorbing", V / 2)):
        run = runs[name].history
        t = run["time"]
        late = t > 0.07
        width = 0.5
        gain = np.polyfit(t[late], run["layer_momentum_y"][late], 1)[0]
        yield Row(f"{name}: growth of the momentum over rho c V", gain / (DENSITY * width * SPEED * speed), 1, 0.005, "linear wave equation")
        force = -run["wall_ymin_force_y"][late].mean()
        yield Row(f"{name}: force on the side over rho c V", force / (DENSITY * SPEED * speed * width), 1, 0.005, "linear wave equation")
    run = runs["block"].history
    t = run["time"]
    table = np.interp(t, [0, 0.05, 0.1, 0.15], [0, V, -V, 0])
    travel = np.concatenate([[0], np.cumsum(np.diff(t) * (table[1:] + table[:-1]) / 2)])
    moved = run["layer_centre_x"] - run["layer_centre_x"][0]
    yield Row("block: travel off that of its base, over the largest", np.abs(moved - travel).max() / travel.max(), 0, 0.02, "it is stiff")


def draw(axes, runs):
    for name in ("base", "absorbing"):
        run = runs[name].history
        axes.plot(run["time"], run["layer_momentum_y"], label=name)
    axes.set(xlabel="time (s)", ylabel="momentum (kg/s)")
    axes.legend()
