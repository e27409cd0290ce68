#!/usr/bin/env python3
"""Random bodies of revolution: shapes, laws, velocity updates, strategies, back ends, precisions and ranks.

    axisymmetric.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--precisions double,single] [--ranks 1,1,2,3]

A deck has one or two bodies, boxes, discs or polygons at the axis or away from it, of one of five laws, that rest on the ground, fall,
or are pushed by a rigid body of revolution. The sides of the mesh are rollers, fixed, free or absorbing. The mass at the start must be the
density times the volume of the rings of the particles and stay so, no particle may come to the axis, and what falls freely must have the momentum of its weight. A run on one back end by one strategy and some ranks must
give what the plain loop of one thread gives, and a run that is cut in two by a checkpoint the same bits as the whole one.
"""
import sys

import h5py
import numpy as np

from folders import checkpoints, differences, frames, fresh, rows, run
from random_decks import draws_of, read_arguments

SPACING, WIDTH, HEIGHT = 0.25, 4.0, 4.0  # m
LAWS = {
    "linear_elastic": "",
    "von_mises": "-{0}_su 3000",
    "tresca": "-{0}_su 2000",
    "mohr_coulomb": "-{0}_cohesion 2000 -{0}_friction_deg 30",
    "newtonian": "-{0}_bulk_modulus 1e6 -{0}_viscosity 50",
}


def vector(values):
    return ",".join(repr(float(x)) for x in values)


class Deck:
    def __init__(self, draw):
        self.kind = draw.choice(["rests", "falls", "pushed", "pushed"])
        self.gravity = draw.choice([0, 9.81]) if self.kind == "pushed" else 9.81
        names = draw.sample(["core", "cap"], draw.choice([1, 2]))
        laws = [draw.choice(list(LAWS)) for _ in names]
        absorbing = [] if "newtonian" in laws else ["absorbing"]  # which needs a Poisson's ratio
        floor = "free" if self.kind == "falls" else draw.choice(["fixed", "roller", *absorbing])
        self.options = (f"-geometry axisymmetric -mesh_lower 0,0 -mesh_upper {WIDTH},{HEIGHT} -mesh_spacing {SPACING} -mesh_xmax "
                        f"{draw.choice(['free', 'roller', 'fixed', *absorbing])} -mesh_ymin {floor} -mesh_ymax free -gravity 0,{-self.gravity} "
                        f"-damping {0 if self.kind == 'falls' else draw.choice([0, 0.1])} -time_end 10 -time_max_steps 60 "
                        "-history_interval 0.005 -output_interval 20 -checkpoint_interval 0.01 "
                        f"-f_bar_fraction {draw.choice([0, 0.5, 0.98])}").split()
        update = draw.choice(["flip", "pic", "xpic", "apic"])
        self.options += ["-velocity_update", update]
        self.options += ["-flip_fraction", "0.9"] if update == "flip" and draw.random() < 0.5 and self.kind != "falls" else []
        self.densities = {}
        base = 0.0 if self.kind != "falls" else 1.0
        for name, law in zip(names, laws):
            base = self.add(draw, name, law, base)
        self.options += ["-bodies", ",".join(names), "-materials", ",".join(f"m_{name}" for name in names)]
        if self.kind == "pushed":
            self.push(draw, base, {"von_mises", "tresca"} & set(laws))

    def add(self, draw, name, law, base):
        density = draw.uniform(800, 2200)
        self.densities[name] = density
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
        words += f" -{name}_fill cut" if shape == "polygon" and draw.random() < 0.3 else ""
        words += f" -{name}_velocity 0,{draw.choice([0.0, -0.5])}" if self.kind != "falls" else ""
        self.options += words.split()
        return np.ceil(top / SPACING) * SPACING

    def push(self, draw, base, clays):
        self.options += ["-rigid_bodies", "tool"]
        kind = draw.choice(["plate", "ball", "weight"])
        if kind == "ball":
            self.options += f"-tool_shape disc -tool_centre 0,{base + 0.5} -tool_radius 0.5".split()
        else:
            self.options += f"-tool_shape box -tool_lower -0.75,{base} -tool_upper 0.75,{base + 0.5}".split()
        if kind == "weight":
            self.options += "-tool_motion dynamic -tool_density 1500 -tool_force 0,-500 -tool_velocity 0,-0.5".split()
        else:
            self.options += "-tool_motion prescribed -tool_velocity 0,-1".split()
        self.options += draw.choice([[], ["-tool_shear_limit", "1000"], ["-tool_friction", "0.3"],
                                     ["-tool_shear_fraction", "0.5"] if clays else []])


