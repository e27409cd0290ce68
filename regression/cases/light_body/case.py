"""Light rigid bodies

*Falls*: a disc, a hundredth to half as heavy as the soil of a layer of cells at its face, falls on clay. Contact is inelastic, so that
only the clay throws it back, with some per cent of the energy of its impact. Contact that takes the body as infinitely heavy throws a disc of
5 kg/m³ up with 130 times this energy. *Stands*: a light block on soil is carried with its weight, and does not go into the soil.
"""

import numpy as np

from mpm_regression.row import Row

G = 9.81
FALLS = {f"falls_{density}_{radius}": f"-ball_density {density} -ball_radius {radius} -time_end 0.35"
         for density in (5, 300, 900) for radius in (0.05, 0.15) if density < 900 or radius < 0.1}
STANDS = ("-rigid_bodies block -block_shape box -block_lower 0.8,1 -block_upper 1.2,1.1 -block_motion dynamic -block_density {0} -block_friction 0.5"
          " -block_free x,y,rz -damping 0.1 -time_end 2 -history_interval 0.01")
RUNS = {**FALLS, **{f"stands_{density}": STANDS.format(density) for density in (10, 300)}}


def check(runs):
    for name in FALLS:
        _, density, radius = name.split("_")
        velocity = runs[name].history["ball_velocity_y"]
        down, up = velocity.min(), velocity[np.argmin(velocity):].max()
        yield Row(f"energy of the rebound over that of the impact, {density} kg/m³, radius {float(radius) / 0.1:g} cells", (up / down) ** 2, 0, 0.05,
                  "inelastic contact on clay")
    for density in (10, 300):
        h = runs[f"stands_{density}"].history
        late = h["time"] > 1
        yield Row(f"mean reaction over the weight, {density} kg/m³", h["block_force_y"][late].mean() / (density * 0.04 * G), 1, 1e-3, "equilibrium")
        yield Row(f"way into the soil in the second second, {density} kg/m³ (cells)", np.ptp(h["block_y"][late]) / 0.1, 0, 2e-3, "equilibrium")
