"""Ground between sides of the free field.

Two kinds of decks. *Level* ground of one to three elastic layers, on a base of a random kind that moves, or under gravity that
shakes: between sides of the free field it must move as between periodic sides, in 3D also where only one pair of sides is of the
free field. *Slopes* of a random law with weight, which come to rest before they are shaken: the momentum must be what gravity and the
sides have made of it.
"""
import h5py
import numpy as np

from deck import Deck, check_impulse, vector
from mpm_regression.folders import frames, history, of_velocities

H = 0.5  # m, edge of a cell
OFF_COLUMN = {"double": 1e-6, "single": 0.02}  # of the largest displacement
SPEED = {"double": 1e-6, "single": 1e-2}  # m/s; single precision would not see less
END = 0.15  # s, of level ground


def table(draw, size, free, end):
    """A motion by components that ends at rest."""
    times = sorted(draw.uniform(0.01, 0.8 * end) for _ in range(3))
    points = [(0.0, [0.0] * len(free))] + [(t, [draw.uniform(-size, size) if f else 0.0 for f in free]) for t in times] + [(end, [0.0] * len(free))]
    return ",".join(":".join(repr(float(x)) for x in (t, *v)) for t, v in points)


def positions(path):
    """Positions of all particles, m."""
    with h5py.File(path) as file:
        return np.concatenate([file[name]["position"][()].astype(float) for name in file if "position" in file[name]])


