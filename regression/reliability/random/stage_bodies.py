"""Stages that place and remove bodies and change materials, against kills and other ranks.

A deck has two bodies of soil under gravity; stages place up to two lifts of fill, a plate and a pile, remove some of them, change the
materials of bodies and the parameters of materials, loads and damping. Checked are: mass, which comes and goes with what is placed,
cut out and removed alone, to the last particle; loads on faces that a removal bares and on what is placed; zeros in the history for
what is not there; bit by bit, runs that are killed inside a stage, and restarts on two or three ranks; the dry run, whose stages must be
those of the run. Where soil lies in the place of what a stage places, the run must end with status 3.
"""
import dataclasses
import re
import subprocess
import time

import numpy as np

from deck import vector
from mpm_regression.folders import ENVIRONMENT, checkpoints, command, fresh, history, kill, launcher
from stages import Staged

DT, STEPS = 5e-4, (20, 60)  # s; least and most steps of a stage
LAWS = {"clay": "-clay_model von_mises -clay_young 1e6 -clay_poisson 0.3 -clay_su 5000 -clay_su_gradient 500 -clay_su_datum 1",
        "hard": "-hard_model linear_elastic -hard_young 4e6 -hard_poisson 0.2",
        "sand": "-sand_model drucker_prager -sand_young 2e6 -sand_poisson 0.25 -sand_friction_deg 32 -sand_cohesion 300 -sand_match plane_strain",
        "soft": "-soft_model softening_clay -soft_young 1.5e6 -soft_poisson 0.45 -soft_su 6000 -soft_remoulded_ratio 0.3 -soft_xi95 2",
        "cured": "-cured_model tresca -cured_young 3e6 -cured_poisson 0.3 -cured_su 2e4"}
PARAMETERS = ["clay_su", "clay_young", "sand_friction_deg", "soft_su", "hard_young", "cured_pore_stiffness", "clay_pore_stiffness"]
VALUES = {"su": (3000, 9000), "young": (1e6, 4e6), "friction_deg": (25, 35), "pore_stiffness": (0, 4e6)}
CUT_OUT = {"left": [], "right": ["plate", "pile"], "fill": ["left", "right", "plate"], "lift": ["fill", "left", "right"]}


