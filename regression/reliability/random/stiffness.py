"""Ground whose Young's modulus comes from a field.

A deck has a box of soil of a random law, whose modulus is linear in depth, between random sides, under gravity and with a
random velocity. The modulus is given three times: as young_gradient, as a field on a grid, and by a file of particles, the first frame of
the run with the field. The three runs must agree to round-off; a field of one value must agree with that value as young. The particles of
the frames must have the modulus of their height, and the time step must be that of the largest. A field in which the modulus also varies
along x must give its particles moduli that differ. Wrong fields are refused in one line.
"""
import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.differences import largest
from mpm_regression.folders import frames, rows
from soil_mpm.ground.fields import write_field
from soil_mpm.results import Run

H = 0.5  # m, edge of a cell
LAWS = ["linear_elastic", "von_mises -soil_su {su}", "tresca -soil_su {su}",
        "softening_clay -soil_su {su} -soil_remoulded_ratio 0.4 -soil_xi95 20",
        "softening_clay -soil_su {su} -soil_remoulded_ratio 0.4 -soil_xi95 20 -soil_rate_factor 0.1 -soil_rate_reference 0.01 -soil_rate_time 0.1",
        "mohr_coulomb -soil_cohesion {su} -soil_friction_deg 30", "j2_hardening -soil_yield_stress {su} -soil_hardening_modulus 1e5",
        "drucker_prager -soil_cohesion {su} -soil_friction_deg 25 -soil_match compression"]
OF_FIELD = ["-soil_young", "field"]


def frame(path):
    with h5py.File(path) as file:
        return {name: item[()].astype(float) for name, item in file["ground"].items()}


def first_step(folder):
    """s, the time of the first step."""
    lines = rows(folder)
    step, time = (lines[0].index(name) for name in ("step", "time"))
    later = next(line for line in lines[1:] if int(line[step]) > 0)
    return float(later[time]) / int(later[step])


