#!/usr/bin/env python3
"""Laws of the user (model umat), inputs/umat/von_mises.c, inputs/umat/mohr_coulomb.f and probe.c, against the program's own.

    check.py MPM FOLDER [--decks 60] [--dims 2,3] [TEST ...]

c, fortran   a footing with the law and with its UMAT: the same fields and forces, on 1 and 2 ranks, 1 and 2 threads,
             restarted, and started from a frame; then random decks of random states
probe        what a UMAT is given: numbers, names, places, rotations, strains
gives_up     PNEWDT, XIT, and a stress or a state variable that is not a number end the run with status 3, the particle, the step
             and the place
ends         a UMAT that ends the program: status 3 and a line with the particle, the step and the place; status 2 at the start
driver       -element_path: the same paths through a law and through its UMAT, and what the UMAT is given
refused      options and libraries that are wrong: one line, and nothing is written

Exit status 77 where a compiler is missing for all that is asked for.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

import numpy as np

from mpm_regression import particles, point
from mpm_regression.folders import checkpoints, contents, differences, frames, fresh, rows, run
from soil_mpm.results import read_frame

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent

# Largest difference of a field from the built-in law's over the field's largest value; friction amplifies round-off.
CLOSE = 1e-9


LAWS = {"c": ("von_mises", ROOT / "inputs/umat/von_mises.c", 1, {"young": 1.5e6, "poisson": 0.49, "su": 3000.0}),
        "fortran": ("mohr_coulomb", ROOT / "inputs/umat/mohr_coulomb.f", 2,
                    {"young": 2e7, "poisson": 0.3, "cohesion": 5000.0, "friction_deg": 30.0, "dilation_deg": 10.0})}
FIELDS = ("position", "velocity", "stress", "volume", "plastic_strain")


def particles_of(frame, body="soil"):
    """The fields of a frame; a UMAT's first state variable is its plastic strain."""
    found = {key: values.astype(float) for key, values in read_frame(frame)[1][body].items()}
    if "state_1" in found:
        found["plastic_strain"] = found["state_1"]
    return found


def apart(a, b):
    if a.shape != b.shape or not np.isfinite(a).all():
        return np.inf
    return np.abs(a - b).max() / max(np.abs(b).max(), 1e-300)


