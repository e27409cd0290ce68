"""Bodies of revolution: shapes, laws, velocity updates.

A deck has one or two bodies, boxes, discs or polygons at the axis or away from it, of one of five laws, that rest on the ground, fall,
or are pushed by a rigid body of revolution. The sides of the mesh are rollers, fixed, free or absorbing. The mass at the start must be the
density times the volume of the rings of the particles and stay so, no particle may come to the axis, and what falls freely must have the
momentum of its weight. Another back end, strategy and number of ranks must give what the plain loop of one thread gives.
"""
import h5py
import numpy as np

from deck import Deck, Machine, vector
from mpm_regression.folders import frames, history, of_velocities

SPACING, WIDTH, HEIGHT = 0.25, 4.0, 4.0  # m
LAWS = {"linear_elastic": "", "von_mises": "-{0}_su 3000", "tresca": "-{0}_su 2000", "mohr_coulomb": "-{0}_cohesion 2000 -{0}_friction_deg 30",
        "newtonian": "-{0}_bulk_modulus 1e6 -{0}_viscosity 50"}


class Axisymmetric(Deck):
    dims = (2,)
    threads = (1, 2)
    ranks = (1, 1, 2, 3)
    several = others = 0.0  # the first run against the plain loop

    def make(self):
        draw = self.draw
        self.kind = draw.choice(["rests", "falls", "pushed", "pushed"])
        self.gravity = draw.choice([0, 9.81]) if self.kind == "pushed" else 9.81
        names = draw.sample(["core", "cap"], draw.choice([1, 2]))
        laws = [draw.choice(list(LAWS)) for _ in names]
        absorbing = [] if "newtonian" in laws else ["absorbing"]  # which needs a Poisson's ratio
        floor = "free" if self.kind == "falls" else draw.choice(["fixed", "roller", *absorbing])
        update = draw.choice(["flip", "pic", "xpic", "apic"])
        self.options = (f"-geometry axisymmetric -mesh_lower 0,0 -mesh_upper {WIDTH},{HEIGHT} -mesh_spacing {SPACING} -mesh_xmax "
                        f"{draw.choice(['free', 'roller', 'fixed', *absorbing])} -mesh_ymin {floor} -mesh_ymax free -gravity 0,{-self.gravity} "
                        f"-damping {0 if self.kind == 'falls' else draw.choice([0, 0.1])} -time_end 10 -time_max_steps 60 "
                        f"-history_interval 0.005 -output_interval 20 -f_bar_fraction {draw.choice([0, 0.5, 0.98])} "
                        f"-velocity_update {update} -bodies {','.join(names)} -materials {','.join('m_' + name for name in names)}").split()
        self.options += ["-flip_fraction", "0.9"] if update == "flip" and draw.random() < 0.5 and self.kind != "falls" else []
        self.densities, base = {}, 0.0 if self.kind != "falls" else 1.0
        for name, law in zip(names, laws):
            base = self.add(name, law, base)
        if self.kind == "pushed":
            self.push(base, {"von_mises", "tresca"} & set(laws))

    def add(self, name, law, base):
        draw = self.draw
        self.densities[name] = density = draw.uniform(800, 2200)
        words = f"-m_{name}_model {law} -m_{name}_density {density!r} {LAWS[law].format('m_' + name)}"
        if law != "newtonian":
            words += f" -m_{name}_young {10 ** draw.uniform(5.5, 7)!r} -m_{name}_poisson {draw.uniform(0, 0.4)!r}"
        inner = draw.choice([0, 0, 0.5, 1.13])
        outer, top = inner + draw.uniform(1, 2), base + draw.uniform(0.8, 1.3)
        words += f" -{name}_material m_{name} -{name}_particles_per_cell {draw.choice([2, 2, 3])}"
        shape = draw.choice(["box", "disc", "polygon"])
        if shape == "box":
            words += f" -{name}_shape box -{name}_lower {vector([inner, base])} -{name}_upper {vector([outer, top])}"
        elif shape == "disc":
            radius = (top - base) / 2
            centre = 0 if inner == 0 else inner + radius
            words += f" -{name}_shape disc -{name}_centre {vector([centre, base + radius])} -{name}_radius {radius!r}"
        else:
            words += f" -{name}_shape polygon -{name}_polygon {vector([inner, base, outer, base, (inner + outer) / 2, top, inner, top])}"
            words += f" -{name}_fill cut" if draw.random() < 0.3 else ""
        words += f" -{name}_velocity 0,{draw.choice([0.0, -0.5])}" if self.kind != "falls" else ""
        self.options += words.split()
        return np.ceil(top / SPACING) * SPACING

    def push(self, base, clays):
        draw, kind = self.draw, self.draw.choice(["plate", "ball", "weight"])
        self.options += ["-rigid_bodies", "tool"]
        if kind == "ball":
            self.options += f"-tool_shape disc -tool_centre 0,{base + 0.5} -tool_radius 0.5".split()
        else:
            self.options += f"-tool_shape box -tool_lower -0.75,{base} -tool_upper 0.75,{base + 0.5}".split()
        if kind == "weight":
            self.options += "-tool_motion dynamic -tool_density 1500 -tool_force 0,-500 -tool_velocity 0,-0.5".split()
        else:
            self.options += "-tool_motion prescribed -tool_velocity 0,-1".split()
        self.options += draw.choice([[], ["-tool_shear_limit", "1000"], ["-tool_friction", "0.3"], ["-tool_shear_fraction", "0.5"] if clays else []])

    def check(self, folder):
        """Masses, the axis, and the momentum of what falls."""
        values = history(folder)
        for name, density in self.densities.items():
            with h5py.File(frames(folder)[0]) as file:
                mass, volume = (file[name][key][()].astype(float) for key in ("mass", "volume"))
            assert np.abs(mass / (density * volume) - 1).max() < self.bound(1e-12, 1e-5), f"{name}: masses are not density times volume"
            kept = values[f"{name}_mass"] + values[f"{name}_lost_mass"]
            assert np.abs(kept / mass.sum() - 1).max() < self.bound(1e-12, 1e-6), f"{name}: its mass changes"
            with h5py.File(frames(folder)[-1]) as file:
                radius = file[name]["position"][:, 0].astype(float)
            assert radius.min() > 0, f"{name}: a particle is at radius {radius.min()}"
            assert values[f"{name}_xmin"].min() > 0, f"{name}: a particle comes to the axis"
            assert np.isfinite(values[f"{name}_kinetic_energy"]).all(), f"{name}: its energy is not finite"
        if self.kind == "falls":
            momentum, mass = (sum(values[f"{name}_{what}"] for name in self.densities) for what in ("momentum_y", "mass"))
            moved = of_velocities(values["time"], values["dt"])
            error = np.abs(momentum + mass * self.gravity * moved).max() / (mass[0] * self.gravity * values["time"][-1])
            assert error < self.bound(1e-10, 1e-4), f"the momentum of the fall is {error:.3g} off"

    def compare(self, whole):
        """Histories, relative to the largest value of each column; forces also to a thousandth of the weight."""
        plain = self.go("plain", machine=Machine("serial", "sequential"))
        self.check(plain)
        if not self.exact:
            return
        a, b = history(plain), history(whole)
        weight = 9.81 * sum(a[f"{name}_mass"][0] for name in self.densities)
        for name in a:
            if name.endswith(("_strays", "_limited", "_put_back")):
                continue
            scale = max(np.abs(a[name]).max(), 1e-9, 1e-3 * weight if "_force_" in name else 0)
            if name.endswith(("_x", "_y")):  # of a vector
                scale = max(scale, *(np.abs(a[name[:-1] + axis]).max() for axis in "xy"))
            count = min(len(a[name]), len(b[name]))
            error = np.abs(a[name][:count] - b[name][:count]).max() / scale
            assert error < 1e-6, f"{name} is {error:.3g} of its largest value off"
