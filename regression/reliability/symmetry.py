#!/usr/bin/env python3
"""Random contact problems that are symmetric: the whole against the half or quarter that planes of symmetry leave.

    symmetry.py MPM [--count 60] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single] [--backends serial,openmp]

A rigid body of a random shape moves along the vertical plane or line of symmetry of soil under it or around it, by a velocity or by its
weight. Rollers cut the problem to a half, or in 3D to a half or a quarter. Force and motion of the body on this part must be those of the
whole, to round-off, and the whole must have no force across, also where several faces of the body are equally near to a node. In a quarter
of the decks two ranks must give the same as one.
"""
import sys

import numpy as np

from folders import fresh, rows, run
from random_decks import draws_of, read_arguments

SPACING = 0.125
STEPS = {"double": 60, "single": 20}
TOLERANCE = {"double": 1e-5, "single": 5e-3}  # of the largest force; steps of contact amplify round-off


def vector(values):
    return ",".join(repr(round(float(x), 6)) for x in values)


class Deck:
    def __init__(self, draw, dim, precision):
        self.dim, self.cuts = dim, 1 if dim == 2 else draw.choice([1, 2])
        self.half = 1.0 if dim == 2 else 0.75
        self.options = (f"-dim {dim} -mesh_spacing {SPACING} -materials clay -clay_density 1800 -clay_poisson 0.3 -clay_young 2e6 "
                        f"-clay_model {draw.choice(['linear_elastic', 'von_mises -clay_su 4e3', 'tresca -clay_su 4e3 -clay_su_gradient 2e3'])} "
                        f"-bodies soil -soil_material clay -soil_shape box -soil_particles_per_cell {draw.choice([2, 3]) if dim == 2 else 2} "
                        f"-rigid_bodies tool -time_max_steps {STEPS[precision]} -time_end 9 -history_interval 1e-9 -output_interval 9").split()
        self.weighs = draw.random() < 0.3 and precision == "double"  # in single precision the whole drifts aside by round-off
        self.add_shape(draw)
        self.weighs = self.weighs and self.kind not in ("wedge", "diamond", "prism")  # the plane does not hold a polygon that ends there
        self.add_motion(draw)
        self.add_interface(draw)
        self.options += ["-velocity_update", draw.choice(["flip", "flip", "apic"]), "-damping", draw.choice(["0", "0", "0.05"])]

    def add_shape(self, draw):
        dim, middle = self.dim, [0.0] * (self.dim - 1)
        self.kind = draw.choice(["box", "plate", "disc", "wedge", "diamond"] if dim == 2 else ["box", "plate", "ball", "pile", "cone", "prism"])
        place = draw.choice([0.0, -0.25, draw.uniform(-0.4, 0.05)])  # m, of the lowest point
        self.buried = place < 0
        if self.kind in ("box", "plate"):
            # The mass is that of the particles: the part has a quarter of it where their lattices agree.
            wide = [draw.choice([0.25, 0.3125, 0.0625] if self.weighs else [0.25, 0.3, 0.06]) for _ in middle]
            high = 0.5
            if self.kind == "plate":
                high = draw.choice([0.5, 0.9]) if max(wide) < 0.1 else draw.choice([0.125, 0.25, 0.07])
            if -0.15 < place + high < 0:
                place -= 0.2  # a single row of particles above it may be alone on the part, and not on the whole
            self.shape = lambda cuts: f"box -tool_lower {vector([*[-w for w in wide], place])} -tool_upper {vector([*wide, place + high])}"
        elif self.kind in ("wedge", "diamond", "prism"):
            wide, tall = draw.choice([0.15, 0.25]), draw.choice([0.25, 0.4])
            end = place + 2 * tall if self.kind == "diamond" else place + tall + 0.3
            right = [(0, place), (wide, place + tall)] + [(wide, end)] * (self.kind != "diamond") + [(0, end)]
            left = [(-x, z) for x, z in reversed(right[1:-1])]
            width = [draw.choice([0.25, 0.3])] * (dim - 2)
            self.shape = lambda cuts: " ".join(["polygon -tool_polygon", ",".join(f"{x:g},{z:.6g}" for x, z in right + left * (cuts == 0)),
                                                *[f"-tool_width {vector([0 if cuts > 1 else -w, w])}" for w in width]])
        elif self.kind in ("disc", "ball"):
            radius = draw.choice([0.25, 0.3])
            self.shape = lambda cuts: f"{self.kind} -tool_centre {vector([*middle, place + radius])} -tool_radius {radius}"
        else:
            size = f"-tool_radius {draw.choice([0.2, 0.25])} -tool_height {draw.choice([0.5, 0.8])}"
            tip = f"-tool_tip_angle_deg {draw.choice([60, 90, 180])}" if self.kind == "pile" else ""
            self.shape = lambda cuts: f"{'cylinder' if self.kind == 'pile' else 'cone'} -tool_centre {vector([*middle, place])} {size} {tip}"
        self.options += ["-soil_cut_out", "tool"] if self.buried else []

    @staticmethod
    def cut(half, cuts):
        """Lower ends of what reaches from -half to half, with so many planes of symmetry."""
        return [0.0 if d < cuts else -h for d, h in enumerate(half)]

    def add_motion(self, draw):
        across = [0.0] * (self.dim - 1)
        if self.weighs:
            self.options += f"-tool_motion dynamic -tool_density {draw.choice([2500, 8000])} -tool_velocity {vector(across + [-0.3])}".split()
            self.options += ["-gravity", vector(across + [-9.81])]
        else:
            up = self.buried and draw.random() < 0.3
            self.options += ["-tool_motion", "prescribed", "-tool_velocity", vector(across + [0.3 if up else -0.4])]

    def add_interface(self, draw):
        shear = draw.choice(["", "-tool_shear_limit 2e3", "-tool_friction 0.3", "-tool_friction 0.5 -tool_shear_limit 1e3"])
        if "linear_elastic" not in self.options and draw.random() < 0.4:
            shear = "-tool_shear_fraction 0.5"
        self.options += shear.split()
        free = draw.random() < 0.7
        self.options += [] if free else ["-tool_separation", "none"]
        if free and draw.random() < 0.3:
            self.options += ["-tool_contact_gap_scaling", "none"]

    def of(self, cuts):
        """Options with so many planes of symmetry."""
        half = [self.half] * (self.dim - 1)
        low = self.cut(half, cuts)
        return [*self.options, "-tool_shape", *self.shape(cuts).split(), "-mesh_lower", vector([*low, -1]), "-mesh_upper", vector([*half, 1.25]),
                "-soil_lower", vector([*low, -1]), "-soil_upper", vector([*half, 0])]


