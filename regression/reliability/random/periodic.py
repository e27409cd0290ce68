"""Soil in periodic meshes: it moves alike wherever the mesh begins.

A deck has boxes of soil with random velocities in a mesh that is periodic along one axis or several, with random sides along
the others, of one to three patches. A second run has the soil shifted by whole cells round the periods, another strategy and
partition, and 1 to 4 ranks: ways, velocities and stresses must be the same to round-off. Where nothing acts along a periodic axis but
gravity, the momentum must be what gravity has made of it.
"""
import dataclasses

import h5py
import numpy as np

from deck import Deck, check_impulse, vector
from mpm_regression import particles
from mpm_regression.folders import frames, history, of_velocities

SPACING, DENSITY, YOUNG = 0.25, 1500.0, 1e6  # m, kg/m3, Pa: powers of two and sums of them keep their bits
RESOLUTION = 2.0**-12  # cells, so that a shift rounds nothing, in single precision too
LAWS = {"linear_elastic": f"-clay_young {YOUNG} -clay_poisson 0.3", "von_mises": f"-clay_young {YOUNG} -clay_poisson 0.3 -clay_su 2000",
        "mohr_coulomb": f"-clay_young {YOUNG} -clay_poisson 0.3 -clay_cohesion 500 -clay_friction_deg 30",
        "newtonian": "-clay_bulk_modulus 1e6 -clay_viscosity 20"}
TOLERANCE = {"double": 1e-9, "single": 0.1}  # of the largest value; yield and friction amplify round-off


