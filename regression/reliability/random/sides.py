"""Sides of the mesh: friction, dashpots, velocities in time.

A deck has soil in a mesh whose sides, but the top, are of random kinds that act on the soil, under gravity that may be inclined. At
every row the momentum of the soil must be what gravity and the forces on the sides have made of it. Half of the decks rebuild their
lists often. Some decks have two stages, in which the kinds differ.
"""
import numpy as np

from deck import Deck, check_impulse, vector
from mpm_regression.folders import history, of_velocities

END = 0.15  # s


def check_side_forces(folder, gravity, body, bound):
    """Gravity and the forces on the sides make the momentum of a body."""
    values = history(folder)
    t, mass = values["time"], values[f"{body}_mass"]
    scale = mass[0] * (np.abs(gravity).max() * t[-1] + 0.2)
    sides = [name[:-len("_force_x")] for name in values if name.startswith("wall_") and name.endswith("_force_x")]
    for axis, acceleration in zip("xyz", gravity):
        force = sum(values[f"{side}_force_{axis}"] for side in sides)
        weights = np.diff(of_velocities(t, values["dt"])) * mass[1:] * acceleration
        check_impulse(values[f"{body}_momentum_{axis}"], np.cumsum(weights - np.diff(t) * force[1:]), scale, bound, axis)


class Sides(Deck):
    strategies = ("tile", "gather")

    def make(self):
        draw, dim = self.draw, self.dim
        across = [2.0, 3.0] if dim == 2 else [2.0, 1.0, 2.0]
        filled = [*across[:-1], draw.choice([0.5, 1.0, 1.13])]
        self.gravity = np.array([draw.uniform(-3, 3) for _ in range(dim - 1)] + [-9.81])
        model = draw.choice(['von_mises -clay_su 3000', 'linear_elastic'])
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.25 -materials clay "
                        f"-clay_model {model} -clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 "
                        f"-bodies soil -soil_material clay -soil_shape box -soil_lower {vector([0] * dim)} -soil_upper {vector(filled)} "
                        f"-gravity {vector(self.gravity)} -velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -mesh_{self.up}max free "
                        f"-time_courant {draw.choice(['0.2', '0.33'])} -history_interval 0.003 -output_interval 0.1").split()
        self.options += ["-rebuild_margin", draw.choice(["0.5", "0.01"])]  # seldom, and again and again
        staged = draw.random() < 0.3
        for axis, name in enumerate(self.axes):
            for side in ("min", "max")[:1 if name == self.up else 2]:
                for prefix in ("first_", "second_") if staged else ("",):
                    self.add_side(f"{prefix}mesh_{name}{side}", axis)
        self.options += ["-stages", "first,second", "-time_end", str(END / 2)] if staged else ["-time_end", str(END)]

    def add_side(self, name, axis):
        draw = self.draw
        kind = draw.choice(["friction", "friction", "absorbing", "absorbing", "fixed", "roller"])
        self.options += [f"-{name}", kind]
        if kind == "friction":
            self.options += [f"-{name}_friction", draw.choice(["0", "0.3", "2"])]
            self.options += draw.choice([[], [f"-{name}_shear_limit", "500"]])
        if kind == "absorbing":
            self.options += draw.choice([[], [f"-{name}_dashpot_factor", "0.4"]])
            self.options += draw.choice([[], [f"-{name}_spring_length", "20"]])
        sizes = [0.02 if k == axis else 0.2 if kind != "roller" else 0.0 for k in range(self.dim)]
        if draw.random() < 0.5:
            points = [":".join(repr(float(x)) for x in (t, *(draw.uniform(-s, s) for s in sizes))) for t in (0, draw.uniform(0.01, 0.14), 9)]
            self.options += [f"-{name}_velocity_table", ",".join(points)]
            self.options += draw.choice([[], [f"-{name}_velocity_table_interpolation", "smooth"]])
        elif kind in ("fixed", "roller") or draw.random() < 0.4:
            self.options += [f"-{name}_velocity", vector(draw.uniform(-s, s) for s in sizes)]

    def check(self, folder):
        check_side_forces(folder, self.gravity, "soil", self.bound(1e-10, 1e-4))