def columns(folder, name):
    lines = rows(folder)
    return np.column_stack([[float(line[k]) for line in lines[1:]] for k, title in enumerate(lines[0])
                            if title[:-1] == name and title[-1] in "xyz"])


def check_same(one, other, share, tolerance, what):
    """share: of the force on `other` that `one` tells."""
    for name, factor in (("tool_force_", share), ("tool_", 1)):
        a, b = columns(one, name)[:, -1] * factor, columns(other, name)[:, -1]
        assert len(a) == len(b), f"{what}: {len(a)} and {len(b)} rows"
        size = np.abs(b - (b[0] if name == "tool_" else 0)).max() + 1e-9
        error = np.abs(a - b).max() / size
        assert error < tolerance, f"{what}: {name}{'xyz'[columns(one, name).shape[1] - 1]} differs by {error:.3g} from row {np.argmax(np.abs(a - b) > tolerance * size)} on"
        check_same.largest = max(check_same.largest, error)


check_same.largest = 0.0


def main():
    given, base = read_arguments(__doc__, "symmetry", backends="serial,openmp")
    empty = base / "empty.opts"
    empty.write_text("\n")
    failed = touched = 0
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        precision, backend = draw.choice(given.precisions.split(",")), draw.choice(given.backends.split(","))
        deck = Deck(draw, dim, precision)
        common = ["-precision", precision, "-backend", backend]
        whole, part = fresh(base / f"{number}_whole"), fresh(base / f"{number}_part")
        try:
            run(given.binary, empty, whole, *deck.of(0), *common)
            run(given.binary, empty, part, *deck.of(deck.cuts), *common)
            force = columns(whole, "tool_force_")
            size = np.abs(force).max()
            touched += size > 1
            across = np.abs(force[:, :-1]).max()
            assert across < TOLERANCE[precision] * size + 1e-9, f"the whole has a force across of {across / size:.3g} of that along"
            check_same(part, whole, 2**deck.cuts, TOLERANCE[precision], "part and whole")
            if draw.random() < 0.25:
                ranks = fresh(base / f"{number}_ranks")
                run(given.binary, empty, ranks, *deck.of(0), *common, prefix=("mpirun", "-n", "2", "--bind-to", "none"))
                check_same(ranks, whole, 1, TOLERANCE[precision], "two ranks and one")
        except AssertionError as error:
            failed += 1
            print(f"deck {number}, {dim}D {deck.kind}, {precision}, {backend}: {error}\n    {' '.join(deck.of(0))}", flush=True)
    print(f"{given.count - failed} of {given.count} decks pass; the body touched soil in {touched}; largest difference {check_same.largest:.3g}")
    return int(failed > 0 or touched < given.count // 2)


if __name__ == "__main__":
    sys.exit(main())
