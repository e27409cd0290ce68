"""Stages, against runs without stages and restarts.

A deck has soil of one to three bodies under gravity, up to two rigid bodies, and two to four stages, of which each changes some
loads, walls, contacts, damping, the clay and intervals of output, or removes a body. The same bits must give: a first stage and a
restart with -restart_change in the place of the second stage; stages that change nothing in the place of one run. On several ranks
positions must be the same to round-off. Mass is lost by removal alone.
"""
import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.folders import checkpoints, contents, frames, history

DT, STEPS = 1e-3, (20, 60)  # s; least and most steps of a stage


def check_same_fields(one, other, bodies, what):
    """Fields of the bodies in the last frames, without the attributes of the frames."""
    a, b = ({key: value for key, value in contents(frames(folder)[-1]).items() if key.split("/")[0] in bodies} for folder in (one, other))
    differ = [key for key in sorted(a.keys() | b.keys()) if a.get(key) != b.get(key)]
    assert not differ, f"{what}, last frame: {differ[:6]}"


class Staged(Deck):
    """Parts that decks of stages share: `stages`, their `changes` and `bodies` that come and go, in `placed` and `removed` (name: stage)."""
    small = {"double": 1e-9, "single": 1e-3}  # m, on several ranks

    def words_of(self, ends, changes):
        words = ["-stages", ",".join(self.stages[:len(ends)])]
        for stage, end, changed in zip(self.stages, ends, changes):
            words += [f"-{stage}_time_end", end, *(word for key, value in changed for word in (f"-{stage}_{key}", value))]
        return words

    def add_stages(self, step):
        """The options of all stages, of so many seconds a step."""
        self.plain, self.ends = self.options, [f"{steps * step:.12g}" for steps in self.steps]
        self.options = [*self.plain, *self.words_of(self.ends, self.changes)]
        for key, table in (("place", self.placed), ("remove", self.removed)):
            for k, stage in enumerate(self.stages):
                names = [name for name, at in table.items() if at == k]
                self.options += [f"-{stage}_{key}", ",".join(names)] if names else []

    def cut_step(self, whole):
        """Any step, or one at the end of a stage."""
        values = history(whole)
        total, ends = int(values["step"][-1]), values["step"][:-1][np.diff(values["stage"]) > 0].astype(int)
        at = self.draw.choice([self.draw.randint(1, total - 1), *(int(end) + k for end in ends for k in (0, 1))])
        return min(at, total - 1)

    def check_same_bits(self, folder, whole, what, machine=None):
        super().check_same_bits(folder, whole, what, machine)
        check_same_fields(folder, whole, [*self.bodies, *self.rigids], what)

    def check_other(self, folder, whole, what):
        with h5py.File(frames(folder)[-1]) as a, h5py.File(frames(whole)[-1]) as b:
            for body in self.bodies:
                x, y = a[body]["position"][()], b[body]["position"][()]
                assert x.shape == y.shape, f"{what}: {x.shape} of {y.shape} particles of {body}"
                assert x.size == 0 or np.abs(x - y).max() < self.small[self.precision], f"{what}: {body} is {np.abs(x - y).max():.3g} m off"


