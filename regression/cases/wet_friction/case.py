"""Friction under water in the pores

A saturated layer with a load of 10 kPa on it lies on a base that moves along it, with the friction 0.3. Of the load the water in the pores carries
the pressure $p$ with which it begins, and keeps it, for the soil is nearly impermeable; friction acts on the rest, the effective
stress. The base is a side of the mesh, and the layer lies between smooth sides (`side`); or the base is a rigid body, and drags a
block (`rigid`). On a permeable body (`permeable`) the water loses its pressure, and friction acts on the whole load.
"""

from mpm_regression.row import Row

LOAD, FRICTION = 10e3, 0.3  # Pa, -
SIDE = " -mesh_ymin friction -mesh_ymin_friction 0.3 -mesh_ymin_velocity 0.01,0"
RIGID = (" -mesh_lower -0.5,0 -mesh_upper 1.5,0.5 -rigid_bodies floor -floor_shape box -floor_lower -0.4,0 -floor_upper 1.4,0.1"
         " -floor_motion prescribed -floor_velocity 1,0 -floor_friction 0.3 -layer_lower 0,0.1 -layer_upper 1,0.35"
         " -surcharge_lower 0,0.34 -surcharge_upper 1,0.36 -time_end 0.04")


def start(pressure, lateral):
    """Options of a layer whose water carries this pressure, with a lateral stress [Pa]."""
    return f"-layer_pore_pressure {pressure} -layer_stress {lateral},{pressure - LOAD},{lateral},0"


PRESSURES = {"drained": 0.0, "half": 5e3, "undrained": 9765.625}  # Pa
RUNS = {f"side_{name}": start(p, -20e3) + SIDE for name, p in PRESSURES.items()}
RUNS |= {f"rigid_{name}": start(p, p) + RIGID for name, p in PRESSURES.items()}
RUNS["permeable"] = start(PRESSURES["half"], PRESSURES["half"]) + RIGID + " -sand_permeability 0.01 -floor_permeable on"
PRECISIONS = ("double",)


def check(runs):
    for name, run in runs.items():
        exact = FRICTION * LOAD if name == "permeable" else FRICTION * (LOAD - PRESSURES[name.split("_")[1]])
        column = "wall_ymin_force_x" if name.startswith("side") else "floor_force_x"
        late = run.history["time"] > 0.5 * run.history["time"][-1]
        yield Row(f"friction over that of the effective stress, {name}", -run.history[column][late].mean() / exact, 1, 0.02, "definition")