class Stiffness(Deck):
    several, others = 0.5, 0.1

    def make(self):
        """`base`: options without those of the modulus; `size`: the box, m; the modulus at its top, Pa, and its growth, Pa/m."""
        draw, dim = self.draw, self.dim
        wide, high = (draw.choice([11, 16, 16, 20]), draw.randint(9, 14)) if dim == 2 else (draw.choice([6, 8, 8]), draw.randint(5, 8))
        self.size = [H * wide, *([H * 2] if dim == 3 else []), H * high]
        upper = [*self.size[:-1], self.size[-1] + 3 * H]
        law = draw.choice(LAWS).format(su=f"{10 ** draw.uniform(3.5, 4.5):.5g}")
        self.young, self.growth = 10 ** draw.uniform(6.3, 7), 10 ** draw.uniform(5.5, 7)
        self.poisson, self.pore = draw.choice([0, 0.2, 0.3, 0.45]), draw.choice([0] * 7 + [2e7] * 3)
        self.base = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(upper)} -mesh_spacing {H} -materials soil "
                     f"-soil_model {law} -soil_density {draw.uniform(1500, 2200):.5g} -soil_poisson {self.poisson} "
                     f"-bodies ground -ground_material soil -gravity {vector([0] * (dim - 1) + [-9.81])} "
                     f"-ground_velocity {vector([draw.uniform(-0.2, 0.2) for _ in range(dim)])} "
                     f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -f_bar_fraction {draw.choice(['0', '0.98'])} "
                     f"-damping {draw.choice(['0', '0.05'])} -particle_domain {draw.choice(['fixed', 'fixed', 'stretch'])} "
                     f"-rebuild_margin {draw.choice(['0.5', '0.05'])} -time_end 0.06 -output_interval 0.03 -history_interval 0.01").split()
        self.base += ["-soil_pore_stiffness", repr(self.pore)] if self.pore else []
        self.base += self.side_options(wide)
        self.per_cell = str(draw.choice([1, 2, 2, 3] if dim == 2 else [1, 2]))
        self.box = ["-ground_shape", "box", "-ground_lower", vector([0] * dim), "-ground_upper", vector(self.size),
                    "-ground_particles_per_cell", self.per_cell]
        self.options = [*self.base, *self.box, *OF_FIELD, "-ground_field", self.write("field.h5", lambda x, depth: self.young + self.growth * depth)]

    def side_options(self, wide):
        draw = self.draw
        kind = draw.choice(["roller", "absorbing", "free_field", "free", *(["periodic"] if wide % 8 == 0 else [])])
        base = draw.choice(["fixed", "absorbing"]) if kind == "free_field" else draw.choice(["fixed", "roller", "absorbing"])
        if kind == "periodic" and base == "absorbing":
            base = "fixed"
        options = [f"-mesh_{self.up}min", base, f"-mesh_{self.up}max", "free"]
        for axis in self.axes[:-1]:
            for end in ("min", "max"):
                options += [f"-mesh_{axis}{end}", kind if axis == "x" else "roller"]
        return options

    def write(self, name, modulus):
        """modulus(x, depth), Pa, on a grid that covers the box."""
        path, size = self.folder / name, self.size
        path.unlink(missing_ok=True)
        counts = [self.draw.randint(2, 5) for _ in size]
        axes = [np.linspace(0, length, n) for length, n in zip(size, counts)]
        points = np.meshgrid(*axes, indexing="ij")
        write_field(path, "young", modulus(points[0], size[-1] - points[-1]), [0] * len(size), [length / (n - 1) for length, n in zip(size, counts)])
        return path

    def go_with(self, name, *more):
        return self.go(name, *more, options=self.base)

    def agree(self, one, other, what):
        apart, where = largest(Run(one), Run(other))
        self.note(f"difference of ways to give one modulus, {self.precision}", apart)
        assert apart <= self.apart[self.precision], f"{what}: {apart:.3g} apart at {where}"

    def refuse(self, words, *more):
        """The run is refused in one line."""
        _, done = self.launch("refused", *more, options=self.base, status=2)
        lines = done.stderr.strip().splitlines()
        assert len(lines) == 1 and words in lines[0], f"not refused by a line with \"{words}\":\n{done.stderr}"

    def compare(self, whole):
        first, last = frame(frames(whole)[0]), frame(frames(whole)[-1])
        exact = self.young + self.growth * (self.size[-1] - first["reference_height"])
        assert np.allclose(first["young"], exact, rtol=self.bound(1e-9, 1e-6)), "the moduli of the particles are not those of the field"
        assert np.array_equal(np.sort(first["young"]), np.sort(last["young"])), "the particles have lost their moduli"
        self.check_gradient(whole)
        self.check_one_value(whole)
        uneven = self.write("uneven.h5", lambda x, depth: (self.young + self.growth * depth) * (1 + x / self.size[0]))
        grown = frame(frames(self.go_with("uneven", *self.box, *OF_FIELD, "-ground_field", uneven))[0])
        assert grown["young"].max() > 1.5 * grown["young"].min(), "the field does not vary"
        self.check_files(whole, first, last)

    def check_gradient(self, whole):
        young = repr(self.young)
        gradient = self.go_with("gradient", *self.box, "-soil_young", young, "-soil_young_gradient", repr(self.growth),
                                "-soil_young_datum", repr(self.size[-1]))
        self.agree(whole, gradient, "the field against growth with depth")
        self.refuse("-soil_young", *self.box, "-soil_young", young, "-ground_field", self.folder / "field.h5")
        self.refuse("where body ground has no -ground_field", *self.box, *OF_FIELD)

    def check_one_value(self, whole):
        young = self.young
        wrong = self.write("one.h5", lambda x, depth: young - 2 * young * (depth == 0))
        self.refuse("whose young is a number in Pa from 0.001", *self.box, *OF_FIELD, "-ground_field", wrong)
        one = self.write("one.h5", lambda x, depth: young + 0 * depth)
        same = self.go_with("one", *self.box, *OF_FIELD, "-ground_field", one)
        plain = self.go_with("plain", *self.box, "-soil_young", repr(young))
        self.agree(same, plain, "a field of one value against that value")
        if "stretch" not in self.options:
            assert abs(first_step(plain) / first_step(same) - 1) < 1e-6, "a field of one value has another time step"
            ratio, nu = first_step(same) / first_step(whole), self.poisson
            wave = [e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) + self.pore for e in (young, young + self.growth * self.size[-1])]
            assert abs(ratio / np.sqrt(wave[1] / wave[0]) - 1) < 0.05, f"the time step is {ratio:.4g} times that of the largest modulus"

    def check_files(self, whole, first, last):
        """Files of particles: the first frame, and a start from the last."""
        start = self.folder / "start.h5"
        with h5py.File(frames(whole)[0]) as source, h5py.File(start, "w") as to:
            source.copy("ground", to)
            del to["ground"].attrs["own_parameter"]
        listed = [*OF_FIELD, "-ground_shape", "particles", "-ground_particles_per_cell", self.per_cell, "-time_max_steps", "2", "-ground_file"]
        begin = frame(frames(self.go_with("listed", *listed, start))[0])
        assert np.allclose(begin["young"], first["young"], rtol=1e-6), "the file of particles has given other moduli"
        resumed = frame(frames(self.go_with("resumed", *listed, frames(whole)[-1]))[0])
        assert np.allclose(np.sort(resumed["young"]), np.sort(last["young"]), rtol=1e-6), "a start from a frame has lost the moduli"
