"""Energy balances: soil and fluids of several laws, that fall, are pushed, damped, carried by water, in 2D and 3D.

For each deck: the row balances; the work of gravity is the weight times the fall of the centre of mass, but for half a step, for
what a correction of positions raises and for what walls take from PIC; the work of rigids that move evenly is their force times
their way; damping takes energy; the share that is missing is small; the balance changes nothing else in the history; a run on two
ranks, by another strategy, gives the same to round-off; one in single precision begins as that in double precision does.
"""
import numpy as np

from deck import Deck, Machine, columns_but, vector
from mpm_regression.folders import history

END = 0.25  # s
LAWS = [f"-clay_young 1e6 -clay_poisson 0.3 -clay_model {law}" for law in (
        "von_mises -clay_su 800", "linear_elastic", "tresca -clay_su 1500", "mohr_coulomb -clay_friction_deg 30 -clay_cohesion 200",
        "drucker_prager -clay_friction_deg 25 -clay_cohesion 300 -clay_match plane_strain")]
FLUIDS = [f"-clay_bulk_modulus 8e5 -clay_model {law}" for law in (
          "newtonian -clay_viscosity 10", "yield_stress_fluid -clay_shear_modulus 5e4 -clay_yield_stress 300 -clay_consistency 20")]
MISSING = 0.1  # of the largest energy or work: a few steps of coarse soil that strikes a wall
AT_WALLS = 0.02  # likewise, of the work of gravity with PIC: each step, a wall stops what PIC has brought to its nodes, before forces act


class Energy(Deck):
    backends = ("serial",)
    strategies = ("tile",)
    several = others = 0.0  # both at once, in `compare`

    def make(self):
        draw, dim = self.draw, self.dim
        self.water, rigid, self.damping = draw.random() < 0.2, draw.random() < 0.5, draw.choice([0, 0, 0.2])
        self.update = draw.choice(["flip", "apic", "xpic", "pic"])
        law = draw.choice(LAWS if self.water else LAWS + FLUIDS)
        flat, deep = [0] * (dim - 2), [1.5] * (dim - 2)
        self.plain = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector([4, *deep, 3])} -mesh_spacing 0.25 -materials clay "
                      f"-clay_density 1800 {law} -bodies soil -soil_shape box -soil_lower {vector([0.5, *flat, 0])} "
                      f"-soil_upper {vector([2, *deep, 1.75])} -gravity {vector([0, *flat, -9.81])} -soil_material clay "
                      f"-soil_velocity {vector([draw.uniform(-1, 1), *flat, 0])} "
                      f"-mesh_{'xmax' if dim == 2 else 'zmin'} {draw.choice(['roller', 'fixed'])} "
                      f"-velocity_update {self.update} -damping {self.damping} "
                      f"-particle_domain {draw.choice(['fixed', 'stretch', 'split'])} -f_bar_fraction {draw.choice([0, 0.98])} "
                      f"-position_correction {draw.choice(['none', 'delta'])} "
                      f"-soil_particles_per_cell {draw.choice([1, 2, 3] if dim == 2 else [1, 2])} -time_end {END} -history_interval 0.01 "
                      f"-time_courant {draw.choice([0.1, 0.2, 0.3])} -output_frames off").split()
        self.plain += ["-water_level", "3", "-water_density", "1000"] if self.water else []
        if rigid:
            low, high = ([0.75, 1.75], [1.5, 2.25]) if dim == 2 else ([0.75, 0.25, 1.75], [1.5, 1, 2.25])
            self.plain += (f"-rigid_bodies plate -plate_shape box -plate_lower {vector(low)} -plate_upper {vector(high)} "
                           f"-plate_motion prescribed -plate_velocity {vector([draw.uniform(-0.3, 0.3), *flat, -1])}").split()
            self.plain += draw.choice([[], ["-plate_friction", "0.4"]])
        self.options = [*self.plain, "-output_energy", "on"]

    def check(self, folder):
        self.balance(history(folder), self.exact)

    def balance(self, h, exact_numbers):
        """Checks the rows; their columns of energy and work, and the scale of these."""
        column = {name.split("_", 1)[1]: h[name] for name in h if name.startswith(("energy_", "work_"))}
        works = column["gravity"] + column["rigids"] + column["contact"] + column["damping"] + column["update"]
        scale = max(np.abs(column[name]).max() for name in ("kinetic", "internal", "gravity", "rigids"))
        left = column["kinetic"] - column["kinetic"][0] + column["internal"] + column["lost"] - works - column["error"]
        assert np.abs(left).max() < 1e-9 * scale, f"the row does not balance by {np.abs(left).max() / scale:.3g}"
        missing = np.abs(column["error"]).max() / scale
        assert missing < MISSING, f"{missing:.3g} are missing"
        self.note("share of the energy that is missing", missing)
        if not self.water and h["soil_lost_mass"].max() == 0:
            centre, momentum = h[f"soil_centre_{self.up}"], h[f"soil_momentum_{self.up}"]
            exact = -9.81 * h["soil_mass"] * (centre - centre[0]) + h.get("soil_raised_energy", 0)
            slack = 2 * 9.81 * h["dt"].max() * np.abs(momentum).max()
            slack += ((1e-9 if exact_numbers else 1e-3) + (AT_WALLS if self.update == "pic" else 0)) * scale
            assert np.abs(column["gravity"] - exact).max() < slack, "the work of gravity is not that of the centre"
        if "plate_x" in h:
            exact = -sum(np.cumsum(h[f"plate_force_{a}"][1:] * np.diff(h[f"plate_{a}"])) for a in self.axes)
            assert np.abs(column["rigids"][1:] - exact).max() < 1e-6 * scale, "the work of the rigid is not its force times its way"
        assert column["damping"].max() <= 0 and (self.damping == 0) == (column["damping"].min() == 0), "damping gives energy"
        assert (column["elastic"] >= 0).all() and column["dissipated"].min() > -0.02 * scale, "the soil gives energy from nothing"
        return column, scale

    def compare(self, whole):
        off, on = (np.array(columns_but(folder, ("energy_", "work_"))[1:], dtype=float) for folder in (self.go("off", options=self.plain), whole))
        size = np.abs(on).max(axis=0) + 1e-9
        assert off.shape == on.shape and np.abs(off - on).max() <= self.bound(1e-7, 1e-3) * size.max(), "the balance changes the history"
        column, scale = self.balance(history(whole), self.exact)
        machine = Machine(self.draw.choice(self.given.backends), self.draw.choice(["tile", "gather", "atomic"]), 2)
        self.check_begin(column, scale, self.go("pair", machine=machine), self.bound(1e-8, 1e-3), self.exact, "two ranks")
        if not self.exact and "double" in self.given.precisions:
            self.check_begin(column, scale, self.go("double", "-precision", "double"), 1e-3, True, "the run in double precision")

    def check_begin(self, column, scale, folder, bound, exact_numbers, whose):
        """The first rows of two balances, before round-off grows."""
        theirs, _ = self.balance(history(folder), exact_numbers)
        for name, values in column.items():
            far = np.abs(values[:6] - theirs[name][:6]).max() / scale
            assert far < bound, f"{name} of {whose} is {far:.3g} off"
