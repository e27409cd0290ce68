"""Loads on surfaces

*Strip*: 50 kPa on 1 m of elastic ground. At rest the base carries the weight and the load. *Column*: soil between rollers under a
surcharge, as a pressure and as a traction. At rest every particle has the stress $-p$; particles of a fixed size overlap when the
soil is compressed, which adds an error of the size of the strain, here $10^{-9}$. *Around*: a disc, and a cylinder by its section,
under a pressure all round, with the stress $-p$ at the start. The forces on the faces and those of the stress cancel at every node,
so nothing moves, and the pressure has no sum. *Turned*: a pressure on one side of a box that is turned by 30°; its force is $p$
times the side, along its normal. *Impulse* and *pressed*: a traction and a pressure that follow tables, on a body that touches nothing. Its momentum
is the integral of the table up to half a step before, as velocities are means over a step, times the area. *Cylinder*: a thick cylinder, inner radius 1 m and outer radius 2 m, under an inner
pressure of 10 kPa, in plane strain (Lamé).
"""

import numpy as np

from mpm_regression.curves import first_frame, last_frame
from mpm_regression.row import Row

OPEN = " -mesh_xmin free -mesh_xmax free -mesh_ymin free -gravity 0,0 -damping 0"
COLUMN = (" -mesh_upper 0.25,2.5 -soil_upper 0.25,2 -gravity 0,0 -elastic_young 5e13 -time_end 0.02 -strip_lower 0,1.9 -strip_upper 0.25,2.1"
          " -history_interval 0.02 -output_interval 0.02")
AROUND = " -strip_lower 0,0 -strip_upper 4,2.5 -{}_stress -50e3,-50e3,-50e3,0 -time_end 0.02 -history_interval 0.001 -output_interval 0.02"
PRESSURE, TURN = 50e3, np.radians(30)
TRACTION, PRESSED = "0:0:0,0.0033:400:-700,0.02:-300:100,1:0:0", "0:1,0.004:-2,0.0101:3,1:0"
FREE = (OPEN + " -time_end 0.02 -elastic_young 1e10 -soil_lower 1.03,0.47 -soil_upper 3.03,1.47 -strip_facing 0,1 -strip_lower 0.9,1.4"
        " -strip_upper 3.1,1.6 -history_interval 0.001 -output_interval 0.02")
LONG = True
RUNS = {
    "strip": "",
    "strip_traction": " -strip_pressure 0 -strip_traction 0,-50e3",
    "column_pressure": COLUMN,
    "column_traction": COLUMN + " -strip_pressure 0 -strip_traction 0,-50e3",
    "disc": OPEN + AROUND.format("disc") + " -mesh_spacing 0.125 -bodies disc -strip_body disc -disc_material elastic -disc_shape disc"
                    " -disc_centre 2.03,1.24 -disc_radius 1",
    "solid_cylinder": OPEN.replace("-mesh_xmin free", "-mesh_xmin roller") + AROUND.format("soil") + " -geometry axisymmetric -soil_lower 0,0.5 -soil_upper 1.5,2",
    "turned": OPEN + " -time_end 0.001 -soil_lower 1.5,0.5 -soil_upper 3,1.25 -soil_angle_deg 30 -strip_lower 0,0 -strip_upper 4,2.5"
                     " -strip_facing -0.5,0.8660254 -history_interval 0.001 -output_interval 0.001",
    "impulse": FREE + f" -strip_pressure 0 -strip_traction_table {TRACTION}",
    "pressed": FREE + f" -strip_pressure 1e3 -strip_pressure_table {PRESSED}",  # a table of factors
    "cylinder": " -geometry axisymmetric -mesh_spacing 0.05 -mesh_upper 2.5,0.05 -mesh_xmax free -mesh_ymax roller -gravity 0,0 -damping 0.7 -time_end 0.6"
                " -elastic_young 2e7 -soil_lower 1,0 -soil_upper 2,0.05 -strip_facing -1,0 -strip_lower 0.9,0 -strip_upper 1.1,0.05"
                " -strip_pressure 10e3 -history_interval 0.05 -output_interval 0.6",
}


def integral(text, t):
    """Integral of a piecewise linear table from 0 to the times t, by component."""
    points = np.array([[float(x) for x in point.split(":")] for point in text.split(",")])
    sums = []
    for column in points[:, 1:].T:
        whole = np.concatenate([[0], np.cumsum(np.diff(points[:, 0]) * (column[1:] + column[:-1]) / 2)])
        k = np.clip(np.searchsorted(points[:, 0], t, side="right") - 1, 0, len(points) - 2)
        way = t - points[k, 0]
        sums.append(whole[k] + way * (column[k] + np.diff(column)[k] / np.diff(points[:, 0])[k] * way / 2))
    return np.column_stack(sums)


