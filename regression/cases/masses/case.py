"""Masses of shapes

Bodies whose surfaces do not follow the mesh: a ball, a wedge, a tilted layer, a cylinder and a cone in 3D, a disc and a wedge in plane strain,
and a ball and a cone as bodies of revolution. Their particles are the parts of the lattice's cells in the shape (`-NAME_fill cut`), so their mass is the density times the
volume of the shape.
"""

import numpy as np

from mpm_regression.row import Row

DENSITY = 2000.0
FLAT = " -dim 2 -mesh_lower 0,0 -mesh_upper 4,4"
ROUND = FLAT + " -geometry axisymmetric -mesh_xmin roller"
SHAPES = {  # options, volume (m3; m2 in plane strain)
    "ball": (" -body_shape ball -body_centre 2.03,1.94,2.11 -body_radius 1.3", 4 / 3 * np.pi * 1.3**3),
    "wedge": (" -body_shape polygon -body_width 0.5,3.1 -body_polygon 0.31,0.2,3.7,0.2,3.7,2.43", 0.5 * 3.39 * 2.23 * 2.6),
    "tilted_layer": (" -body_shape layer -body_base 0,0.33,4,1.71 -body_top 0,1.21,4,2.59", 0.88 * 16),
    "cylinder": (" -body_shape cylinder -body_centre 1.93,2.05,0.47 -body_radius 1.1 -body_height 2.3", np.pi * 1.1**2 * 2.3),
    "cone": (" -body_shape cone -body_tip up -body_centre 2.02,1.97,3.4 -body_radius 1.5 -body_height 2.7", np.pi * 1.5**2 * 2.7 / 3),
    "disc": (FLAT + " -body_shape disc -body_centre 1.97,2.06 -body_radius 1.37", np.pi * 1.37**2),
    "flat_wedge": (FLAT + " -body_shape polygon -body_polygon 0.31,0.2,3.7,0.2,3.7,2.43", 0.5 * 3.39 * 2.23),
    "ball_of_revolution": (ROUND + " -body_shape disc -body_centre 0,2.03 -body_radius 1.3", 4 / 3 * np.pi * 1.3**3),
    "cone_of_revolution": (ROUND + " -body_shape polygon -body_polygon 0,0.4,1.5,0.4,0,3.1", np.pi * 1.5**2 * 2.7 / 3),
}
RUNS = {name: options for name, (options, _) in SHAPES.items()}


def check(runs):
    for name, (_, volume) in SHAPES.items():
        yield Row(f"mass over density times volume, {name.replace('_', ' ')}", runs[name].history["body_mass"][-1] / (DENSITY * volume), 1, 1e-3,
                  "volume of the shape")
