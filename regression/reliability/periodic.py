#!/usr/bin/env python3
"""Random soil in periodic meshes: it moves alike wherever the mesh begins.

    periodic.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]
                    [--backends serial,openmp]

A deck has boxes of soil with random velocities in a mesh that is periodic along one axis or several, with random sides along
the others, of one to three patches. A second run has the soil shifted by whole cells round the periods, another strategy and
partition, and 1 to 4 ranks: ways, velocities and stresses must be the same to round-off. A run that is cut in two by a checkpoint must
give the same bits. Where nothing acts along a periodic axis but gravity, the momentum must be what gravity has made of it.
"""
import pathlib
import sys

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
import particles  # noqa: E402
from folders import checkpoints, differences, frames, fresh, of_velocities, rows, run  # noqa: E402
from random_decks import draws_of, read_arguments  # noqa: E402

SPACING, DENSITY, YOUNG = 0.25, 1500.0, 1e6  # m, kg/m3, Pa: powers of two and sums of them keep their bits
RESOLUTION = 2.0**-12  # cells, so that a shift rounds nothing, in single precision too
LAWS = {"linear_elastic": f"-clay_young {YOUNG} -clay_poisson 0.3", "von_mises": f"-clay_young {YOUNG} -clay_poisson 0.3 -clay_su 2000",
        "mohr_coulomb": f"-clay_young {YOUNG} -clay_poisson 0.3 -clay_cohesion 500 -clay_friction_deg 30",
        "newtonian": "-clay_bulk_modulus 1e6 -clay_viscosity 20"}
TOLERANCE = {"double": 1e-9, "single": 0.1}  # of the largest value; yield and friction amplify round-off


def vector(values):
    return ",".join(repr(float(x)) for x in values)


