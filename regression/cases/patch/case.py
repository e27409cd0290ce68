"""Patch tests

*One stress everywhere.* A block fills a mesh whose sides hold it, under a stress with all components that is the same
everywhere. All forces balance, so nothing may move: the gradients of the weights must sum to zero over the particles
of each node, up to the walls. *One strain everywhere.* The block starts with a velocity that is linear in space. After one
step the stress must be that of Hooke's law for this strain at every particle that is more than two cells from the surface, and
the particles must have moved with the linear field. In 2D and 3D, the corner of the mesh at odd numbers.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row

SPACING, YOUNG, POISSON, DENSITY = 0.13, 3e5, 0.3, 1800.0
LOWER, CELLS = np.array([-17.31, 4.77, 2.11]), np.array([12, 8, 7])
STRESS = np.array([-1300.0, -700.0, -900.0, 210.0, -160.0, 330.0])
GRADIENT = np.array([[0.7, -0.4, 0.2], [0.5, -0.9, 0.3], [-0.6, 0.1, 0.8]])  # 1/s
UPPER = LOWER + CELLS * SPACING
IN_3D = (f"-dim 3 -mesh_lower {','.join(f'{x:.12g}' for x in LOWER)} -mesh_upper {','.join(f'{x:.12g}' for x in UPPER)}"
         " -mesh_zmin fixed -mesh_zmax fixed")
DIMS = {"2D": "", "3D": IN_3D}
RUNS = {f"{kind}_{dim}": f"-block_file {{start}} {more} {options}" for dim, options in DIMS.items()
        for kind, more in (("rest", ""), ("strain", "-time_max_steps 1"))}


def prepare(run, path, options):
    dim = int(run[-2])
    position = particles.lattice(LOWER[:dim], UPPER[:dim], SPACING / 2)
    if run.startswith("rest"):
        stress = STRESS * (1 if dim == 3 else np.array([1, 1, 1, 1, 0, 0]))
        particles.write(path, "block", position, SPACING / 2, stress=np.tile(stress, (len(position), 1)))
    else:
        centre = (LOWER + UPPER)[:dim] / 2
        velocity = (position - centre) @ GRADIENT[:dim, :dim].T
        particles.write(path, "block", position, SPACING / 2, velocity=velocity)


def hooke(gradient, dt):
    """Stress [6] of one step of a velocity gradient [3, 3], Pa."""
    strain = (gradient + gradient.T) / 2 * dt
    shear = YOUNG / (2 * (1 + POISSON))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    stress = lame * np.trace(strain) * np.eye(3) + 2 * shear * strain
    return np.array([stress[0, 0], stress[1, 1], stress[2, 2], stress[0, 1], stress[1, 2], stress[2, 0]])


def check(runs):
    wave_speed = np.sqrt(YOUNG / DENSITY)
    for name in DIMS:
        fields = last_frame(runs[f"rest_{name}"], "block")
        scale = np.abs(STRESS).max() / (DENSITY * wave_speed)
        yield Row(f"one stress: largest speed over sigma/(rho c) after 200 steps, {name}", np.abs(fields["velocity"]).max() / scale,
                  0, 1e-11, "balance of forces", single=1e-3)
        run = runs[f"strain_{name}"]
        dim, dt = int(run.number("dim", 2)), run.history["time"][-1]
        gradient = np.zeros((3, 3))
        gradient[:dim, :dim] = GRADIENT[:dim, :dim]
        fields = last_frame(run, "block")
        position = fields["position"][:, :dim]
        inside = np.all((position > LOWER[:dim] + 2 * SPACING) & (position < UPPER[:dim] - 2 * SPACING), axis=1)
        expected = hooke(gradient, dt)
        error = np.abs(fields["stress"][inside] - expected).max() / np.abs(expected).max() if inside.any() else np.nan
        yield Row(f"one strain: largest error of the stress over the stress, {name}", error, 0, 1e-11, "Hooke's law", single=1e-4)
