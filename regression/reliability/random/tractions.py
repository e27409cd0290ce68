"""Loads on surfaces: pressures and tractions, constant and by tables, on bodies of random shapes.

A body that touches nothing has up to three loads on parts of its surface. From row to row its momentum must change by the force that
the history has, and by its weight. A table of one value must give the same bits as the constant. Where the run has an energy
balance, its row must hold. In some decks stages change the loads.
"""
import numpy as np

from deck import Deck, check_impulse, flat_table, rounded
from mpm_regression.folders import history, of_velocities
from loads import table_options

STEP = 2e-4  # s
CUT = 1e-7  # share of a step's impulse that nodes below the cut of the mass leave out (method.md), while a surface leaves a row of nodes
SPACING = 0.25
GRAVITY = 9.81


class Tractions(Deck):
    strategies = ("sequential", "mosaic", "gather", "tile", "tile")
    threads = (1, 1, 1, 2)
    others = 0.5
    apart = {"double": 1e-7, "single": 2e-2}

    def make(self):
        draw, dim = self.draw, self.dim
        self.rings = dim == 2 and draw.random() < 0.2
        self.steps = draw.choice([20, 40, 80])
        self.gravity = draw.choice([0.0, -GRAVITY])
        across = [4.0, 4.0] if dim == 2 else [4.0, 3.0, 4.0]
        centre = [0.0 if self.rings else 2.0, *[x / 2 for x in across[1:]]]
        walls = " ".join(f"-mesh_{a}{s} free" for a in self.axes for s in ("min", "max") if not (self.rings and a + s == "xmin"))
        self.base = (f"-dim {dim} -mesh_lower {rounded([0] * dim)} -mesh_upper {rounded(across)} -mesh_spacing {SPACING} {walls} "
                     "-materials soil -soil_density 2000 -soil_poisson 0.3 "
                     f"-soil_model {draw.choice(['linear_elastic', 'von_mises -soil_su 2e4'])} -soil_young {draw.choice(['1e6', '2e7'])} "
                     f"-gravity {rounded([0] * (dim - 1) + [self.gravity])} -time_step {STEP} -time_end {STEP * self.steps} "
                     f"-history_interval {STEP} -output_interval {STEP * self.steps}").split()
        domain = "fixed" if self.rings else draw.choice(["fixed", "fixed", "stretch", "split"])
        self.base += ["-particle_domain", domain, "-velocity_update", draw.choice(["flip", "flip", "apic", "xpic"])]
        self.balance = draw.random() < 0.3
        self.base += ["-output_energy", "on"] if self.balance else []
        self.add_shapes(centre)
        self.loads = ["top", "side", "all"][: draw.choice([1, 1, 2, 3])]
        self.constant, self.timed, self.flat = ([*self.base, "-loads", ",".join(self.loads)] for _ in range(3))
        for name in self.loads:
            self.add_load(name, across)
        self.options = self.timed

    def add_shapes(self, centre):
        draw, dim, names = self.draw, self.dim, ["block"]
        per_cell = draw.choice([1, 2, 3])
        kind = draw.choice(["box", "disc"] if self.rings else ["box", "turned", "disc", "two"])
        half = [draw.choice([0.5, 0.75, 0.7]) for _ in range(dim)]
        lower, upper = [c - h for c, h in zip(centre, half)], [c + h for c, h in zip(centre, half)]
        if self.rings:
            lower[0] = 0.0
        if kind == "disc":
            self.base += f"-block_shape disc -block_centre {rounded(centre)} -block_radius {draw.choice([0.6, 0.8])}".split()
        else:
            self.base += f"-block_shape box -block_lower {rounded(lower)} -block_upper {rounded(upper)}".split()
            self.base += ["-block_angle_deg", str(draw.choice([10, 30, 45, -20]))] if kind == "turned" else []
        if kind == "two":  # another body on the first: the face between them is no surface
            names.append("other")
            low, high = [upper[0], *lower[1:]], [upper[0] + 0.5, *upper[1:]]
            self.base += (f"-other_shape box -other_lower {rounded(low)} -other_upper {rounded(high)} -other_material soil "
                          f"-other_particles_per_cell {per_cell}").split()
        self.base += f"-bodies {','.join(names)} -block_material soil -block_particles_per_cell {per_cell}".split()
        self.names, self.centre, self.covered = names, centre, kind == "two"
        self.base += ["-geometry", "axisymmetric"] if self.rings else ["-block_velocity", rounded(draw.uniform(-0.5, 0.5) for _ in range(dim))]

    def add_load(self, name, across):
        draw, dim = self.draw, self.dim
        low, high, options = [0.0] * dim, list(across), []
        if name != "all" and draw.random() < 0.5:
            k = draw.randrange(dim)
            low[k] = self.centre[k] if not (k == 0 and (self.rings or self.covered)) else 0.0
        if name == "top":
            options += ["-top_facing", rounded([0] * (dim - 1) + [1])]
        if name == "side":
            options += ["-side_facing", rounded([-1 if self.covered else 1] + [0] * (dim - 1))]
        options += f"-{name}_body block -{name}_lower {rounded(low)} -{name}_upper {rounded(high)}".split()
        kinds = draw.choice([["pressure"], ["traction"], ["pressure", "traction"]])
        for each in (self.constant, self.timed, self.flat):
            each += options
        for kind in kinds:
            value = [draw.uniform(-300, 300) for _ in range(1 if kind == "pressure" else dim)]
            if kind == "traction" and self.rings:
                value[0] = 0.0
            text = ",".join(map(repr, value))
            self.constant += [f"-{name}_{kind}", text]
            self.flat += [f"-{name}_{kind}_table", flat_table(text)]
            self.timed += self.table(f"{name}_{kind}", value)

    def table(self, name, value):
        draw, end = self.draw, STEP * self.steps
        times = sorted([0.0, end * 1.01, *(draw.uniform(0, end) for _ in range(draw.choice([0, 2, 9])))])
        factors = draw.random() < 0.5
        values = [[draw.uniform(-1, 1)] if factors else [x * draw.uniform(-1, 1) for x in value] for _ in times]
        return table_options(draw, self.folder, name, times, values) + ([f"-{name}", ",".join(map(repr, value))] if factors else [])

    def check(self, folder):
        if not self.balance:
            return
        values = history(folder)
        works = sum(values[name] for name in values if name.startswith("work_"))
        kinetic, missing = values["energy_kinetic"], values["energy_error"]
        error = np.abs(kinetic - kinetic[0] + values["energy_internal"] + values["energy_lost"] - works - missing).max()
        size = max(np.abs(values[name]).max() for name in values if name.startswith(("work_", "energy_")))
        assert error < 1e-9 * size, f"the energy balance is {error / size:.3g} off"
        self.note("missing of the energy balance", np.abs(missing).max() / size)

    def check_momentum(self, folder):
        """Constant loads: their forces at a row are those of the step that follows."""
        values = history(folder)
        time, mass = values["time"], sum(values[f"{name}_mass"] for name in self.names)
        assert np.ptp(mass) < 1e-6 * mass[0], "the body has left the mesh"
        steps = np.diff(of_velocities(time, STEP))
        for axis in self.axes[self.rings:]:  # the axis of revolution holds what is along x
            momentum = sum(values[f"{name}_momentum_{axis}"] for name in self.names)
            force = sum(values[f"{name}_force_{axis}"] for name in self.loads)
            weight = mass * self.gravity if axis == self.up else 0 * mass
            impulses = steps * (np.abs(force) + np.abs(weight))[:-1]
            size = impulses.sum() + np.abs(momentum).max() + 1e-3
            self.note("momentum off the impulse of the loads", check_impulse(
                momentum, np.cumsum(steps * (force + weight)[:-1]), size, self.bound(1e-11, 2e-4) + CUT * impulses.max() / size, axis))

    def compare(self, whole):
        constant = self.go("constant", options=self.constant)
        self.check(constant)
        self.check_momentum(constant)
        self.check_same_bits(self.go("flat", options=self.flat), constant, "tables of one value")
        if self.draw.random() < 0.3:
            self.check_stages()

    def check_stages(self):
        """A second stage with twice the loads, turned round."""
        half = STEP * self.steps
        more = ["-stages", "one,two", "-one_time_end", half, "-two_time_end", half]
        for name, value in zip(self.constant[::2], self.constant[1::2]):
            if name.endswith(("_pressure", "_traction")):
                more += [f"-two_{name[1:]}", ",".join(repr(-2 * float(x)) for x in value.split(","))]
        at = self.constant.index("-time_end")
        values = history(self.go("stages", *more, options=self.constant[:at] + self.constant[at + 2:]))
        force = sum(np.abs(values[f"{name}_force_{axis}"]) for name in self.loads for axis in self.axes)
        assert force[-1] > 0, "the second stage has no load"