class Periodic(Deck):
    restarts, several, others = 0.2, 0.0, 0.0  # as the shifted run has them

    def make(self):
        draw, dim = self.draw, self.dim
        edge, top = (8, 4)[dim - 2], dim - 1
        self.periodic = [d == 0 or draw.random() < (0.2 if d == top else 0.5) for d in range(dim)]
        self.cells = [edge * draw.randint(1, 3) if p else draw.randint(5, 14 if dim == 2 else 8) for p in self.periodic]
        self.lower = [SPACING * draw.randint(-9, 9) for _ in range(dim)]
        self.law = draw.choice(list(LAWS))
        self.gravity = np.array([draw.choice([0.0, draw.uniform(-2, 2)]) if p else 0.0 for p in self.periodic])
        if not self.periodic[top]:
            self.gravity[top] = -9.81
        upper = [x + n * SPACING for x, n in zip(self.lower, self.cells)]
        self.options = (f"-dim {dim} -mesh_lower {vector(self.lower)} -mesh_upper {vector(upper)} -mesh_spacing {SPACING} "
                        f"-gravity {vector(self.gravity)} -materials clay -clay_model {self.law} -clay_density {DENSITY} {LAWS[self.law]} "
                        f"-bodies soil -soil_material clay -soil_shape particles -time_courant 0.3 -time_end 0.25 -output_interval 0.125 "
                        f"-history_interval 0.01 -f_bar_fraction {draw.choice(['0', '0.98'])} "
                        f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch', 'split'])} "
                        f"-velocity_update {draw.choice(['flip', 'flip', 'apic', 'xpic'])} -damping {draw.choice(['0', '0', '0.1'])}").split()
        self.acts = self.options[-1] != "0"  # something along a periodic axis beside gravity
        for d in range(dim):
            for side in ("min", "max"):
                self.options += self.side(f"mesh_{'xyz'[d]}{side}", d)
        based = not self.periodic[top] and draw.random() < 0.3
        if based:
            self.add_base(upper)
        if not self.periodic[top] and draw.random() < 0.2 and not np.any(self.gravity[:top]) and "absorbing" not in self.options:
            self.options += ["-water_level", self.lower[top] + draw.uniform(0, self.cells[top]) * SPACING]
        self.fill(based)
        self.options += ["-soil_file", self.write("start.h5", [0] * dim)]

    def side(self, name, d):
        if self.periodic[d]:
            return ["-" + name, "periodic"]
        kinds = ["roller", "roller", "fixed", "free", "friction"] + (["absorbing"] if self.law != "newtonian" else [])
        kind = self.draw.choice(kinds)
        self.acts = self.acts or kind != "roller"
        return ["-" + name, kind] + ([f"-{name}_friction", "0.3"] if kind == "friction" else [])

    def add_base(self, upper):
        """A rigid that goes through the mesh, under the soil, at rest or moving along it."""
        self.acts = True
        along = [self.draw.uniform(-2, 2) if p else 0.0 for p in self.periodic]
        top = self.lower[-1] + SPACING
        self.options += ["-rigid_bodies", "base"] + self.draw.choice([[], ["-base_friction", "0.4"], ["-base_shear_limit", "800"]])
        if self.draw.random() < 0.5:
            normal = vector([0.0] * (self.dim - 1) + [1.0])
            self.options += f"-base_shape half_plane -base_point {vector([*self.lower[:-1], top])} -base_normal {normal}".split()
        else:
            self.options += f"-base_shape box -base_lower {vector(self.lower)} -base_upper {vector([*upper[:-1], top])}".split()
        if self.draw.random() < 0.5:
            self.options += ["-base_motion", "prescribed", "-base_velocity", vector(along)]

    def fill(self, based):
        """Boxes of whole cells of soil, by coordinates in cells of the mesh."""
        draw, dim, filled = self.draw, self.dim, set()
        per_cell = draw.choice([1, 2, 2, 3] if dim == 2 else [1, 2])
        for _ in range(draw.randint(1, 3)):
            size = [draw.randint(2, n if p else max(2, n // 2)) for n, p in zip(self.cells, self.periodic)]
            first = [draw.randint(0, n - 1) if p else draw.randint(0, max(0, n - s)) for n, s, p in zip(self.cells, size, self.periodic)]
            first[-1] = max(first[-1], int(based))
            for cell in np.ndindex(*size):
                place = tuple((f + c) % n if p else f + c for f, c, n, p in zip(first, cell, self.cells, self.periodic))
                if all(0 <= x < n for x, n in zip(place, self.cells)):
                    filled.add(place)
        offsets = (np.stack(np.meshgrid(*[np.arange(per_cell)] * dim, indexing="ij"), -1).reshape(-1, dim) + 0.5) / per_cell
        self.place = np.concatenate([np.array(cell) + offsets for cell in sorted(filled)])
        dice = np.random.default_rng(draw.randint(0, 10**6))
        self.place = np.floor((self.place + dice.uniform(-0.05, 0.05, self.place.shape)) / RESOLUTION) * RESOLUTION
        mean = [draw.uniform(-6, 6) if p else 0.0 for p in self.periodic]
        self.velocity = dice.uniform(-1, 1, self.place.shape) * draw.choice([0, 0.3, 1]) + mean
        self.stress = np.zeros((len(self.place), 6))
        self.stress[:, :3] = dice.uniform(-500, 0, len(self.place))[:, None]
        self.width = SPACING / per_cell
        self.options += ["-soil_particles_per_cell", per_cell]

    def write(self, name, shift):
        place = self.place + shift
        place = np.where(self.periodic, np.mod(place, self.cells), place)
        particles.write(self.folder / name, "soil", np.array(self.lower) + SPACING * place, self.width, velocity=self.velocity,
                        stress=self.stress)
        return self.folder / name

    def state(self, folder):
        """Ways, velocities and stresses of the last frame."""
        with h5py.File(frames(folder)[-1]) as file:
            group = file["soil"]
            place = group["position"][()][:, :self.dim]
            for d, periodic in enumerate(self.periodic):
                if periodic:
                    inside = (place[:, d] >= self.lower[d]) & (place[:, d] <= self.lower[d] + self.cells[d] * SPACING)
                    assert inside.all(), f"{(~inside).sum()} particles are outside the mesh along {'xyz'[d]}"
                    place[:, d] += group[f"periods_{'xyz'[d]}"][()] * self.cells[d] * SPACING
            return {"position": place, "velocity": group["velocity"][()], "stress": group["stress"][()]}

    def check(self, folder):
        """The momentum that gravity gives along a periodic axis, where nothing else acts."""
        values = history(folder)
        mass, moved = values["soil_mass"], of_velocities(values["time"], values["dt"])
        scale = mass[0] * (np.abs(self.velocity).max() + 10 * values["time"][-1])
        for d, axis in enumerate(self.axes):
            if not self.acts and self.periodic[d]:
                gained = (mass * self.gravity[d] * moved)[1:]
                check_impulse(values[f"soil_momentum_{axis}"], gained, scale, self.bound(1e-11, 1e-4), axis)
                jump = np.abs(np.diff(values[f"soil_centre_{axis}"])).max()
                assert jump < 4 * SPACING, f"the centre along {axis} jumps by {jump:.3g} m"

    def compare(self, whole):
        shift = [self.draw.randrange(n) if p else 0 for n, p in zip(self.cells, self.periodic)]
        machine = dataclasses.replace(self.draw_machine((1, 2, 3, 4)), partition=self.draw.choice(["box", "metis"]))
        shifted = [*self.options[:-1], self.write("shifted.h5", shift)]
        other = self.go("other", options=shifted, machine=machine)
        self.check(other)
        self.check_alike(whole, other, shift)
        if machine.gives_same_bits():
            self.check_cut(other, machine, options=shifted)

    def check_alike(self, one, other, shift):
        a, b = self.state(one), self.state(other)
        assert a["position"].shape == b["position"].shape, f"{len(a['position'])} and {len(b['position'])} particles"
        worst = {name: np.abs(a[name] - b[name]).max() / max(np.abs(a[name]).max(), 1e-300) for name in ("velocity", "stress")}
        if len(a["position"]) == len(self.place):  # none was split, merged or lost
            turns = np.where(self.periodic, np.floor((self.place + shift) / self.cells), 0) * self.cells * SPACING
            way = np.abs(a["position"] - self.lower - SPACING * self.place).max() + SPACING
            worst["position"] = np.abs(a["position"] - b["position"] + np.array(shift) * SPACING - turns).max() / way
        self.note(f"difference of shifted soil, {self.precision}", max(worst.values()))
        assert all(error < TOLERANCE[self.precision] for error in worst.values()), f"shifted by {shift}: apart by {worst}"