class Stages(Staged):
    strategies = ("tile", "tile", "gather")
    counts = (2,)
    others = 0.0

    def make(self):
        draw, dim = self.draw, self.dim
        across = [3.0, 2.5] if dim == 2 else [3.0, 1.5, 2.5]
        self.bodies = ["left", "right", "top"][:draw.randint(1, 3)]
        self.rigids = draw.sample(["plate", "pile"], draw.randint(0, 2))
        self.turning, self.degrees = [], "x,y,rz" if dim == 2 else "x,y,z,rx,ry,rz"
        zero, flat = [0.0] * dim, [0.0] * (dim - 2)
        boxes = {"left": ([0.0, *flat, 0.0], [1.5, *across[1:-1], 1.0]), "right": ([1.5, *flat, 0.0], [3.0, *across[1:-1], 1.0]),
                 "top": ([0.5, *flat, 1.0], [1.0, *across[1:-1], 1.5])}
        self.options = (f"-dim {dim} -mesh_lower {vector(zero)} -mesh_upper {vector(across)} -mesh_spacing 0.25 -time_step {DT} "
                        f"-gravity {vector([0.0] * (dim - 1) + [-9.81])} -materials clay -clay_model von_mises -clay_density 1500 "
                        f"-clay_young 1e6 -clay_poisson 0.3 -clay_su {draw.choice([800, 5000])} -bodies {','.join(self.bodies)} "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -output_interval {DT * 17} "
                        f"-history_interval {DT * 7}").split()
        for name in self.bodies:
            lower, upper = boxes[name]
            self.options += f"-{name}_shape box -{name}_material clay -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
        self.options += ["-rigid_bodies", ",".join(self.rigids)] if self.rigids else []
        for k, name in enumerate(self.rigids):
            lower = [1.2 + 0.9 * k, *[0.3] * (dim - 2), 1.1]
            self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector(x + 0.6 for x in lower)}".split()
            self.options += draw.choice([[], [f"-{name}_friction", "0.3"]])
            if draw.random() < 0.5:  # it turns, in stages that do not hold it
                self.turning.append(name)
                self.options += f"-{name}_motion dynamic -{name}_density 1800 -{name}_free {self.degrees}".split()
        self.stages = ["one", "two", "three", "four"][:draw.randint(2, 4)]
        self.steps = [draw.randint(*STEPS) for _ in self.stages]
        self.changes = [[]] + [self.some_changes() for _ in self.stages[1:]]
        self.placed, self.removed = {}, {}
        if len(self.bodies) > 1 and draw.random() < 0.5:
            self.removed = {self.bodies[-1]: draw.randrange(1, len(self.stages))}
        self.add_stages(DT)

    def some_changes(self):
        found, draw, dim = [], self.draw, self.dim
        if draw.random() < 0.5:
            found.append(("gravity", vector([draw.uniform(-2, 2) for _ in range(dim - 1)] + [draw.uniform(-12, -5)])))
        if draw.random() < 0.4:
            found.append(("damping", draw.choice(["0", "0.3", "0.7"])))
        if draw.random() < 0.3:
            found.append((draw.choice(["mesh_xmin", "mesh_xmax", "mesh_ymin"]), draw.choice(["fixed", "roller"])))
        if draw.random() < 0.4:
            found.append(draw.choice([("clay_su", "2000"), ("clay_young", "1.5e6"), ("clay_poisson", "0.4")]))
        for name in self.rigids:
            if draw.random() < 0.5:
                motion = draw.choice(["fixed", "prescribed", "dynamic"])
                velocity = vector([draw.uniform(-0.3, 0.3) for _ in range(dim)])
                found += [(f"{name}_motion", motion)] + [(f"{name}_velocity", velocity)] * (motion != "fixed")
                if name not in self.turning:
                    found += [(f"{name}_density", "1800")] * (motion == "dynamic")
                elif motion == "prescribed":
                    found.append((f"{name}_angular_velocity", "0.5" if dim == 2 else "0.3,-0.2,0.1"))
            elif name in self.turning and draw.random() < 0.5:
                found.append((f"{name}_free", draw.choice([self.degrees, self.degrees[:3 + 2 * (dim - 2)]])))
            if draw.random() < 0.3:
                found.append((f"{name}_friction", draw.choice(["0.1", "0.5"])))
        return found

    def check(self, folder):
        values = history(folder)
        stage = values["stage"].astype(int)
        assert sorted(set(stage)) == list(range(1, len(self.stages) + 1)) and (np.diff(stage) >= 0).all(), f"stages {stage}"
        for k in range(len(self.stages)):
            last = values["step"][stage == k + 1].max()
            assert last == sum(self.steps[:k + 1]), f"stage {k + 1} ends at step {last} of {self.steps}"
        for name in self.bodies:
            mass, lost = values[f"{name}_mass"], values[f"{name}_lost_mass"]
            expected = np.where(stage <= self.removed.get(name, len(self.stages)), mass[0], 0)
            assert np.abs(mass - expected).max() < 1e-5 * mass[0], f"{name}: mass {mass} of {expected}"
            assert np.abs(mass + lost - mass[0]).max() < 1e-5 * mass[0], f"{name}: lost {lost}"

    def compare(self, whole):
        if 1 not in self.removed.values():
            self.check_restart()
        staged = self.go("staged", options=[*self.plain, *self.words_of(self.ends, [[] for _ in self.stages])])
        plain = self.go("plain", "-time_end", f"{sum(self.steps) * DT:.12g}", options=self.plain)
        check_same_fields(plain, staged, [*self.bodies, *self.rigids], "stages that change nothing")

    def check_restart(self):
        """The second stage by -restart_change."""
        staged = self.go("staged", options=[*self.plain, *self.words_of(self.ends[:2], self.changes)])
        first = self.go("first", "-time_end", self.ends[0], "-checkpoint_interval", 1e3, options=self.plain)
        changed = {f"-{key}": value for key, value in self.changes[1]}
        options = {**dict(zip(self.plain[::2], self.plain[1::2])), **changed, "-time_end": f"{sum(self.steps[:2]) * DT:.12g}"}
        untaken = [f"-{name}_{key}" for name in self.turning if options[f"-{name}_motion"] != "dynamic" for key in ("density", "free")]
        options = {key: value for key, value in options.items() if key not in untaken}
        listed = ["-restart_change", ",".join(key[1:] for key in [*changed, *untaken])] if changed else []
        again = self.go("first", "-restart", checkpoints(first)[-1], *listed, options=[word for pair in options.items() for word in pair])
        check_same_fields(again, staged, [*self.bodies, *self.rigids], "a restart in the place of a stage")