class StageBodies(Staged):
    strategies = ("tile", "tile", "gather", "sequential")
    others = 0.0
    small = {"double": 1e-7, "single": 2e-3}
    sums = ("energy_", "work_")

    def make(self):
        draw, dim = self.draw, self.dim
        flat, zero = [0.0] * (dim - 2), [0.0] * dim
        across = [3.0, 2.5] if dim == 2 else [3.0, 1.0, 2.5]
        self.flat, self.width = flat, across[1:-1]
        self.stages = ["one", "two", "three", "four"][:draw.randint(2, 4)]
        self.steps = [draw.randint(*STEPS) for _ in self.stages]
        self.bodies = ["left", "right", *draw.choice([[], ["fill"], ["lift"], ["fill", "lift"]])]
        self.rigids = [name for name in ("plate", "pile") if draw.random() < 0.6]
        self.placed = {name: draw.randrange(1, len(self.stages)) for name in self.bodies[2:] + self.rigids}
        self.removed = {}
        for name in self.bodies[1:] + self.rigids:
            later = range(self.placed.get(name, 0) + 1, len(self.stages))
            if later and draw.random() < 0.4:
                self.removed[name] = draw.choice(later)
        self.options = (f"-dim {dim} -mesh_lower {vector(zero)} -mesh_upper {vector(across)} -mesh_spacing 0.25 "
                        f"-gravity {vector([0.0] * (dim - 1) + [-9.81])} -materials {','.join(LAWS)} -bodies {','.join(self.bodies)} "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -output_interval {DT * 17} "
                        f"-history_interval {DT * 7} -damping {draw.choice(['0', '0.2'])} "
                        f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch', 'split'])}").split()
        self.options += draw.choice([["-time_step", str(DT)], ["-time_courant", "0.2"]])
        for name, law in LAWS.items():
            self.options += [f"-{name}_density", draw.choice(["1500", "1800"]), *law.split()]
        self.options += ["-output_energy", "on"] if draw.random() < 0.3 else []
        self.add_bodies()
        self.changes = [[]] + [self.some_changes() for _ in self.stages[1:]]
        self.add_loads()
        self.add_stages(DT)

    def add_bodies(self):
        draw, flat, up = self.draw, self.flat, self.width
        boxes = {"left": ([0.0, *flat, 0.0], [1.5, *up, 1.0]), "right": ([1.5, *flat, 0.0], [3.0, *up, 1.0]),
                 "fill": ([0.25, *flat, 1.0], [1.5, *up, 1.5]), "lift": ([0.5, *flat, 1.5], [1.0, *up, 2.0]),
                 "plate": ([1.7, *flat, 1.0], [2.4, *up, 1.6]), "pile": ([2.55, *flat, 0.5], [2.85, *up, 1.5])}
        for name in self.bodies + self.rigids:
            lower, upper = boxes[name]
            self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector(upper)}".split()
        for name in self.bodies:
            self.options += [f"-{name}_material", draw.choice(list(LAWS))]
            others = [other for other in CUT_OUT[name] if other in self.bodies + self.rigids]
            self.options += [f"-{name}_cut_out", ",".join(others)] if others else []
        self.options += ["-rigid_bodies", ",".join(self.rigids)] if self.rigids else []
        for name in self.rigids:
            self.options += draw.choice([[], [f"-{name}_friction", "0.3"]])
            self.options += draw.choice([[], f"-{name}_motion dynamic -{name}_density 1900".split(),
                                         f"-{name}_motion prescribed -{name}_velocity {vector([0.0] * (self.dim - 1) + [-0.1])}".split()])

    def add_loads(self):
        """On the side of `left` that the removal of `right` bares, and on the top of what a stage places."""
        draw, flat, up, loads = self.draw, self.flat, self.width, []
        if "right" in self.removed and draw.random() < 0.8:
            loads += ["wall"]
            self.options += (f"-wall_body left -wall_stage {self.stages[self.removed['right']]} -wall_lower {vector([1.3, *flat, 0.2])} "
                             f"-wall_upper {vector([1.7, *up, 0.8])} -wall_facing {vector([1.0, *flat, 0.0])}").split()
        if "fill" in self.placed and draw.random() < 0.5:
            loads += ["top"]
            self.options += f"-top_body fill -top_lower {vector([0.0, *flat, 1.4])} -top_upper {vector([1.5, *up, 1.6])}".split()
        for name in loads:
            self.options += draw.choice([f"-{name}_pressure {draw.uniform(500, 3000):.6g}".split(),
                                         [f"-{name}_traction", vector([draw.uniform(-1000, 1000) for _ in range(self.dim)])]])
        self.options += ["-loads", ",".join(loads)] if loads else []

    def some_changes(self):
        draw = self.draw
        found = [(f"{name}_material", draw.choice(list(LAWS))) for name in self.bodies if draw.random() < 0.4]
        found += [(name, f"{draw.uniform(*VALUES[name.split('_', 1)[1]]):.6g}") for name in PARAMETERS if draw.random() < 0.25]
        if draw.random() < 0.3:
            found.append(("gravity", vector([draw.uniform(-2, 2) for _ in range(self.dim - 1)] + [draw.uniform(-12, -5)])))
        return found

    def first_run(self):
        """The folder, or None where soil has come to the place of a body."""
        folder, done = self.launch("whole", status=None)
        blocked = done.returncode == 3 and "in the place of something else" in done.stderr
        self.note("something was in the way", blocked)
        assert blocked or done.returncode == 0, f"exit status {done.returncode}: {done.stderr}"
        return None if blocked else folder

    def compare(self, whole):
        if self.draw.random() < 0.5:
            self.check_kill(whole, self.machine)
        if self.draw.random() < 0.4:
            self.check_dry()

    def on_several_ranks(self, whole):
        """With their own restarts and kills."""
        machine = dataclasses.replace(self.machine, ranks=self.draw.randint(2, 3))
        together = self.go("together", machine=machine)
        self.check_other(together, whole, f"{machine.ranks} ranks")
        self.check_cut(together, machine)
        if self.draw.random() < 0.5:
            self.check_kill(together, machine)

    def check_kill(self, whole, machine):
        """A run that is killed once it has written a checkpoint or two."""
        folder = fresh(self.folder / "killed")
        more = ["-checkpoint_interval", f"{DT * self.draw.randint(5, 30):.12g}"]
        words = [*self.options, *machine.words(), "-precision", self.precision, *more]
        environment = {**ENVIRONMENT, "OMP_NUM_THREADS": "1", "OMPI_MCA_orte_tmpdir_base": str(self.folder)}
        process = subprocess.Popen([*launcher(machine.ranks), *command(self.given.binary, None, folder, *words)], env=environment,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wanted = self.draw.randint(1, 2)
        while process.poll() is None and len(checkpoints(folder)) < wanted:
            time.sleep(0.002)
        kill(process)
        if checkpoints(folder):
            again = self.go("killed", *more, "-restart", "latest", machine=machine)
            self.check_same_bits(again, whole, f"killed, {machine}", machine)

    def check(self, folder):
        """Mass and forces of what comes and goes, to the last particle."""
        values, log = history(folder), (folder / "mpm.log").read_text()
        stage = values["stage"].astype(int) - 1
        assert sorted(set(stage)) == list(range(len(self.stages))), f"stages {sorted(set(stage))}"
        for name in self.bodies + self.rigids:
            before = stage < self.placed.get(name, 0)
            assert not any(column[before].any() for key, column in values.items() if key.startswith(name + "_")), f"{name}: not zero before it is placed"
            gone = stage >= self.removed.get(name, len(self.stages))
            if name in self.rigids:
                for axis in self.axes:
                    assert not values[f"{name}_force_{axis}"][gone].any(), f"{name}: a force after it was removed"
                    assert not gone.any() or np.ptp(values[f"{name}_{axis}"][gone]) == 0, f"{name} moves"
            else:
                self.check_mass(name, values[f"{name}_mass"], values[f"{name}_lost_mass"], ~before, gone, log)

    def check_mass(self, name, mass, lost, there, gone, log):
        total = (mass + lost)[there]
        assert np.abs(total - total[0]).max() < 1e-6 * total[0], f"{name}: mass and lost mass {total}"
        assert not mass[gone].any(), f"{name}: mass after it was removed"
        placed = re.search(rf"body {name} is placed: (\d+) particles(?:; (\d+) were cut out)?", log)
        assert (placed is not None) == (name in self.placed), f"{name}: {placed}"
        if placed:
            density = float(self.option(self.option(f"{name}_material", self.placed[name]) + "_density"))
            expected = int(placed[1]) * density * 0.125**self.dim
            assert abs(total[0] - expected) < 1e-5 * expected, f"{name}: {total[0]} kg placed of {expected}"
            assert placed[2] is None or int(placed[2]) > 0, f"{name}: {placed[0]}"

    def option(self, name, stage=0):
        """The value of an option in a stage."""
        return dict(self.changes[stage]).get(name) or self.plain[self.plain.index("-" + name) + 1]

    def check_dry(self):
        folder, done = self.launch("dry", "-dry_run")
        printed = re.findall(r"^stage (\w+) +to .*?: (\d+) steps", done.stdout, re.M)
        assert [name for name, _ in printed] == self.stages, f"the dry run prints {printed}"
        assert not folder.exists(), "the dry run has written a folder"
        if "-time_step" in self.options:
            assert [int(steps) for _, steps in printed] == self.steps, f"the dry run prints {printed} of {self.steps}"
