"""Waves of a saturated column

A column of 1 m between closed rollers begins with the velocity $v = 10^{-4}\\sin(\\pi y/H)$ of its grains and no flux. Each mode
of the u-w equations is a system of three ordinary differential equations for the displacement $u$ and velocity $v$ of the
grains and the Darcy flux $w$; its solution has the fast wave, the slow wave and the consolidation of Biot (1956). With
$k = 10^{-2}$ m/s the flux is as fast as the grains; with $10^{-4}$ m/s the column is nearly undrained, and the wave lasts.
The flux follows the pressure of the step before, so its phase needs a short step there. `quiet` is a column in two layers whose porosities are 0.3 and 0.5, with its own weight under water of 2 m: nothing may move.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row
from soil_mpm.results import read_frame

HEIGHT, SPACING, SPEED = 1.0, 0.0125, 1e-4  # m, m, m/s
QUIET = (" -materials sand,clay -bodies column,upper -upper_material clay -upper_shape particles -upper_file {start}"
         " -clay_model linear_elastic -clay_young 10e6 -clay_poisson 0.25 -clay_water saturated -clay_porosity 0.5"
         " -clay_grain_density 2650 -clay_permeability 1e-3 -sand_porosity 0.3 -gravity 0,-9.81 -water_level 2 -time_end 0.02")
RUNS = {"coarse": "-column_file {start} -sand_permeability 1e-2 -time_end 0.01 -output_interval 0.002",
        "fine": "-column_file {start} -time_step 2.5e-6", "quiet": "-column_file {start}" + QUIET}
# k, time, displacement, velocity of the grains and flux of the mode: integral of its equations.
EXACT = {("coarse", 0.002): (4.8076e-8, -4.4108e-5, -4.4345e-5), ("coarse", 0.01): (2.1323e-8, -9.56e-7, 1.7341e-5),
         ("fine", 0.01): (-1.1648e-8, -9.2139e-5, 2.8453e-7), ("fine", 0.05): (-4.1606e-8, -3.1701e-5, 1.0304e-6)}
SCALES = {"coarse": (1e-4 / 1755, 1e-4, 4.4e-5), "fine": (1e-4 / 1594, 1e-4, 1e-6)}
PRECISIONS = ("double",)  # displacements of 1e-8 m are round-off of single precision


def buoyant(y):
    """Effective vertical stress of the two layers [Pa], grains of 2650 kg/m3 under water: 0.5 m of each."""
    upper, lower = 0.5 * 1650 * 9.81, 0.7 * 1650 * 9.81
    return np.where(y > 0.5, -upper * (HEIGHT - y), -upper * 0.5 - lower * (0.5 - y))


def prepare(run, path, options):
    import h5py

    place = particles.lattice((0, 0), (0.025, HEIGHT), SPACING)
    path.unlink(missing_ok=True)
    if run != "quiet":
        velocity = np.zeros_like(place)
        velocity[:, 1] = SPEED * np.sin(np.pi * place[:, 1] / HEIGHT)
        return particles.write(path, "column", place, SPACING, velocity=velocity)
    with h5py.File(path, "w") as file:
        for name, inside in (("column", place[:, 1] < 0.5), ("upper", place[:, 1] > 0.5)):
            group, own = file.create_group(name), place[inside]
            stress = np.zeros((len(own), 6))
            stress[:, 1] = buoyant(own[:, 1])
            stress[:, 0] = stress[:, 2] = stress[:, 1] / 3
            group["position"], group["stress"] = particles.with_zeros(own), stress
            group["volume"] = np.full(len(own), SPACING**2)


def mode(run, time):
    """Amplitudes of the first mode of displacement, velocity and flux in the frame at a time."""
    start = read_frame(run.frames[0])[1]["column"]["position"][:, 1]
    frame = read_frame(run.frame_near(time))[1]["column"]
    shape = np.sin(np.pi * start / HEIGHT)
    values = (frame["position"][:, 1] - start, frame["velocity"][:, 1], frame["darcy_flux"][:, 1])
    return [2 * np.mean(value * shape) for value in values]


def check(runs):
    for (name, time), exact in EXACT.items():
        bound = 0.03 if time == min(t for run, t in EXACT if run == name) else 0.07
        for what, found, answer, scale in zip(("displacement", "velocity", "flux"), mode(runs[name], time), exact, SCALES[name]):
            yield Row(f"{what} of the mode over its size, {name}, {time:g} s", found / scale, answer / scale, bound,
                      "modal equations, integrated")
    frames = read_frame(runs["quiet"].frames[-1])[1]
    fastest = max(np.abs(frames[body][field]).max() for body in ("column", "upper") for field in ("velocity", "darcy_flux"))
    yield Row("largest speed and flux at rest over the speed of the fast wave, layers of porosity 0.3 and 0.5", fastest / 560, 0,
              1e-12, "hydrostatic", single=1e-5)
