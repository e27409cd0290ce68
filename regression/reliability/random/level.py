"""Level ground with the stress k0: layers of several laws under a level of water must stay at rest.

A deck has one to five layers, boxes or layers between levels, whose boundaries lie on edges of particles, with one to four particles a
cell in each direction, a level of water anywhere or none, drained or undrained. In 200 steps no node may reach 1e-9 of the speed of the
waves (1e-6 in single precision), and the stresses must be those of the formula at every particle.
"""
import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.folders import frames, history


class Level(Deck):
    strategies = ("tile", "tile", "sequential", "atomic", "mosaic", "gather")
    ranks = (1, 1, 2, 3)
    restarts, several, others = 0.2, 0.0, 0.0  # the speeds that ranks and strategies would agree on are round-off

    def make(self):
        draw, dim = self.draw, self.dim
        self.spacing, self.per_cell = 0.5, draw.randint(1, 4)
        self.gravity = draw.choice([9.81, 10.0, 30.0])
        self.size = self.spacing / self.per_cell
        thickness = [draw.randint(1, 7 if dim == 2 else 4) * self.size for _ in range(draw.randint(1, 5))]
        thickness[0] += 2 * self.spacing  # particles of a film thinner than a cell count as alone
        self.levels = np.concatenate([[0], np.cumsum(thickness)])
        top = self.spacing * np.ceil(self.levels[-1] / self.spacing + 1)
        plan = [1.0] if dim == 2 else [1.0, 0.5]
        names = [f"layer{k}" for k in range(len(thickness))]
        self.water = draw.choice([None, draw.uniform(-1, top + 2), draw.uniform(0, self.levels[-1])])
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector([*plan, top])} -mesh_spacing {self.spacing} "
                        f"-mesh_{self.up}min fixed -mesh_{self.up}max free -gravity {vector([0] * (dim - 1) + [-self.gravity])} "
                        f"-time_end 100 -time_max_steps 200 -output_interval 100 -history_interval 0.001 -bodies {','.join(names)} "
                        f"-materials {','.join('m_' + name for name in names)} -output_frames on").split()
        if self.water is not None:
            self.options += ["-water_level", repr(self.water)]
        self.layers, self.speed = [], np.inf
        for name, low, high in zip(names, self.levels, self.levels[1:]):
            self.add(name, plan, low, high)

    def add(self, name, plan, low, high):
        draw = self.draw
        density, young, poisson = draw.uniform(1500, 2400), 10**draw.uniform(6.5, 8), draw.uniform(0.1, 0.4)
        law = draw.choice(["linear_elastic", "mohr_coulomb", "drucker_prager"])
        words = [f"-m_{name}_model", law, f"-m_{name}_density", density, f"-m_{name}_young", young, f"-m_{name}_poisson", poisson]
        ratio = poisson / (1 - poisson)
        if law != "linear_elastic":
            friction = draw.uniform(20, 40)
            words += [f"-m_{name}_cohesion", draw.choice([0, 1e3]), f"-m_{name}_friction_deg", friction]
            ratio = 1 - np.sin(np.radians(friction))
            words += [f"-m_{name}_match", "compression"] if law == "drucker_prager" else []
        elif draw.random() < 0.5:
            ratio = draw.uniform(0.2, 1.5)
            words += [f"-m_{name}_k0", ratio]
        if self.water is not None and draw.random() < 0.3:
            words += [f"-m_{name}_pore_stiffness", 1e8]
        if draw.random() < 0.5:
            words += [f"-{name}_shape", "box", f"-{name}_lower", vector([0] * (self.dim - 1) + [low]), f"-{name}_upper", vector([*plan, high])]
        else:
            words += [f"-{name}_shape", "layer", f"-{name}_base", repr(float(low)), f"-{name}_top", repr(float(high))]
        words += [f"-{name}_material", f"m_{name}", f"-{name}_particles_per_cell", self.per_cell, f"-{name}_stress", "k0"]
        self.options += map(str, words)
        self.layers.append((name, density, ratio))
        self.speed = min(self.speed, np.sqrt(young / density))

    def vertical(self, z):
        """Effective vertical stress, compression positive."""
        total = np.zeros_like(z)
        for (_, density, _), low, high in zip(self.layers, self.levels, self.levels[1:]):
            start = np.maximum(z, low)
            total += self.gravity * density * np.maximum(0, high - start)
            if self.water is not None:
                total -= self.gravity * 1000 * np.maximum(0, np.minimum(high, self.water) - start)
        return total

    def check(self, folder):
        values = history(folder)
        for name, _, ratio in self.layers:
            speed = values[f"{name}_grid_velocity"].max()
            assert speed < self.bound(1e-9, 1e-6) * self.speed, f"{name} moves at {speed:.3g} m/s, waves at {self.speed:.3g}"
            with h5py.File(frames(folder)[0]) as file:
                z = file[name]["position"][:, self.dim - 1].astype(float)
                stress = file[name]["stress"][()].astype(float)
                pore = file[name]["pore_pressure"][()].astype(float) if "pore_pressure" in file[name] else np.zeros(len(z))
            down = (self.vertical(z - self.size / 2) + self.vertical(z + self.size / 2)) / 2
            scale = max(np.abs(down).max(), np.abs(pore).max(), 1)
            for component in range(3):
                expected = -(1 if component == self.dim - 1 else ratio) * down
                error = np.abs(stress[:, component] + pore - expected).max() / scale
                assert error < self.bound(1e-12, 1e-6), f"{name}: stress {component} is {error:.3g} off"