def table(folder):
    lines = rows(folder)
    return {name: np.array([float(line[k]) for line in lines[1:]]) for k, name in enumerate(lines[0])}


def check_rings(deck, folder, exact):
    """Masses, the axis, and the momentum of what falls."""
    history, tolerance = table(folder), 1e-12 if exact else 1e-6
    first, last = frames(folder)[0], frames(folder)[-1]
    for name, density in deck.densities.items():
        with h5py.File(first) as file:
            mass, volume = (file[name][key][()].astype(float) for key in ("mass", "volume"))
        assert np.abs(mass / (density * volume) - 1).max() < (1e-12 if exact else 1e-5), f"{name}: masses are not density times volume"
        kept = history[f"{name}_mass"] + history[f"{name}_lost_mass"]
        assert np.abs(kept / mass.sum() - 1).max() < tolerance, f"{name}: its mass changes"
        with h5py.File(last) as file:
            radius = file[name]["position"][:, 0].astype(float)
        assert radius.min() > 0, f"{name}: a particle is at radius {radius.min()}"
        assert history[f"{name}_xmin"].min() > 0, f"{name}: a particle comes to the axis"
        assert np.isfinite(history[f"{name}_kinetic_energy"]).all()
    if deck.kind == "falls":
        momentum = sum(history[f"{name}_momentum_y"] for name in deck.densities)
        mass = sum(history[f"{name}_mass"] for name in deck.densities)
        error = np.abs(momentum + mass * deck.gravity * history["time"]).max() / (mass[0] * deck.gravity * history["time"][-1])
        assert error < (1e-10 if exact else 1e-4), f"the momentum of the fall is {error:.3g} off"


def check_same(deck, one, other, exact):
    """Histories of two runs, relative to the largest value of each column; forces also to a thousandth of the weight."""
    a, b = table(one), table(other)
    weight = 9.81 * sum(a[f"{name}_mass"][0] for name in deck.densities)
    for name in a:
        if name.endswith(("_strays", "_limited", "_put_back")):
            continue
        scale = max(np.abs(a[name]).max(), 1e-9)
        if "_force_" in name:
            scale = max(scale, 1e-3 * weight)
        if name.endswith(("_x", "_y")):  # of a vector
            scale = max(scale, *(np.abs(a[name[:-1] + axis]).max() for axis in "xy"))
        count = min(len(a[name]), len(b[name]))
        error = np.abs(a[name][:count] - b[name][:count]).max() / scale
        assert error < (1e-6 if exact else 0.1), f"{name} is {error:.3g} of its largest value off"


def main():
    given, base = read_arguments(__doc__, "axisymmetric", ranks="1,1,2,3")
    empty = base / "empty.opts"
    empty.write_text("\n")
    for number in range(given.count):
        draw = draws_of(given, number)
        deck = Deck(draw)
        precision, ranks = draw.choice(given.precisions.split(",")), int(draw.choice(given.ranks.split(",")))
        how = ["-backend", draw.choice(["serial", "openmp"]), "-p2g", draw.choice(["tile", "gather", "atomic", "mosaic", "sequential"])]
        prefix = ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()
        options, exact = [*deck.options, "-precision", precision], precision == "double"
        try:
            plain, other, again = (fresh(base / name) for name in ("plain", "other", "again"))
            run(given.binary, empty, plain, *options, "-backend", "serial", "-p2g", "sequential")
            check_rings(deck, plain, exact)
            run(given.binary, empty, other, *options, *how, prefix=prefix, environment={"OMP_NUM_THREADS": "2" if ranks == 1 else "1"})
            check_rings(deck, other, exact)
            if exact:
                check_same(deck, plain, other, exact)
            if ranks == 1 and "openmp" not in how and "atomic" not in how:
                run(given.binary, empty, again, *options, *how, "-time_max_steps", 30)
                run(given.binary, empty, again, *options, *how, "-restart", checkpoints(again)[-1])
                found = differences(other, again)
                assert not found, f"a restarted run differs: {found[:5]}"
        except AssertionError as error:
            sys.exit(f"deck {number} of seed {given.seed}, {ranks} ranks: {str(error)[-1500:]}\n{' '.join([*options, *how])}")
    print(f"{given.count} decks: bodies of revolution keep their mass and stay off the axis, whatever computes them")


main()