class FreeField(Deck):
    several, others = 0.5, 0.1

    def make(self):
        self.level = self.draw.random() < 0.6
        self.make_level() if self.level else self.make_slope()

    def base_motion(self):
        """Motion of the ground's base, or gravity. The first component along the vertical is that of a roller."""
        draw, axis, size = self.draw, self.up, SPEED[self.precision]
        kind = draw.choice(["fixed", "absorbing", "absorbing", "roller", "gravity"])
        free = [kind != "roller"] * (self.dim - 1) + [True]
        if kind == "gravity":
            return [f"-mesh_{axis}min", draw.choice(["fixed", "absorbing"]), "-gravity_table", table(draw, 20 * size, free, END)]
        options = [f"-mesh_{axis}min", kind, f"-mesh_{axis}min_velocity_table", table(draw, size, free, END)]
        if kind == "absorbing":
            options += draw.choice([[], [f"-mesh_{axis}min_dashpot_factor", "0.5"]])
            options += draw.choice([[], [f"-mesh_{axis}min_spring_length", "8"]])
        return options

    def free_sides(self, axis, prefix=""):
        options, draw = [], self.draw
        for side in (f"{prefix}mesh_{axis}min", f"{prefix}mesh_{axis}max"):
            options += [f"-{side}", "free_field"]
            options += draw.choice([[], [f"-{side}_dashpot_factor", repr(draw.uniform(0.3, 2))]])
            options += draw.choice([[], [f"-{side}_spring_length", "20"]])
        return options

    def make_level(self):
        """Layers, and the options of a column in the place of those of the lateral sides."""
        draw, dim = self.draw, self.dim
        layers, width = draw.randint(1, 3), [H * 8] if dim == 2 else [H * 4, H * 4]
        heights = np.cumsum([H * draw.randint(2, 4) for _ in range(layers)])
        heights[-1] += draw.choice([0.25, 0.375]) * H if dim == 2 else 0.25 * H
        per_cell = 2 if heights[-1] % (H / 2) == 0 else 4
        names = [f"layer{n}" for n in range(layers)]
        common = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector([*width, H * (np.ceil(heights[-1] / H) + 2)])} "
                  f"-mesh_spacing {H} -mesh_{self.up}max free -materials {','.join(n + '_soil' for n in names)} -bodies {','.join(names)} "
                  f"-time_end {END} -output_interval {END / 3} -history_interval 0.005").split()
        for name, low, high in zip(names, [0, *heights], heights):
            common += (f"-{name}_soil_model linear_elastic -{name}_soil_density {draw.uniform(1400, 2200):.6g} "
                       f"-{name}_soil_young {10 ** draw.uniform(6.5, 7.8):.6g} -{name}_soil_poisson {draw.choice([0, 0.2, 0.3, 0.45])} "
                       f"{draw.choice(['', f'-{name}_soil_pore_stiffness 5e7'])} "
                       f"-{name}_material {name}_soil -{name}_shape box -{name}_lower {vector([0] * (dim - 1) + [low])} "
                       f"-{name}_upper {vector([*width, high])} -{name}_particles_per_cell {per_cell}").split()
        common += self.base_motion()
        common += (f"-velocity_update {draw.choice(['flip', 'flip', 'apic', 'xpic'])} -f_bar_fraction {draw.choice(['0', '0.98', '0.98'])} "
                   f"-damping {draw.choice(['0', '0', '0.05'])} -time_courant {draw.choice(['0.2', '0.33'])} "
                   f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch'])} -rebuild_margin {draw.choice(['0.5', '0.05'])}").split()
        across = self.axes[:-1]
        periodic = {axis: [f"-mesh_{axis}min", "periodic", f"-mesh_{axis}max", "periodic"] for axis in across}
        some = draw.choice([across, across[:1]])
        self.column = common + [word for axis in across for word in periodic[axis]]
        self.options = common + [word for axis in across for word in (self.free_sides(axis) if axis in some else periodic[axis])]

    def make_slope(self):
        draw, dim, up = self.draw, self.dim, self.up
        wide = 10.0 if dim == 2 else 6.0
        low, high = H * draw.randint(3, 5), H * draw.randint(6, 8)
        outline = [0, 0, wide, 0, wide, high, 0.7 * wide, high, 0.3 * wide, low, 0, low]
        size = [wide, 5.0] if dim == 2 else [wide, 2.0, 5.0]
        law = draw.choice([f"von_mises -clay_su {draw.uniform(1e4, 3e4):.6g} -clay_young 1e7", "linear_elastic -clay_young 1e7",
                           "mohr_coulomb -clay_cohesion 8e3 -clay_friction_deg 30 -clay_young 1e7"])
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(size)} -mesh_spacing {H} -mesh_{up}max free "
                        f"-materials clay -clay_model {law} -clay_poisson 0.3 -clay_density 1800 -bodies soil -soil_material clay "
                        f"-soil_shape polygon -soil_polygon {vector(outline)} "
                        f"-gravity {vector([0] * (dim - 1) + [-9.81])} -stages rest,shake -rest_damping 0.7 "
                        f"-rest_time_end 0.3 -rest_mesh_{up}min fixed -shake_time_end 0.3 -history_interval 0.005 -output_interval 0.1 "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -rebuild_margin {draw.choice(['0.5', '0.05'])} "
                        "-time_courant 0.3").split()
        if dim == 3:
            self.options += ["-soil_width", "0,2"]
            self.options += draw.choice([[], ["-shake_mesh_ymin", "free_field"], ["-mesh_ymin", "periodic", "-mesh_ymax", "periodic"]])
        self.options += ["-rest_mesh_xmin", draw.choice(["roller", "fixed"])]
        self.options += [f"-shake_mesh_{up}min", draw.choice(["fixed", "absorbing"])]
        self.options += [f"-shake_mesh_{up}min_velocity_table", table(draw, 0.1, [True] + [False] * (dim - 1), 0.3)]
        self.options += self.free_sides("x", "shake_")

    def check(self, folder):
        """The momentum of a slope along x and the vertical, since it is shaken and no damping acts."""
        if self.level:
            return
        values = history(folder)
        shaken = np.flatnonzero(values["stage"] == 2)
        steps = np.diff(values["time"])[shaken - 1]
        kicks = np.diff(of_velocities(values["time"], values["dt"]))[shaken - 1]
        sides = [name[:-len("_force_x")] for name in values if name.startswith("wall_") and name.endswith("_force_x")]
        weight = 9.81 * values["soil_mass"][0]
        for axis in ("x", self.up):
            force = sum(values[f"{side}_force_{axis}"] for side in sides)[shaken]
            gained = np.cumsum(kicks * (-weight if axis != "x" else 0) - steps * force)
            momentum = values[f"soil_momentum_{axis}"][shaken[0] - 1:shaken[-1] + 1]
            check_impulse(momentum, gained, weight * 0.3, self.bound(1e-10, 1e-4), axis)

    def compare(self, whole):
        """Level ground between periodic sides."""
        if not self.level:
            return
        alone = self.go("column", options=self.column)
        first = positions(frames(alone)[0])
        exact, got = positions(frames(alone)[-1]) - first, positions(frames(whole)[-1]) - first
        apart = np.abs(got - exact).max() / np.abs(exact).max()
        self.note(f"level ground off the column, {self.precision}", apart)
        assert apart < OFF_COLUMN[self.precision], f"the ground is {apart:.3g} of its displacement off the column"
