"""Contact problems that are symmetric: the whole against the half or quarter that planes of symmetry leave.

A rigid body of a random shape moves along the vertical plane or line of symmetry of soil under it or around it, by a velocity or by its
weight. Rollers cut the problem to a half, or in 3D to a half or a quarter. Force and motion of the body on this part must be those of the
whole, to round-off, and the whole must have no force across, also where several faces of the body are equally near to a node. In half
of the decks the body touches soil, or something is wrong with them all.
"""
import numpy as np

from deck import Deck, rounded
from mpm_regression.folders import history

SPACING = 0.125
STEPS = {"double": 60, "single": 20}
TOLERANCE = {"double": 1e-5, "single": 5e-3}  # of the largest force; steps of contact amplify round-off


class Symmetry(Deck):
    strategies = ("tile", "tile", "tile", "gather")
    restarts, several, others, counts = 0.1, 0.25, 0.0, (2,)

    def make(self):
        draw, dim = self.draw, self.dim
        self.cuts = 1 if dim == 2 else draw.choice([1, 2])
        model = draw.choice(['linear_elastic', 'von_mises -clay_su 4e3', 'tresca -clay_su 4e3 -clay_su_gradient 2e3'])
        self.common = (f"-dim {dim} -mesh_spacing {SPACING} -materials clay -clay_density 1800 -clay_poisson 0.3 -clay_young 2e6 "
                       f"-clay_model {model} -bodies soil -soil_material clay -soil_shape box "
                       f"-soil_particles_per_cell {draw.choice([2, 3]) if dim == 2 else 2} -rigid_bodies tool "
                       f"-time_max_steps {STEPS[self.precision]} -time_end 9 -history_interval 1e-9 -output_interval 9").split()
        weighs = draw.random() < 0.3 and self.exact  # in single precision the whole drifts aside by round-off
        self.kind = draw.choice(["box", "plate", "disc", "wedge", "diamond"] if dim == 2 else ["box", "plate", "ball", "pile", "cone", "prism"])
        place = draw.choice([0.0, -0.25, draw.uniform(-0.4, 0.05)])  # m, of the lowest point
        self.buried = place < 0
        polygon = self.kind in ("wedge", "diamond", "prism")
        if self.kind in ("box", "plate"):
            self.make_box(place, weighs)
        elif polygon:
            self.make_polygon(place)
        else:
            self.make_round(place)
        self.common += ["-soil_cut_out", "tool"] if self.buried else []
        self.turned_by = lambda cuts: []
        weighs = weighs and not polygon  # the plane does not hold a polygon that ends there
        self.add_motion(weighs)
        self.add_spin(weighs)
        self.add_interface()
        self.common += ["-velocity_update", draw.choice(["flip", "flip", "apic"]), "-damping", draw.choice(["0", "0", "0.05"])]
        self.options = self.of(0)

    def make_box(self, place, weighs):
        """The mass is that of the particles: the part has a quarter of it where their lattices agree."""
        draw = self.draw
        wide = [draw.choice([0.25, 0.3125, 0.0625] if weighs else [0.25, 0.3, 0.06]) for _ in self.axes[:-1]]
        high = 0.5
        if self.kind == "plate":
            high = draw.choice([0.5, 0.9]) if max(wide) < 0.1 else draw.choice([0.125, 0.25, 0.07])
        if -0.15 < place + high < 0:
            place -= 0.2  # a single row of particles above it may be alone on the part, and not on the whole
        self.shape = lambda cuts: f"box -tool_lower {rounded([*[-w for w in wide], place])} -tool_upper {rounded([*wide, place + high])}"

    def make_polygon(self, place):
        draw = self.draw
        wide, tall = draw.choice([0.15, 0.25]), draw.choice([0.25, 0.4])
        end = place + 2 * tall if self.kind == "diamond" else place + tall + 0.3
        right = [(0, place), (wide, place + tall)] + [(wide, end)] * (self.kind != "diamond") + [(0, end)]
        left = [(-x, z) for x, z in reversed(right[1:-1])]
        width = [draw.choice([0.25, 0.3])] * (self.dim - 2)
        self.shape = lambda cuts: " ".join(["polygon -tool_polygon", ",".join(f"{x:g},{z:.6g}" for x, z in right + left * (cuts == 0)),
                                            *[f"-tool_width {rounded([0 if cuts > 1 else -w, w])}" for w in width]])

    def make_round(self, place):
        draw, middle = self.draw, [0.0] * (self.dim - 1)
        if self.kind in ("disc", "ball"):
            radius = draw.choice([0.25, 0.3])
            self.shape = lambda cuts: f"{self.kind} -tool_centre {rounded([*middle, place + radius])} -tool_radius {radius}"
            return
        size = f"-tool_radius {draw.choice([0.2, 0.25])} -tool_height {draw.choice([0.5, 0.8])}"
        tip = f"-tool_tip_angle_deg {draw.choice([60, 90, 180])}" if self.kind == "pile" else ""
        word = "cylinder" if self.kind == "pile" else "cone"
        self.shape = lambda cuts: f"{word} -tool_centre {rounded([*middle, place])} {size} {tip}"

    def add_motion(self, weighs):
        draw, across = self.draw, [0.0] * (self.dim - 1)
        if weighs:
            self.common += f"-tool_motion dynamic -tool_contact nodes -tool_density {draw.choice([2500, 8000])} -tool_velocity {rounded(across + [-0.3])}".split()
            self.common += ["-gravity", rounded(across + [-9.81])]
        else:
            up = self.buried and draw.random() < 0.3
            self.common += ["-tool_motion", "prescribed", "-tool_velocity", rounded(across + [0.3 if up else -0.4])]

    def add_spin(self, weighs):
        """Half a body turns about the normal of the plane, driven or by its weight and a moment."""
        draw = self.draw
        self.spins = self.dim == 3 and self.cuts == 1 and self.kind != "prism" and draw.random() < 0.6
        if not self.spins:
            return
        self.common += ["-tool_angular_velocity", f"{draw.uniform(-1.5, 1.5):.4f},0,0"]
        if weighs:
            moment = draw.uniform(-40, 40)
            self.turned_by = lambda cuts: ["-tool_free", "y,z,rx", "-tool_moment", f"{moment / 2 ** cuts:.6f},0,0"]

    def add_interface(self):
        draw = self.draw
        shear = draw.choice(["", "-tool_shear_limit 2e3", "-tool_friction 0.3", "-tool_friction 0.5 -tool_shear_limit 1e3"])
        if "linear_elastic" not in self.common and draw.random() < 0.4:
            shear = "-tool_shear_fraction 0.5"
        self.common += shear.split()
        free = draw.random() < 0.7
        self.common += [] if free else ["-tool_separation", "none"]
        if free and draw.random() < 0.3:
            self.common += ["-tool_contact_gap_scaling", "none"]

    def of(self, cuts):
        """Options with so many planes of symmetry."""
        half = [1.0 if self.dim == 2 else 0.75] * (self.dim - 1)
        low = [0.0 if d < cuts else -h for d, h in enumerate(half)]
        return [*self.common, *self.turned_by(cuts), "-tool_shape", *self.shape(cuts).split(), "-mesh_lower", rounded([*low, -1]), "-mesh_upper", rounded([*half, 1.25]),
                "-soil_lower", rounded([*low, -1]), "-soil_upper", rounded([*half, 0])]

    def check(self, folder):
        values = history(folder)
        force = np.column_stack([values[f"tool_force_{axis}"] for axis in self.axes])
        size = np.abs(force).max()
        across = np.abs(force[:, 0 if self.spins else slice(-1)]).max()
        self.note("touched", size > 1)
        assert across < TOLERANCE[self.precision] * size + 1e-9, f"the whole has a force across of {across / size:.3g} of that along"

    def compare(self, whole):
        part = self.go("part", options=self.of(self.cuts))
        self.check_motion(part, whole, 2**self.cuts, "part and whole")

    def check_other(self, folder, whole, what):
        self.check_motion(folder, whole, 1, what)

    def check_motion(self, one, other, share, what):
        """share: of the force on `other` that `one` reports."""
        mine, theirs, tolerance = history(one), history(other), TOLERANCE[self.precision]
        names = [(f"tool_force_{self.up}", share), (f"tool_{self.up}", 1)]
        if self.spins:
            names += [("tool_moment_x", share), ("tool_angle_x", 1), ("tool_force_y", share), ("tool_y", 1)]
        for name, factor in names:
            a, b = mine[name] * factor, theirs[name]
            assert len(a) == len(b), f"{what}: {len(a)} and {len(b)} rows"
            size = np.abs(b - (0 if "force" in name else b[0])).max() + 1e-9
            if name in ("tool_moment_x", "tool_force_y"):  # those of a smooth ball are round-off
                size = max(size, 0.1 * np.abs(theirs[f"tool_force_{self.up}"]).max())
            error = np.abs(a - b).max() / size
            assert error < tolerance, f"{what}: {name} differs by {error:.3g} from row {np.argmax(np.abs(a - b) > tolerance * size)} on"
            self.note(f"difference of {name.rpartition('_')[0]}", error)

    @classmethod
    def fault_of_all(cls, noted, count):
        touched = sum(noted.get("touched", []))
        return f"the body touches soil in {touched:g} of {count} decks alone" if touched < count // 2 else ""