class Deck:
    def __init__(self, draw, dim):
        self.draw, self.dim = draw, dim
        edge, up = (8, 4)[dim - 2], dim - 1
        self.periodic = [d == 0 for d in range(dim)]
        for d in range(1, dim):
            self.periodic[d] = draw.random() < (0.2 if d == up else 0.5)
        self.cells = [edge * draw.randint(1, 3) if p else draw.randint(5, 14 if dim == 2 else 8) for p in self.periodic]
        self.lower = [SPACING * draw.randint(-9, 9) for _ in range(dim)]
        self.law = draw.choice(list(LAWS))
        gravity = [draw.choice([0.0, draw.uniform(-2, 2)]) if p else 0.0 for p in self.periodic]
        if not self.periodic[up]:
            gravity[up] = -9.81
        self.gravity = np.array(gravity)
        upper = [x + n * SPACING for x, n in zip(self.lower, self.cells)]
        self.acts = False  # something along a periodic axis beside gravity
        self.options = (f"-dim {dim} -mesh_lower {vector(self.lower)} -mesh_upper {vector(upper)} -mesh_spacing {SPACING} "
                        f"-gravity {vector(gravity)} -materials clay -clay_model {self.law} -clay_density {DENSITY} {LAWS[self.law]} "
                        f"-bodies soil -soil_material clay -soil_shape particles -time_courant 0.3 "
                        f"-f_bar_fraction {draw.choice(['0', '0.98'])} -particle_domain {draw.choice(['fixed', 'fixed', 'stretch', 'split'])} "
                        f"-velocity_update {draw.choice(['flip', 'flip', 'apic', 'xpic'])} -damping {draw.choice(['0', '0', '0.1'])}").split()
        self.acts = self.options[-1] != "0"
        for d in range(dim):
            for side in ("min", "max"):
                self.options += self.side(f"mesh_{'xyz'[d]}{side}", d)
        self.base = 0
        if not self.periodic[up] and draw.random() < 0.3:
            self.add_base(up)
        if not self.periodic[up] and draw.random() < 0.2 and not np.any(self.gravity[:up]) and "absorbing" not in self.options:
            self.options += ["-water_level", self.lower[up] + draw.uniform(0, self.cells[up]) * SPACING]
        self.fill()

    def side(self, name, d):
        if self.periodic[d]:
            return ["-" + name, "periodic"]
        kinds = ["roller", "roller", "fixed", "free", "friction"] + (["absorbing"] if self.law != "newtonian" else [])
        kind = self.draw.choice(kinds)
        self.acts = self.acts or kind != "roller"
        return ["-" + name, kind] + ([f"-{name}_friction", "0.3"] if kind == "friction" else [])

    def add_base(self, up):
        """A rigid that goes through the mesh, under the soil, at rest or moving along it."""
        self.base, self.acts = 1, True
        along = [self.draw.uniform(-2, 2) if p else 0.0 for p in self.periodic]
        top = self.lower[up] + SPACING
        self.options += ["-rigid_bodies", "base"] + self.draw.choice([[], ["-base_friction", "0.4"], ["-base_shear_limit", "800"]])
        if self.draw.random() < 0.5:
            self.options += f"-base_shape half_plane -base_point {vector([*self.lower[:up], top])} -base_normal {vector([0.0] * up + [1.0])}".split()
        else:
            upper = [x + n * SPACING for x, n in zip(self.lower, self.cells)]
            self.options += f"-base_shape box -base_lower {vector(self.lower)} -base_upper {vector([*upper[:up], top])}".split()
        if self.draw.random() < 0.5:
            self.options += ["-base_motion", "prescribed", "-base_velocity", vector(along)]

    def fill(self):
        """Boxes of whole cells of soil, by coordinates in cells of the mesh."""
        draw, dim = self.draw, self.dim
        filled = set()
        per_cell = draw.choice([1, 2, 2, 3] if dim == 2 else [1, 2])
        for _ in range(draw.randint(1, 3)):
            size = [draw.randint(2, n if p else max(2, n // 2)) for n, p in zip(self.cells, self.periodic)]
            first = [draw.randint(0, n - 1) if p else draw.randint(0, max(0, n - s)) for n, s, p in zip(self.cells, size, self.periodic)]
            if self.base:
                first[-1] = max(first[-1], 1)
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

    def write(self, path, shift):
        place = self.place + shift
        place = np.where(self.periodic, np.mod(place, self.cells), place)
        particles.write(path, "soil", np.array(self.lower) + SPACING * place, self.width, velocity=self.velocity, stress=self.stress)

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


def check_alike(deck, one, other, shift, tolerance):
    a, b = deck.state(one), deck.state(other)
    assert a["position"].shape == b["position"].shape, f"{len(a['position'])} and {len(b['position'])} particles"
    turns = np.where(deck.periodic, np.floor((deck.place + shift) / deck.cells), 0) * deck.cells * SPACING
    if len(a["position"]) == len(deck.place):  # none was split, merged or lost
        way = np.abs(a["position"] - deck.lower - SPACING * deck.place).max() + SPACING
        b["position"] = b["position"] - np.array(shift) * SPACING + turns
        worst = {"position": np.abs(a["position"] - b["position"]).max() / way}
    else:
        worst = {}
    for name in ("velocity", "stress"):
        worst[name] = np.abs(a[name] - b[name]).max() / max(np.abs(a[name]).max(), 1e-300)
    assert all(error < tolerance for error in worst.values()), f"shifted by {shift}: apart by {worst}"
    return worst


def check_momentum(deck, folder, precision):
    lines = rows(folder)
    values = {name: np.array([float(line[k]) for line in lines[1:]]) for k, name in enumerate(lines[0])}
    scale = values["soil_mass"][0] * (np.abs(deck.velocity).max() + 10 * values["time"][-1])
    for d, periodic in enumerate(deck.periodic):
        if not periodic:
            continue
        axis = "xyz"[d]
        momentum, moved = values[f"soil_momentum_{axis}"], of_velocities(values["time"], values["dt"])
        error = np.abs(momentum - momentum[0] - values["soil_mass"] * deck.gravity[d] * moved).max() / scale
        assert error < (1e-11 if precision == "double" else 1e-4), f"the momentum along {axis} is {error:.3g} off"
        centre = values[f"soil_centre_{axis}"]
        jump = np.abs(np.diff(centre)).max()
        assert jump < 4 * SPACING, f"the centre along {axis} jumps by {jump:.3g} m"


def check_cut(binary, empty, base, options, whole, draw, prefix):
    cut = fresh(base / "cut")
    step = int(rows(whole)[-1][0])
    at = draw.randint(1, step - 1)
    run(binary, empty, cut, *options, "-time_max_steps", at, "-checkpoint_interval", 1e3, prefix=prefix)
    run(binary, empty, cut, *options, "-restart", checkpoints(cut)[-1], prefix=prefix)
    mine, theirs = rows(cut), rows(whole)
    kept = [line for line in mine if line in theirs]
    assert kept == theirs, f"cut at step {at} of {step}: {len(theirs) - len(kept)} rows differ"
    assert not [f for f in differences(cut, whole) if "history" not in f], f"cut at step {at} of {step}: frames differ"


def main():
    given, base = read_arguments(__doc__, "periodic", backends="serial,openmp")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    strategies = ["sequential", "atomic", "mosaic", "gather", "tile"]
    largest = {"double": 0.0, "single": 0.0}
    for number in range(given.count):
        draw = draws_of(given, number)
        deck = Deck(draw, int(draw.choice(given.dims.split(","))))
        precision = draw.choice(given.precisions.split(","))
        shift = [draw.randrange(n) if p else 0 for n, p in zip(deck.cells, deck.periodic)]
        paths = [base / "start.h5", base / "shifted.h5"]
        deck.write(paths[0], [0] * deck.dim), deck.write(paths[1], shift)
        ranks = draw.randint(1, 4)
        common = deck.options + ["-precision", precision, "-time_end", "0.25", "-output_interval", "0.125", "-history_interval", "0.01"]
        first = common + ["-soil_file", paths[0], "-backend", given.backends.split(",")[0], "-p2g", draw.choice(strategies)]
        second = common + ["-soil_file", paths[1], "-backend", draw.choice(given.backends.split(",")), "-p2g", draw.choice(["gather", "tile", "mosaic", "sequential"]),
                           "-partition", draw.choice(["box", "metis"])]
        prefix = ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()
        try:
            one, other = fresh(base / "one"), fresh(base / "other")
            run(binary, empty, one, *first)
            run(binary, empty, other, *second, prefix=prefix)
            worst = check_alike(deck, one, other, shift, TOLERANCE[precision])
            largest[precision] = max(largest[precision], *worst.values())
            if not deck.acts:
                check_momentum(deck, one, precision), check_momentum(deck, other, precision)
            if "metis" not in second:  # whose parts follow the clock
                check_cut(binary, empty, base, second, other, draw, prefix)
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, first))}\n\n{' '.join(map(str, (*prefix, *second)))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: soil that is shifted round the periods moves alike, at most {largest['double']:.2g} apart (single {largest['single']:.2g}); "
          "cut runs give the same bits")


main()