class Tests:
    def __init__(self, args):
        self.binary, self.base, self.decks = args.binary.resolve(), fresh(args.folder.resolve()), args.decks
        self.base.mkdir(parents=True)
        self.dims = [int(dim) for dim in args.dims.split(",")]
        self.count, self.worst = 0, 0.0
        self.empty = self.base / "empty.opts"
        self.empty.write_text("\n")

    def check(self, good, what):
        self.count += 1
        if not good:
            sys.exit(f"check.py: {what}")

    def build(self, source, name):
        library = self.base / name
        done = subprocess.run([ROOT / "scripts/build_umat", source, library], capture_output=True, text=True)
        self.check(done.returncode == 0, f"build_umat {source}: {done.stdout}{done.stderr}")
        return library

    def run(self, name, *options, ranks=1, threads=1, status=0):
        prefix = ("mpirun", "-n", str(ranks), "--bind-to", "none") if ranks > 1 else ()
        folder = self.base / name
        if "-restart" not in options:
            fresh(folder)
        backend = ["-backend", "serial" if threads == 1 else "openmp"]
        done = run(self.binary, self.empty, folder, *backend, *options, status=status, prefix=prefix,
                   environment={"OMP_NUM_THREADS": str(threads), "OMP_WAIT_POLICY": "passive"})  # they share cores
        return folder, done

    def same(self, one, other, what, close=CLOSE):
        found, wanted = particles_of(one), particles_of(other)
        for key in FIELDS:
            difference = apart(found[key], wanted[key])
            self.worst = max(self.worst, difference)
            self.check(difference <= close, f"{what}: {key} differs by {difference:.3g}")
        return found

    # The law of a language and its UMAT as options.
    def laws(self, language):
        model, source, states, values = LAWS[language]
        library = self.build(source, f"{language}.so")
        own = ["-clay_model", model, *[word for key, value in values.items() for word in (f"-clay_{key}", repr(value))]]
        return own, self.umat(library, values.values(), states)

    def umat(self, library, properties, states=1, *more):
        return ["-clay_model", "umat", "-clay_library", library, "-clay_properties", ",".join(map(repr, properties)),
                "-clay_states", states, *more]

    def test_language(self, language):
        own, umat = self.laws(language)
        step = {"c": 5e-4, "fortran": 2e-4}[language]
        deck = ["-mesh_lower", "0,0", "-mesh_upper", "2,2.5", "-mesh_spacing", "0.125", "-mesh_ymax", "free", "-mesh_ymin",
                "fixed", "-materials", "clay", "-clay_density", "1800", "-bodies", "soil", "-soil_material", "clay",
                "-soil_shape", "box", "-soil_lower", "0,0", "-soil_upper", "2,2", "-rigids", "plate", "-plate_shape", "box",
                "-plate_lower", "0,2", "-plate_upper", "0.5,2.25", "-plate_motion", "prescribed", "-plate_velocity", "0,-1",
                "-f_bar_fraction", "0", "-time_step", repr(step), "-history_interval", "0.002", "-soil_stress", "-2e4,-2e4,-2e4,0"]
        end = ["-time_end", "0.02", "-output_interval", "0.01"]
        wanted, _ = self.run("own", *deck, *own, *end)
        first, _ = self.run("umat", *deck, *umat, *end, "-checkpoint_interval", "0.01")
        strain = self.same(frames(first)[-1], frames(wanted)[-1], "the footing")["plastic_strain"]
        self.check((strain > 1e-3).mean() > 0.02, f"{(strain > 1e-3).mean():.2g} of the footing's soil has yielded")
        force, other = (np.array(rows(folder)[1:], float) for folder in (first, wanted))
        names = rows(wanted)[0]
        for name in ("plate_force_y", "time"):
            k = names.index(name)
            difference = apart(force[:, k], other[:, k])
            self.check(difference <= CLOSE, f"{name} of the footing: {difference:.3g}")
        for ranks, threads, safe in ((2, 1, "off"), (1, 2, "off"), (1, 2, "on"), (2, 2, "on")):
            folder, _ = self.run("again", *deck, *umat, "-clay_thread_safe", safe, *end, ranks=ranks, threads=threads)
            self.same(frames(folder)[-1], frames(wanted)[-1], f"{ranks} ranks, {threads} threads, thread_safe {safe}")
        # Restarted from its checkpoint, and with the number of ranks changed.
        whole = self.base / "whole"
        shutil.copytree(first, fresh(whole), dirs_exist_ok=True)
        self.run("umat", *deck, *umat, *end, "-checkpoint_interval", "0.01", "-restart", checkpoints(first)[0])
        self.check(differences(first, whole) == [], f"restarted: {differences(first, whole)[:3]}")
        self.run("umat", *deck, *umat, *end, "-checkpoint_interval", "0.01", "-restart", checkpoints(whole)[0], ranks=2)
        self.same(frames(first)[-1], frames(whole)[-1], "restarted on 2 ranks")
        # From a frame: its states go on.
        half = [word for word in deck]
        for word, value in (("-soil_shape", "particles"), ("-plate_lower", "0,1.99"), ("-plate_upper", "0.5,2.24")):
            half[half.index(word) + 1] = value
        for word in ("-soil_lower", "-soil_upper", "-soil_stress"):
            del half[half.index(word):half.index(word) + 2]
        left = []
        for name, law, folder in (("own_frame", own, wanted), ("umat_frame", umat, whole)):
            left.append(frames(folder)[1])
            self.run(name, *half, *law, "-soil_file", left[-1], "-time_end", "0.005", "-output_interval", "0.005")
        self.same(frames(self.base / "umat_frame")[-1], frames(self.base / "own_frame")[-1], "from a frame")
        begun = particles_of(frames(self.base / "umat_frame")[0])
        self.check((begun["state_1"] == particles_of(left[1])["state_1"]).all() and begun["state_1"].max() > 0,
                   "states of a start from a frame")
        # From a frame of the law itself: stresses go on, and states begin anew.
        self.run("other_frame", *half, *umat, "-soil_file", left[0], "-time_end", "0.001", "-output_interval", "0.001")
        begun = particles_of(frames(self.base / "other_frame")[0])
        stress = particles_of(left[0])["stress"]
        self.check(not begun["state_1"].any() and apart(begun["stress"], stress) == 0, "another law's frame")

    def test_decks(self, language):
        """Blocks of random states, moved at random."""
        model, source, states, _ = LAWS[language]
        library = self.build(source, f"{language}.so")
        yielded = 0.0
        for n in range(self.decks):
            dice = np.random.default_rng(1000 + n)
            dim = self.dims[n % len(self.dims)]
            young, poisson = 10 ** dice.uniform(5.5, 8), dice.choice([0.0, 0.2, 0.3, dice.uniform(0.3, 0.45), 0.49])
            strength = young * 10 ** dice.uniform(-3.5, -2)
            values = {"young": young, "poisson": poisson}
            if model == "von_mises":
                values["su"] = strength
            else:
                phi = dice.choice([0.0, 20.0, dice.uniform(5, 45)])
                values |= {"cohesion": strength, "friction_deg": phi, "dilation_deg": phi * dice.choice([0, 1, dice.uniform()])}
            values = {key: float(value) for key, value in values.items()}
            cells = 4 if dim == 3 else 8
            position = particles.lattice([1.0] * dim, [1.0 + cells] * dim, 0.5)
            count = len(position)
            stress = strength * dice.choice([0.5, 1, 3]) * dice.uniform(-1, 1, (count, 6))
            stress[:, :3] += strength * dice.uniform(-4, 0.5)
            if dim == 2:
                stress[:, 4:] = 0
            speed = np.sqrt(young / 1800) * 10 ** dice.uniform(-4, -2.3)
            path = self.base / "random.h5"
            particles.write(path, "soil", position, 0.5, velocity=speed * dice.uniform(-1, 1, (count, dim)), stress=stress)
            side = ",".join(["0"] * dim), ",".join([str(cells + 2)] * dim)
            deck = ["-dim", dim, "-mesh_lower", side[0], "-mesh_upper", side[1], "-mesh_spacing", "1", "-materials", "clay",
                    "-clay_density", "1800", "-bodies", "soil", "-soil_material", "clay", "-soil_shape", "particles", "-soil_file",
                    path, "-time_end", "1e6", "-time_max_steps", "20", "-history_interval", "1e6", "-output_interval", "1e6",
                    "-f_bar_fraction", "0.98",  # of both: by default it is 0 where a built-in law dilates
                    "-time_step", repr(float(0.3 / np.sqrt(young * (1 - poisson) / (1 + poisson) / (1 - 2 * poisson) / 1800)))]
            own = ["-clay_model", model, *[word for key, value in values.items() for word in (f"-clay_{key}", repr(value))]]
            wanted, _ = self.run("deck_own", *deck, *own)
            ranks, threads = dice.choice([1, 1, 1, 2]), dice.choice([1, 2])
            found, _ = self.run("deck_umat", *deck, *self.umat(library, values.values(), states), ranks=int(ranks), threads=int(threads))
            what = f"deck {n} ({dim}D, {ranks} ranks, {threads} threads, {values})"
            state = self.same(frames(found)[-1], frames(wanted)[-1], what)
            yielded += (state["plastic_strain"] > 0).mean() / self.decks
        self.check(yielded > 0.3, f"{yielded:.2g} of the random states have yielded")
        print(f"{self.decks} random decks, {yielded:.2g} of their particles yielded")

    def block(self, dim, *more):
        """A block that turns and strains freely."""
        position = particles.lattice([2.0] * dim, [6.0] * dim, 0.5)
        centre = position - 4
        gradient = np.array([[3.0, -40, 20], [45, -2, -30], [-15, 35, 1]])[:dim, :dim]
        path = self.base / f"block_{dim}.h5"
        particles.write(path, "soil", position, 0.5, velocity=centre @ gradient.T)
        side = ",".join(["0"] * dim), ",".join(["8"] * dim)
        return ["-dim", dim, "-mesh_lower", side[0], "-mesh_upper", side[1], "-mesh_spacing", "1", "-materials", "clay",
                "-clay_density", "1800", "-bodies", "soil", "-soil_material", "clay", "-soil_shape", "particles", "-soil_file",
                path, "-history_interval", "1e6", *more], gradient

    def test_probe(self):
        library = self.build(HERE / "probe.c", "probe.so")
        step = 1e-3
        for dim in self.dims:
            deck, gradient = self.block(dim, "-time_step", step, "-f_bar_fraction", "0", "-output_interval", step, "-time_end",
                                        4 * step)
            folder, _ = self.run("probe", *deck, *self.umat(library, [1e6, 0.3], 38))
            before, after = (particles_of(frame) for frame in frames(folder)[:2])
            last, previous = particles_of(frames(folder)[4]), particles_of(frames(folder)[3])
            state = np.stack([after[f"state_{k + 1}"] for k in range(38)], axis=1)
            count = len(state)
            inner = (np.abs(before["position"][:, :dim] - 4) < 1).all(axis=1)
            rotation = state[:, 6:15].reshape(count, 3, 3).transpose(0, 2, 1)
            moved = state[:, 26:35].reshape(count, 3, 3).transpose(0, 2, 1)
            spin, full = np.zeros((3, 3)), np.zeros((3, 3))
            full[:dim, :dim] = gradient * step
            spin[:dim, :dim] = (gradient - gradient.T) / 2 * step
            exact = np.linalg.solve(np.eye(3) - spin / 2, np.eye(3) + spin / 2)
            strains = (full + full.T) / 2
            order = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
            wanted = np.array([strains[i, j] * (1 if i == j else 2) for i, j in order])
            if dim == 2:
                wanted[4:] = 0
            for good, what in (
                    ((np.sort(state[:, 0]) == np.arange(1, count + 1)).all(), "NOEL"),
                    ((state[:, 1] == 0).all() and (state[:, 2] == step).all(), "TIME and DTIME"),
                    (apart(state[:, 3:3 + dim], before["position"][:, :dim]) < 1e-12, "COORDS"),
                    (np.abs(rotation @ rotation.transpose(0, 2, 1) - np.eye(3)).max() < 1e-14, "DROT is a rotation"),
                    (np.abs(rotation[inner] - exact).max() < 1e-12 and inner.any(), "DROT"),
                    (np.abs(moved[inner] - np.eye(3) - full).max() < 1e-12, "DFGRD1"),
                    (np.abs(state[inner, 15:21] - wanted).max() < 1e-12, "STRAN + DSTRAN"),
                    ((state[:, 21] == (4 if dim == 2 else 6)).all() and (state[:, 36] == 38).all(), "NTENS and NSTATV"),
                    ((state[:, 22] == 1).all() and (state[:, 23] == 1).all(), "CELENT and KINC"),
                    ((state[:, 24] == ord("C")).all() and (state[:, 25] == 1).all(), "CMNAME, and one call a step"),
                    ((state[:, 35] == 4).all(), "LAYER, KSPT, NPT and KSTEP"),
                    ((last["state_26"] == 4).all() and (last["state_24"] == 4).all(), "calls and KINC of 4 steps"),
                    (apart(np.stack([last[f"state_{k}"] for k in range(4, 4 + dim)], 1), previous["position"][:, :dim]) < 1e-12,
                     "COORDS later"),
                    (apart(last["state_2"], np.full(count, 3 * step)) < 1e-12, "TIME later"),
                    (last["state_38"].max() < 1e-15, f"ROTSIG turns strains as STRAN: {last['state_38'].max():.3g}"),
                    (last["strain_xx"].any() and apart(last["strain_xy"] * 2, last["state_19"]) < 1e-12,
                     "strains of the frames")):
                self.check(good, f"probe in {dim}D: {what}")
            elastic, _ = self.run("elastic", *deck, "-clay_model", "linear_elastic", "-clay_young", "1e6", "-clay_poisson", "0.3")
            self.check(apart(last["stress"], particles_of(frames(elastic)[4])["stress"]) < 1e-13, f"stress of the probe in {dim}D")

    def test_gives_up(self):
        library = self.build(HERE / "probe.c", "probe.so")
        law = "was given up by its UMAT, which set PNEWDT below 1 or called XIT"
        state = "has a state variable of its law that is not finite"
        for dim in self.dims:
            for how, words in ((1, [law]), (2, [law]), (3, ["stress", "not finite"]), (9, [state]), (10, [state])):
                for ranks, threads in ((1, 1), (1, 2), (2, 1)):
                    deck, _ = self.block(dim, "-time_step", 1e-3, "-time_end", 1)
                    folder, done = self.run("gives_up", *deck, *self.umat(library, [1e6, 0.3, how, 0.02], 38), status=3,
                                            ranks=ranks, threads=threads)
                    lines = [line for line in done.stderr.splitlines() if "particle" in line]
                    what = f"gives up {how} in {dim}D, {ranks} ranks, {threads} threads: {done.stderr}"
                    self.check(len(lines) == 1 and all(word in lines[0] for word in ["of body soil at (", "step", *words]), what)
                    self.check(how != 2 or "umat: strain 0.25 in step 7 of probe" in done.stderr, what)
                    self.check(frames(folder) and contents(frames(folder)[0]), "frames before the failure")

    def test_ends(self):
        library = self.build(HERE / "probe.c", "probe.so")
        for dim in self.dims:
            deck, _ = self.block(dim, "-time_step", 1e-3, "-time_end", 1)
            for how in (6, 7, 8):
                for ranks, threads in ((1, 1), (1, 2), (2, 1)):
                    _, done = self.run("ends", *deck, *self.umat(library, [1e6, 0.3, how, 0.02], 38), status=3, ranks=ranks,
                                       threads=threads)
                    lines = [line for line in done.stderr.splitlines() if "ended the program" in line]
                    words = ("mpm: step ", "the UMAT of material clay", "at particle ", " of the run, at (")
                    self.check(lines and all(word in lines[0] for word in words),
                               f"ends {how} in {dim}D, {ranks} ranks, {threads} threads: {done.stderr}")
            self.refused(f"takes a UMAT that returns to its caller; it ended the program (exit, or STOP in Fortran) when it was called",
                         *self.umat(library, [1e6, 0.3, 11], 38))
        (self.base / "loaded.c").write_text("#include <stdlib.h>\n__attribute__((constructor)) static void leave(void) { exit(0); }\n"
                                            "void umat(void) {}\n")
        self.refused("(exit, or STOP in Fortran) as it was loaded", *self.umat(self.build(self.base / "loaded.c", "loaded.so"), [1e6, 0.3]))
        if shutil.which(os.environ.get("FC", "gfortran")):
            (self.base / "stop.f").write_text("      SUBROUTINE UMAT\n      STOP\n      END\n")
            self.refused("ended the program", *self.umat(self.build(self.base / "stop.f", "stop.so"), [1e6, 0.3]))

    def paths_of(self, dim, size):
        """Paths {name: columns}: by strains, with states that turn, and with stresses that are kept."""
        dice, count = np.random.default_rng(dim), 40
        axes = ("xx", "yy", "zz", "xy", "yz", "zx")[:4 if dim == 2 else 6]
        # Lateral stresses differ: soil at an edge of the yield surface may share its flow among the two planes in any way.
        start = {key: [stress] * (count + 1) for key, stress in (("sxx", -2e5), ("syy", -2e5), ("szz", -2.01e5))}
        turns = np.cumsum(dice.uniform(-1, 1, (count + 1, len(axes))), axis=0) * size
        by_strain = {"dt": [0] + [0.5] * count, **{"e" + c: turns[:, k] - turns[0, k] for k, c in enumerate(axes)}, **start}
        shear = np.concatenate([[0], -size * np.sign(np.sin(np.arange(count) / 7 + 0.1))])
        triaxial = {"dt": [0] + [0.5] * count, "deyy": shear, "dsxx": [0] * (count + 1), "dszz": [0] * (count + 1), **start}
        constant_mean = {"deyy": shear, "dexy": shear / 3, "dsxx+dsyy+dszz": [0] * (count + 1), "dsxx-dszz": [0] * (count + 1),
                         **start}
        return {"strains": by_strain, "triaxial": triaxial, "constant mean": constant_mean}

    def drive(self, law, columns, dim, *more, name="driver", status=0):
        path = self.base / "path.csv"
        point.write_path(path, columns)
        pairs = zip(["-materials", "-clay_density", *law[::2]], ["clay", 1800, *law[1::2]])
        deck = "".join(f"{option} {value}\n" for option, value in pairs)
        return point.run_point(self.binary, fresh(self.base / name), deck, path, "-dim", dim, *more, status=status)

    def test_driver(self, language):
        """A point along the same path through a law and through its UMAT: the same to 1e-12 of the largest value."""
        own, umat = self.laws(language)
        worst = 0.0
        for dim in self.dims:
            for name, columns in self.paths_of(dim, 5e-3).items():
                wanted, found = self.drive(own, columns, dim), self.drive(umat, columns, dim)
                self.check(found["plastic_strain" if "plastic_strain" in found else "state_1"][-1] > 1e-3, f"{name} has not yielded")
                stress = max(np.abs(wanted[key]).max() for key in point.STRESS)
                strain = max(np.abs(wanted[key]).max() for key in point.STRAIN)
                for keys, size in ((point.STRESS, stress), (point.STRAIN, strain)):
                    for key in keys:
                        worst = max(worst, np.abs(np.subtract(found[key], wanted[key])).max() / size)
                worst = max(worst, apart(np.array(found["state_1"]), np.array(wanted["plastic_strain"])))
                for key, c in (("strain_" + c, "e" + c) for c in point.COMPONENTS):  # what the law itself has summed
                    worst = max(worst, np.abs(np.subtract(found[key], found[c])).max() / strain)
                self.check(worst <= 1e-12, f"driver, {name} in {dim}D: {worst:.3g}")
        self.worst = max(self.worst, worst)
        print(f"driver: the built-in law and its UMAT differ by {worst:.2g}")

    def test_driver_given(self):
        """Arguments that the probe gets along a path; the probe may give up, and a path may go on from another's end."""
        library = self.build(HERE / "probe.c", "probe.so")
        for dim in self.dims:
            path = {"time": [2, 3, 5], "exx": [0, 1e-3, 3e-3], "eyy": [0, 0, -1e-3], "exy": [0, 2e-3, 2e-3]}
            law = self.umat(library, [1e6, 0.3], 38)
            found = self.drive(law, path, dim, "-element_parts", 4, "-element_height", -7)
            for key, right in {"state_1": 1, "state_2": 4.5, "state_3": 0.5, "state_4": 0, "state_5": -7 if dim == 2 else 0,
                               "state_6": 0 if dim == 2 else -7, "state_16": 3e-3, "state_17": -1e-3, "state_19": 4e-3,
                               "state_22": 4 if dim == 2 else 6, "state_23": 1, "state_24": 10, "state_25": ord("C"),
                               "state_26": 8, "state_37": 38}.items():
                self.check(abs(found[key][-1] - right) <= 1e-12 * max(abs(right), 1e-3), f"{key} is {found[key][-1]}, not {right}")
            elastic = self.drive(["-clay_model", "linear_elastic", "-clay_young", "1e6", "-clay_poisson", "0.3"], path, dim)
            for key in point.STRESS:
                self.check(abs(found[key][-1] - elastic[key][-1]) <= 1e-9, f"{key} of the probe in {dim}D")
            rest = {key: values[1:] for key, values in found.items()}
            again = self.drive(law, rest, dim, "-element_parts", 4, "-element_height", -7)
            for key in ("sxx", "sxy", "strain_xx", "state_26"):
                self.check(abs(again[key][-1] - found[key][-1]) <= 1e-12 * abs(found[key][-1]), f"{key} of a path that goes on")
            for how in (1, 2, 3):
                lines = self.drive(self.umat(library, [1e6, 0.3, how, 1e-3], 38), path, dim, status=3)
                printed = [line for line in lines if line.startswith("mpm: row ")]
                self.check(len(printed) == 1 and "the law fails, or its stress is not finite" in printed[0], f"gives up {how}: {lines}")
        lines = self.drive(self.umat(library, [1e6, 0.3], 38), path, 2, "-precision", "single", status=2)
        self.check(lines == ['mpm: -clay_model: given "umat", takes another model with -precision single: umat takes '
                             '-precision double'], f"driven in single precision: {lines}")
        lines = self.drive(self.umat(self.base / "none.so", [1e6, 0.3]), path, 2, status=2)
        self.check(len(lines) == 1 and lines[0].startswith("mpm: -clay_library: given"), f"driven without a library: {lines}")

    def object_file(self):
        """An ELF file of another type: an object file."""
        (self.base / "object.c").write_text("void umat(void) {}\n")
        path = self.base / "object.so"
        subprocess.run([os.environ.get("CC", "cc"), "-c", "-o", path, self.base / "object.c"], check=True)
        return path

    def refused(self, words, *options):
        deck, _ = self.block(2, "-time_end", "1e-3")
        folder, done = self.run("refused", *deck, *options, status=2)
        lines = done.stderr.strip().splitlines()
        self.check(len(lines) == 1 and words in lines[0], f"refused: {words}\n{done.stderr}")
        self.check(not folder.exists() or not any(folder.iterdir()), f"refused: {words}: something was written")

    def test_refused(self):
        library = self.build(HERE / "probe.c", "probe.so")
        elastic = [1e6, 0.3]
        text, empty, bare = (self.base / name for name in ("text.so", "folder.so", "bare.so"))
        text.write_text("no library\n")
        empty.mkdir(exist_ok=True)
        (self.base / "bare.c").write_text("int nothing_here = 1;\n")
        (self.base / "open.c").write_text("void missing_(void); void umat(void) { missing_(); }\n")
        self.build(self.base / "bare.c", "bare.so")
        unbound = self.build(self.base / "open.c", "open.so")
        whole, cuts = library.read_bytes(), {}
        for size in (3, 40, 1000, len(whole) // 2, len(whole) - 1):
            cuts[size] = self.base / f"cut_{size}.so"
            cuts[size].write_bytes(whole[:size])
            self.refused("it is no ELF file" if size < 4 else "it is cut short: ", *self.umat(cuts[size], elastic))
        other = self.base / "processor.so"
        other.write_bytes(whole[:18] + b"\xf3\x00" + whole[20:])  # RISC-V
        self.refused("it is for another processor", *self.umat(other, elastic))
        self.refused("not a shared library", *self.umat(self.object_file(), elastic))
        for path, words in ((self.base / "none.so", "takes a shared library, which is a regular file that can be read"),
                            (empty, "takes a shared library, which is a regular file that can be read"),
                            (text, "takes a shared library that can be loaded; "),
                            (unbound, "missing_"),
                            (bare, "takes a shared library with a subroutine UMAT (symbol umat_, or umat of C); it has none")):
            self.refused(words, *self.umat(path, elastic))
            self.refused("-clay_library: given", *self.umat(path, elastic))
        self.refused("-clay_library: given", *self.umat(library, [*elastic, 4]))
        self.refused("-clay_wave_modulus: not given, takes a modulus in Pa here", *self.umat(library, [*elastic, 5]))
        self.refused("-clay_states: given \"1.5\", takes a whole number from 0 to 64", *self.umat(library, elastic, 1.5))
        self.refused("-clay_state_start: given \"1,2\", takes as many numbers as -clay_states, which is 3",
                     *self.umat(library, elastic, 3, "-clay_state_start", "1,2"))
        self.refused("-clay_model: given \"umat\", takes another model with -precision single",
                     *self.umat(library, elastic), "-precision", "single")
        folder, _ = self.run("start", *self.block(2, "-time_end", "1e-3")[0],
                             *self.umat(library, [*elastic, 5], 3, "-clay_state_start", "0.5,2,-3", "-clay_wave_modulus", "2e6"))
        state = particles_of(frames(folder)[0])
        self.check([state[f"state_{k}"][0] for k in (1, 2, 3)] == [0.5, 2, -3] and (state["wave_modulus"] == 2e6).all(),
                   "states at the start")
        # A run with another library is another run.
        deck = self.block(2, "-time_end", "2e-3", "-checkpoint_interval", "1e-3")[0]
        folder, _ = self.run("kept", *deck, *self.umat(library, elastic))
        other = self.base / "other.so"
        shutil.copy(library, other)
        _, done = self.run("kept", *deck, *self.umat(other, elastic), "-restart", checkpoints(folder)[0], status=2)
        self.check("-clay_library: given" in done.stderr, f"another library at a restart: {done.stderr}")
        _, done = self.run("dry", *deck, *self.umat(library, elastic, 38), "-dry_run")
        self.check("particles" in done.stdout, "a dry run")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("tests", nargs="*", default=["c", "fortran", "driver", "probe", "gives_up", "ends", "refused"])
    parser.add_argument("--decks", type=int, default=60)
    parser.add_argument("--dims", default="2,3")
    args = parser.parse_intermixed_args()
    compilers = {"fortran": os.environ.get("FC", "gfortran")}
    asked = [name for name in args.tests if shutil.which(compilers.get(name, os.environ.get("CC", "cc")))]
    for name in set(args.tests) - set(asked):
        print(f"check.py: {name} is left out: no compiler {compilers.get(name, 'cc')}")
    if not asked:
        sys.exit(77)
    tests = Tests(args)
    for name in asked:
        if name in LAWS:
            tests.test_driver(name)
            tests.test_language(name)
            tests.test_decks(name)
        elif name == "driver":
            tests.test_driver_given()
        else:
            getattr(tests, f"test_{name}")()
        print(f"{name}: {tests.count} checks so far, largest difference from the built-in laws {tests.worst:.2g}", flush=True)


if __name__ == "__main__":
    main()