def deviation(run, body):
    """Largest difference of a normal stress in the plane from -50 kPa, over it."""
    return np.abs(last_frame(run, body)["stress"][:, :2] + PRESSURE).max() / PRESSURE


def check(runs):
    for name in ("strip", "strip_traction"):
        strip, what = runs[name].history, name.replace("_", ", ")
        weight, load = strip["soil_mass"][-1] * 9.81, -strip["strip_force_y"][-1]
        yield Row(f"{what}: reaction of the base over weight and load", -strip["wall_ymin_force_y"][-1] / (weight + load), 1, 1e-10, "equilibrium",
                  single=1e-4)
        yield Row(f"{what}: load over 50 kPa times 1 m", load / PRESSURE, 1, 1e-12 if "traction" in name else 1e-4,
                  "its width; under a pressure the surface stretches")
    yield Row("strip: area at the start, m", runs["strip"].history["strip_area"][0], 1, 1e-12, "its width")
    for name in ("column_pressure", "column_traction"):
        stress = last_frame(runs[name], "soil")["stress"][:, 1]
        yield Row(f"{name.replace('_', ', ')}: largest error of the vertical stress over p", np.abs(stress + PRESSURE).max() / PRESSURE, 0, 1e-8,
                  "uniform stress", single=1e-3)
    for name in ("disc", "solid_cylinder"):
        run, body = runs[name], "disc" if name == "disc" else "soil"
        what = name.replace("_", " ")
        size = PRESSURE * run.history["strip_area"][0]
        speed = PRESSURE / np.sqrt(2000 * 1e9)  # of a wave with this pressure
        yield Row(f"{what} under pressure all round: largest speed over that of a wave of the pressure", run.history[f"{body}_grid_velocity"].max() / speed, 0,
                  1e-10, "rest", single=1e-3)
        force = run.columns("strip_force_") if name == "disc" else run.columns("strip_force_")[:, 1:]
        yield Row(f"{what}: sum of the pressure over its size", np.abs(force).max() / size, 0, 1e-12, "a closed surface", single=1e-6)
        yield Row(f"{what}: largest change of the stress over p", deviation(run, body), 0, 1e-10, "rest", single=1e-3)
    turned = runs["turned"].columns("strip_force_")[0]
    exact = -PRESSURE * 1.5 * np.array([-np.sin(TURN), np.cos(TURN)])
    yield Row("turned: error of the force over p times the side", np.abs(turned - exact).max() / (PRESSURE * 1.5), 0, 1e-10, "projected area")
    area = 2.0
    for name, exact, tolerance, source in (
            ("impulse", lambda t: area * integral(TRACTION, t), 1e-12, "integral of the table"),
            ("pressed", lambda t: -1e3 * area * np.column_stack([0 * t, integral(PRESSED, t)[:, 0]]), 1e-6, "integral of the table; the side deforms")):
        history = runs[name].history
        momentum, exact = runs[name].columns("soil_momentum_"), exact(np.maximum(history["time"] - history["dt"] / 2, 0))
        yield Row(f"{name}: largest error of the momentum over the largest", np.abs(momentum - exact).max() / np.abs(exact).max(), 0, tolerance, source,
                  single=1e-4)
    start, end = first_frame(runs["cylinder"], "soil"), last_frame(runs["cylinder"], "soil")
    radius, stress = start["position"][:, 0], end["stress"]
    inside = np.abs(radius - 1.5) < 0.45  # more than a cell from the faces
    lame = 10e3 / 3
    way = 1.3 / 2e7 * lame * (0.4 * radius + 4 / radius)
    moved = end["position"][:, 0] - radius
    yield Row("cylinder: largest error of the displacement over the largest", np.abs(moved - way).max() / way.max(), 0, 0.01, "Lamé")
    exact = {"radial": lame * (1 - 4 / radius**2), "hoop": lame * (1 + 4 / radius**2), "axial": np.full(len(radius), 2e3)}
    for component, name in ((0, "radial"), (2, "hoop"), (1, "axial")):
        error = np.sqrt(np.mean((stress[:, component] - exact[name])[inside] ** 2))
        yield Row(f"cylinder: rms error of the {name} stress over the inner pressure", error / 10e3, 0, 0.01, "Lamé")
