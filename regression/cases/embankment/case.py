"""Slopes at equilibrium

An embankment, a heap as a body of revolution, and a heap in 3D, of soil of `mohr_coulomb` on a rough base, come to rest under their weight in
a stage with damping that ends by equilibrium. At its end the unbalanced ratio must be below the $10^{-4}$ asked for, the base must carry
the weight to $10^{-3}$, and both halves of the embankment must have the same stress.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

GRAVITY = 9.81
RING = " -geometry axisymmetric -mesh_upper 5,3 -mesh_xmin roller -mesh_xmax free -bank_shape polygon -bank_polygon 0,0,4,0,1,2,0,2"
SOLID = (" -dim 3 -mesh_lower 0,0,0 -mesh_upper 6,6,2 -gravity 0,0,-9.81 -mesh_ymin free -mesh_ymax free -mesh_xmin free -mesh_xmax free"
         " -mesh_zmin fixed -mesh_zmax free -bank_shape cone -bank_tip up -bank_centre 3,3,1.5 -bank_radius 2.5 -bank_height 1.5")
RUNS = {"embankment": " -mesh_xmin free -mesh_xmax free -bank_shape polygon -bank_polygon 2,0,10,0,7,2,5,2", "revolution": RING, "heap": SOLID}
MIDDLE = 6.0  # m, plane of symmetry of the embankment
LABELS = {"embankment": "embankment", "revolution": "body of revolution", "heap": "heap in 3D"}


def unlike(run):
    """Largest difference of the vertical stress of a particle and its image, over the largest stress."""
    fields = last_frame(run, "bank")
    image = fields["position"] * [-1, 1, 1] + [2 * MIDDLE, 0, 0]
    order, other = (np.lexsort(np.round(x / 0.01).T) for x in (fields["position"], image))
    stress = fields["stress"][:, 1]
    return np.abs(stress[order] - stress[other]).max() / np.abs(stress).max()


def check(runs):
    for name, run in runs.items():
        what, up = LABELS[name], "xyz"[int(run.number("dim", 2)) - 1]
        last = {column: run.history[column][-1] for column in ("unbalanced_ratio", "bank_mass", f"wall_{up}min_force_{up}")}
        yield Row(f"unbalanced ratio at the end, {what}", last["unbalanced_ratio"], 0, 1e-4, "asked for")
        yield Row(f"reaction of the base over the weight, {what}", -last[f"wall_{up}min_force_{up}"] / (last["bank_mass"] * GRAVITY), 1, 1e-3, "equilibrium")
    yield Row("largest difference of the vertical stress from that of its image, embankment", unlike(runs["embankment"]), 0, 1e-6, "symmetry",
              single=1e-3)


def draw(axes, runs):
    fields = last_frame(runs["embankment"], "bank")
    points = axes.scatter(*fields["position"][:, :2].T, c=-fields["stress"][:, 1] / 1e3, s=6, cmap="viridis")
    axes.figure.colorbar(points, ax=axes, label="vertical stress, compression positive (kPa)", orientation="horizontal")
    axes.set(aspect="equal", xlabel="x (m)", ylabel="y (m)")
