"""Simple shear to 200 %

A block of elastic material is sheared to $\\gamma = 2$. With the Jaumann rate its stress must follow
$\\sigma_{xy} = G \\sin\\gamma$, $\\sigma_{xx} = -\\sigma_{yy} = G (1 - \\cos\\gamma)$. The particles move on straight lines
at constant speed, which needs no force. The block is so dense that its stress changes this motion by only $10^{-9}$. At the
free surfaces, nodes are covered on one side only, and FLIP does not preserve a linear velocity there; this does not affect
the particles within a cell of the centre, which the check compares. With APIC the check compares the whole block. The whole
spin of a step turns the stress before the step's increment is added, an error of first order in the step, which remains at
4000 steps. In 3D the shear is in the vertical plane.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.results import read_frame

CENTRE = np.array([-1.3, -0.1])
SIZE = np.array([22.0, 6.0])
IN_3D = ("-dim 3 -mesh_lower -20.3,0.3,-5.1 -mesh_upper 17.7,1.3,4.9 -mesh_zmin free -mesh_zmax free -mesh_ymin roller"
         " -mesh_ymax roller")
RUNS = {"2D": "-block_file {start}", "3D": "-block_file {start} " + IN_3D,
        "apic": "-block_file {start} -velocity_update apic"}
WHERE = {"2D": "2D", "3D": "3D", "apic": "2D, APIC, free surface too"}
SHEAR_MODULUS = 1.0


def prepare(run, path, options):
    lower, upper = list(CENTRE - SIZE / 2), list(CENTRE + SIZE / 2)
    if run == "3D":
        lower[1:1], upper[1:1] = [0.3], [1.3]
    position = particles.lattice(lower, upper, 0.5)
    velocity = np.zeros_like(position)
    velocity[:, 0] = position[:, -1] - CENTRE[1]
    particles.write(path, "block", position, 0.5, velocity=velocity)


def components(fields, dim, everywhere=False):
    """Stress xx, vertical and shear over G of the particles near the centre, [N, 3]."""
    up, shear = (1, 3) if dim == 2 else (2, 5)
    offset = fields["position"][:, [0, up]] - CENTRE
    near = np.all(np.abs(offset) < 1, axis=1) | everywhere
    return fields["stress"][near][:, [0, up, shear]] / SHEAR_MODULUS


def exact(gamma):
    return np.array([1 - np.cos(gamma), np.cos(gamma) - 1, np.sin(gamma)])


def check(runs):
    for name, run in runs.items():
        stress = components(last_frame(run, "block"), int(run.number("dim", 2)), everywhere=name == "apic")
        error = np.abs(stress - exact(2.0)).max() if len(stress) else np.nan
        yield Row(f"largest error of the stress over G at a shear of 2, {WHERE[name]}", error, 0, 1e-3, "Jaumann rate")


def draw(axes, runs):
    frames = [read_frame(path) for path in sorted(runs["2D"].folder.glob("frames/frame_*.h5"))]
    gamma = np.array([time for time, _ in frames])
    stress = np.array([components(groups["block"], 2).mean(axis=0) for _, groups in frames])
    for k, name in enumerate(("xx", "yy", "xy")):
        line, = axes.plot(gamma, stress[:, k], "o", ms=4, label=f"$\\sigma_{{{name}}}$")
        axes.plot(gamma, exact(gamma)[k], color=line.get_color(), lw=0.8)
    axes.set(xlabel="shear $\\gamma$", ylabel="stress over $G$ (lines: exact)")
    axes.legend()
