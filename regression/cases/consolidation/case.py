"""Consolidation of a column

`terzaghi`: a column of 1 m, load 10 kPa, drained at its top; the water begins with the pressure that it takes undrained,
$p_0 = q\\,Q/(M + Q)$ with $Q = K_w/n$. Settlement and pressures follow Terzaghi's series with $c_v = (k/\\gamma_w)/(1/M + 1/Q)$.
`layers`: 0.4 m of soft permeable soil on 0.6 m of stiff soil, both under the same pressure at first; Laplace transform. In
`terzaghi` and `plate` the permeability is ten times that of the soil, and so is the rate: inertia then changes $U$ by less than $10^{-3}$. The
settlement is that of the uppermost particles and the strain of the quarter of a cell above their centres. The volume of
water that leaves is what the pores have lost. `plate`: the first column upside down, with the load by a rigid plate that no water
passes, and drained at the base through an open side of the mesh. `porous`: drained through such a plate that water passes. `side`: a smooth
side of the mesh that the water passes feels the whole load.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame

P0, MODULUS, CELL, SCALE = 9765.625, 12e6, 0.025, 10.0  # Pa, Pa, m
UPPER, LOWER = 5e6, 20e6  # Pa, wave moduli of the layers
LAYERS = (" -materials sand,clay -sand_young 4.1666667e6 -sand_permeability 1e-3 -clay_model linear_elastic -clay_young 16.666667e6"
          " -clay_poisson 0.25 -clay_water saturated -clay_porosity 0.4 -clay_grain_density 2650 -clay_permeability 1e-4"
          " -bodies column,base -column_lower 0,0.6 -column_stress 0,0,0,0 -base_material clay -base_shape box -base_lower 0,0"
          " -base_upper 0.025,0.6 -column_pore_pressure 10e3 -base_pore_pressure 10e3 -permeability_scale 1 -time_end 1.01")
PLATE = (" -mesh_ymin_water open -rigid_bodies plate -plate_shape box -plate_lower 0,1 -plate_upper 0.025,1.1 -plate_motion dynamic"
         " -plate_density 200 -plate_force 0,-250 -mesh_upper 0.025,1.2 -time_end 0.42")
LOAD = " -loads surcharge -surcharge_body column -surcharge_lower 0,0.99 -surcharge_upper 0.025,1.01 -surcharge_pressure 10e3"
SIDE = LOAD + " -mesh_ymin smooth -mesh_ymin_water open -damping 0.1 -time_end 0.05 -output_interval 1"
POROUS = PLATE.replace("-time_end 0.42", "-time_end 0.17 -plate_permeable on").replace("-mesh_ymin_water open ", "")
RUNS = {"terzaghi": LOAD, "porous": POROUS, "layers": LAYERS + LOAD, "plate": PLATE, "side": SIDE}
# Time [s], degree of consolidation, pressure over p0 at the base and in the middle: series.
TERZAGHI = {0.16742: (0.15958, 1.00000, 0.98758), 0.41856: (0.25231, 0.99687, 0.88615), 0.83712: (0.35682, 0.94931, 0.73565),
            1.67424: (0.50409, 0.77231, 0.55318), 4.18560: (0.76395, 0.37078, 0.26219), 8.37120: (0.93126, 0.10798, 0.07635)}
# Time [s], settlement over p0 [m/MPa], pressure over p0 at the base and at the interface: Laplace transform.
TWO_LAYERS = {0.1: (0.05030, 0.99994, 0.6417), 0.3: (0.07734, 0.95447, 0.2308), 1.0: (0.09814, 0.47216, 0.0531)}
PRECISIONS = ("double",)
LONG = True


def around(run, time, seconds=0.004):
    """The frames of all bodies together, at a time and as far apart as the water takes to swing."""
    for path in run.frames:
        at, groups = read_frame(path)
        if abs(at - time) < 1.01 * seconds:
            bodies = [group for group in groups.values() if "pore_pressure" in group]
            yield {key: np.concatenate([body[key] for body in bodies]) for key in ("position", "pore_pressure")}


def settlement(run, time, strain):
    """Settlement of the top [m], the strain of the soil there being `strain`."""
    start = max(body["position"][:, 1].max() for body in read_frame(run.frames[0])[1].values())
    return np.mean([start - frame["position"][:, 1].max() for frame in around(run, time)]) + strain * CELL / 4


def pressure(run, time, height):
    """Pore pressure at a height [Pa], straight between the rows of cells."""
    found = []
    for frame in around(run, time):
        cell = np.floor(frame["position"][:, 1] / CELL)
        rows = [(frame["position"][cell == c, 1].mean(), frame["pore_pressure"][cell == c].mean()) for c in np.unique(cell)]
        found.append(np.interp(height, *zip(*rows)))
    return np.mean(found)


def check(runs):
    run = runs["terzaghi"]
    whole = P0 / MODULUS
    for time, (degree, base, middle) in TERZAGHI.items():
        found = settlement(run, time / SCALE, whole) / whole
        yield Row(f"degree of consolidation, {time:.3g} s", found, degree, 0.01, "Terzaghi's series")
        for name, height, exact in (("base", 0, base), ("middle", 0.5, middle)):
            yield Row(f"pressure over p0, {name}, {time:.3g} s", pressure(run, time / SCALE, height) / P0, exact, 0.01, "Terzaghi's series")
    for time in (0.41856, 0.83712, 1.67424):
        degree, base, middle = TERZAGHI[time]
        plate = runs["plate"]
        settled = -np.interp(time / SCALE, plate.history["time"], plate.history["plate_y"])
        yield Row(f"plate: degree of consolidation, {time:.3g} s", settled / whole, degree, 0.01, "Terzaghi's series")
        for name, height, exact in (("under it", 1, base), ("middle", 0.5, middle)):
            yield Row(f"plate: pressure over p0, {name}, {time:.3g} s", pressure(plate, time / SCALE, height) / P0, exact, 0.02,
                      "Terzaghi's series")
    for time in (0.41856, 0.83712, 1.67424):
        settled = -np.interp(time / SCALE, runs["porous"].history["time"], runs["porous"].history["plate_y"])
        yield Row(f"porous plate: degree of consolidation, {time:.3g} s", settled / whole, TERZAGHI[time][0], 0.01, "Terzaghi's series")
    history = run.history
    lost = history["column_water"][0] - history["column_water"][-1]
    yield Row("water that left over what the pores lost", history["column_outflow"][-1] / lost, 1, 1e-3, "mass of water")
    force = -runs["side"].history["wall_ymin_force_y"][-10:].mean()
    yield Row("force on an open smooth side over the load", force / (10e3 * CELL), 1, 0.02, "equilibrium")
    run = runs["layers"]
    for time, (settled, base, interface) in TWO_LAYERS.items():
        found = settlement(run, time, 1e4 / UPPER) / 0.01
        yield Row(f"layers: settlement over p0 (m/MPa), {time:g} s", found, settled, 0.0015, "Laplace transform")
        # One flux passes both halves of cells at the interface, with permeabilities of 10 to 1.
        between = (10 * pressure(run, time, 0.6 + CELL / 2) + pressure(run, time, 0.6 - CELL / 2)) / 11
        for name, found, exact in (("base", pressure(run, time, 0), base), ("interface", between, interface)):
            yield Row(f"layers: pressure over p0, {name}, {time:g} s", found / 1e4, exact, 0.015, "Laplace transform")
