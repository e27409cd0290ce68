"""Runs that start from what another run left: from its last frame and from its checkpoint.

Random decks: what a start holds is what was left, in 2D and 3D, with every velocity update, on 1 and 2 ranks. Tests with names, each
with a precision (column_double), the columns in 2D alone with --short:

column    a column that has settled under its weight stays at rest in a new run, with its mass and its strengths
cut       a run cut in two by a frame, or by a checkpoint, goes on as the whole one
refused   what a start and -restart_change do not take: one line, and nothing is written
changed   -restart_change: loads, rigids and sides of the mesh that change at a restart
"""
from mpm_regression.folders import checkpoints, frames
from start_tests import FIELDS, StartTests, apart, bodies, column, from_file


class Starts(StartTests):
    more = {"short": False}
    backends = ("serial",)
    ranks = (1, 2)
    restarts, several, others = 0.2, 0.0, 0.0

    @classmethod
    def names(cls, given):
        return [f"{test}_{precision}" for test in ("column", "cut", "refused", "changed") for precision in given.precisions]

    def make(self):
        if isinstance(self.key, str):
            self.precision = self.key.split("_")[1]
            self.exact = self.precision == "double"
            return
        draw, cells = self.draw, self.draw.randint(3, 6)
        self.common, box = column(self.dim, cells, draw.randint(2, 4))
        self.common += ["-velocity_update", draw.choice(("flip", "pic", "xpic", "apic"))]
        self.common[self.common.index("-clay_su") + 1] = str(draw.choice((500, 5000, 5e5)))
        self.width = ["-soil_particles_per_cell", str(draw.randint(1, 3))]
        velocity = ",".join(f"{draw.uniform(-1, 1):.3f}" for _ in self.axes)
        self.options = [*self.common, *box, *self.width, "-soil_velocity", velocity, "-time_end", "0.05", "-output_interval", "0.05",
                        "-checkpoint_interval", "0.05"]

    def __str__(self):
        return "" if isinstance(self.key, str) else super().__str__()

    def examine(self):
        getattr(self, f"test_{self.key.split('_')[0]}")() if isinstance(self.key, str) else super().examine()

    def compare(self, whole):
        left = bodies(frames(whole)[-1])
        total, round_off = left["mass"].sum(dtype=float), self.bound(2e-14, 2e-6)
        machine = self.draw_machine(self.ranks)
        for source in (frames(whole)[-1], checkpoints(whole)[-1]):
            words = [word.replace("soil", "bank") for word in [*self.common, *from_file("FILE", "-soil_file_body", "BODY"), *self.width]]
            options = [{"FILE": str(source), "BODY": "soil"}.get(word, word) for word in words]
            again, done = self.launch("again", "-time_end", 0.02, "-output_interval", 0.02, "-checkpoint_interval", 0.02, options=options,
                                      machine=machine)
            found, end = (bodies(frames(again)[k], "bank") for k in (0, -1))
            for key in FIELDS:
                assert apart(found[key], left[key]) <= round_off, f"{source.name}: {key} {apart(found[key], left[key]):.3g}"
            for state in (found, end):
                assert (state["mass"] == left["mass"]).all(), f"{source.name}: mass"
                assert (state["reference_height"] == left["reference_height"]).all(), f"{source.name}: heights"
                assert abs(state["mass"].sum(dtype=float) / total - 1) < 1e-14, f"{source.name}: total mass"
            strengths = (bodies(checkpoints(folder)[-1])["strength"] for folder in (whole, again))
            assert apart(*strengths) <= round_off, f"{source.name}: strengths"
            printed = f"(body soil, {'frame' if 'frame' in source.name else 'checkpoint'} of step"
            assert printed in done.stdout, f"{source.name}: the log does not say where it starts"
