#!/usr/bin/env python3
"""Additions to the program and their cost. A law with two state variables is one header and one line, a vector of every particle is a
member and a row in two headers, and a kind of side of the mesh is one header, its rows in the tables of kinds and numbers, and one
line. This adds path_dependent.hpp, the vector `tracer` and the side `spring` (spring_side.hpp) to a copy of the program, builds it,
and holds what its runs give against what it must be.

    check.py SOURCE BUILD [--jobs N]

SOURCE is the source tree, BUILD a folder for the copy and what is built of it. Where the dependencies are comes from
BUILD/../CMakeCache.txt.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess

import h5py
import numpy as np

from mpm_regression.folders import ENVIRONMENT, checkpoints, differences, fresh, history, of_velocities

HERE = pathlib.Path(__file__).resolve().parent
DECK, SPRING_DECK = HERE / "block.opts", HERE / "spring.opts"

VARIABLES = {"created_at": "m", "shear_path": "-"}


def put(path, text):
    """Writes a file where it is not so already, so that what has not changed is not built again."""
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


LAW = {  # file: what stands before an addition, and the addition
    "kokkos_kernels/physics/materials/list.hpp": [
        ('#include "physics/materials/newtonian.hpp"\n', '#include "physics/materials/path_dependent.hpp"\n'),
        ("SofteningClay, Umat", ", PathDependent")],
}
VECTOR = {
    "kokkos_kernels/data/particles.hpp": [
        ("  Kokkos::View<Vector<T, Dim>*, Memory> velocity;   // m/s\n", "  Kokkos::View<Vector<T, Dim>*, Memory> tracer;     // m\n"),
        ('  f(ParticleField{"velocity", changes, mass_mean}, s.velocity, others.velocity...);\n',
         '  f(ParticleField{"tracer", none, mass_mean}, s.tracer, others.tracer...);\n')],
    "kokkos_kernels/data/particle_columns.hpp": [
        ("  std::vector<double> velocity{};  // m/s [dim N]\n", "  std::vector<double> tracer{};    // m [dim N]\n"),
        ("inline constexpr ParticleColumn k_particle_columns[] = {\n",
         '    {"tracer", "tracer", "m", &ParticleColumns::tracer, Width::vector, Carried::where_kept, GivenBy::none,\n'
         "     Common::zero, Framed::bodies, 0, Bound::none},\n")],
}
SIDE = {
    "kokkos_kernels/base/side_kinds.hpp": [
        ("friction, absorbing, driven, free_field", ", spring"),
        ('    {"periodic", Wall::periodic, "the opposite side, which is periodic too"},\n',
         '    {"spring", Wall::spring, "springs normal to it"},\n'),
        ("// m; 0: no springs\n", "  double stiffness = 0;  // Pa/m\n"),
        ('     "no springs"},\n',
         '    {"stiffness", &SideNumbers::stiffness, [](Wall kind) { return kind == Wall::spring; }, "Pa/m",\n'
         '     "spring: stiffness of the springs of an area", 1e15, false, "", true},\n')],
    "kokkos_kernels/physics/sides.hpp": [
        ('#include "physics/side_node.hpp"\n', '#include "physics/spring_side.hpp"\n'),
        ("  for (int k = 0; k < Dim; ++k) v[k] = v_now[k];\n", "  if (meets) press_springs(acting, node, v_old, v);\n")],
}
ADDITIONS = {  # what is added, its header of this folder and where it goes, and the files that it modifies
    "law": ("kokkos_kernels/physics/materials/path_dependent.hpp", LAW),
    "vector": (None, VECTOR),
    "side": ("kokkos_kernels/physics/spring_side.hpp", SIDE),
}
MOST_FILES = 2  # that an addition modifies


def count_files():
    """Prints how many files of the program each addition modifies."""
    for name, (header, files) in ADDITIONS.items():
        added = f", and adds {pathlib.Path(header).name}" if header else ""
        print(f"the {name:6} modifies {len(files)} ({', '.join(pathlib.Path(file).name for file in files)}){added}", flush=True)
        assert len(files) <= MOST_FILES, (name, list(files))


def with_additions(text, additions):
    """A source with the lines that are added to it."""
    for before, line in additions:
        assert text.count(before) == 1, before
        text = text.replace(before, before + line)
    return text


def copy_with_additions(source, copy):
    """The program's source with the law, the vector and the side."""
    modified = {}
    for header, files in ADDITIONS.values():
        if header:
            put(copy / header, (HERE / pathlib.Path(header).name).read_text())
        for file, additions in files.items():
            modified.setdefault(file, []).extend(additions)
    for part in ("CMakeLists.txt", "cmake", "kokkos_kernels", "lib", "app"):
        for path in [source / part] if (source / part).is_file() else (source / part).rglob("*"):
            if path.is_file():
                name = str(path.relative_to(source))
                put(copy / name, with_additions(path.read_text(), modified.pop(name, [])))
    assert not modified, modified


def build(source, folder, jobs):
    """The program with the additions, double precision in 2D alone."""
    copy_with_additions(source, folder / "source")
    cache = (folder.parent / "CMakeCache.txt").read_text()
    known = re.findall(r"^(\w+_ROOT|Kokkos_DIR|CMAKE_PREFIX_PATH|CMAKE_CXX_COMPILER\w*|CMAKE_C_COMPILER):(?!INTERNAL)\w+=(.+)$",
                       cache, re.M)
    known = [f"-D{name}={value}" for name, value in known]
    subprocess.run(["cmake", "-S", folder / "source", "-B", folder / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DMPM_TESTS=OFF",
                    "-DMPM_REALS=double", "-DMPM_DIMS=2", *known], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", folder / "build", "-j", str(jobs), "--target", "mpm"], check=True,
                   stdout=subprocess.DEVNULL)
    return folder / "build/app/mpm"


class Checks:
    def __init__(self, binary, base):
        self.binary, self.base = binary, base
        self.whole = fresh(base / "whole")
        self.go(self.whole)

    def go(self, folder, *options, ranks=1, status=0, deck=DECK):
        launch = ["mpirun", "-n", str(ranks), "--bind-to", "none"] if ranks > 1 else []
        done = subprocess.run([*launch, str(self.binary), "-options_file", str(deck), "-output_dir", str(folder), "-backend", "serial",
                               "-progress", "off", *map(str, options)], capture_output=True, text=True,
                              env={**ENVIRONMENT, "OMPI_MCA_rmaps_base_oversubscribe": "1"}, timeout=600)
        assert done.returncode == status, (done.returncode, done.stdout[-2000:], done.stderr)
        return done.stdout + done.stderr

    def last_frame(self, folder):
        return h5py.File(sorted(folder.glob("frames/frame_*.h5"))[-1])

    def check_frames(self):
        """Frames hold each variable by its name, of the bodies whose law has it, sorted with its particle."""
        with h5py.File(self.whole / "frames/frame_00000.h5") as start, self.last_frame(self.whole) as end:
            for name, unit in VARIABLES.items():
                assert end[f"block/{name}"].attrs["unit"] in (unit, unit.encode()), dict(end[f"block/{name}"].attrs)
                assert f"heap/{name}" not in end
            assert np.array_equal(end["block/created_at"][:], start["block/position"][:, 0])
            moved = end["block/position"][:, 0] - start["block/position"][:, 0]
            assert moved.min() > 1, "the block has left its first cells, so that its particles were sorted anew"
            path = end["block/shear_path"][:]
            assert (start["block/shear_path"][:] == 0).all() and path.min() > 0 and np.ptp(path) > 1e-3
            assert end["heap/plastic_strain"][:].max() > 0
        index = (self.whole / "particles.xdmf").read_text()
        assert all(name in index for name in VARIABLES)

    def check_ranks(self):
        """State goes with its particle from rank to rank."""
        with self.last_frame(self.whole) as one:
            for ranks in (2, 3):
                folder = fresh(self.base / f"ranks_{ranks}")
                self.go(folder, "-p2g", "gather", ranks=ranks)
                with self.last_frame(folder) as several:
                    assert np.array_equal(several["block/created_at"][:], one["block/created_at"][:])
                    apart = np.abs(several["block/shear_path"][:] - one["block/shear_path"][:]).max()
                    assert apart < 1e-9, (ranks, apart)

    def check_restart(self):
        """A run that goes on from a checkpoint gives the same bits, and another may start from its state."""
        folder = fresh(self.base / "again")
        shutil.copytree(self.whole, folder)
        first = checkpoints(folder)[0]
        self.go(folder, "-restart", first)
        assert not differences(self.whole, folder), differences(self.whole, folder)
        lines = [line for line in DECK.read_text().splitlines() if not re.match("-block_(shape|lower|upper|velocity)|-heap_|-bodies", line)]
        deck = self.base / "start.opts"
        for source in (sorted(self.whole.glob("frames/frame_*.h5"))[-1], checkpoints(self.whole)[-1]):
            deck.write_text("\n".join([*lines, "-bodies block", "-block_shape particles", f"-block_file {source}"]) + "\n")
            started = fresh(self.base / "started")
            self.go(started, "-time_max_steps", 1, deck=deck)
            with h5py.File(started / "frames/frame_00000.h5") as start, self.last_frame(self.whole) as end:
                assert np.array_equal(start["block/shear_path"][:], end["block/shear_path"][:])

    def check_vector(self):
        """A vector comes from a file, goes with its particle from cell to cell and from rank to rank, through checkpoints, and into
        frames, from which another run starts."""
        listed = self.base / "traced.h5"
        shutil.copyfile(self.whole / "frames/frame_00000.h5", listed)
        with h5py.File(listed, "a") as file:
            file["block/tracer"][:] = file["block/position"][:]
        deck = self.base / "traced.opts"

        def from_file(path, left_out):
            lines = [line for line in DECK.read_text().splitlines() if not re.match(left_out, line)]
            bodies = ["-bodies block"] if "-bodies" in left_out else []
            deck.write_text("\n".join([*lines, *bodies, "-block_shape particles", f"-block_file {path}"]) + "\n")

        from_file(listed, "-block_(shape|lower|upper|velocity)")
        one = fresh(self.base / "traced")
        self.go(one, deck=deck)
        with h5py.File(listed) as start, self.last_frame(one) as end:
            assert np.array_equal(end["block/tracer"][:], start["block/position"][:])
            assert (end["heap/tracer"][:] == 0).all() and end["block/tracer"].attrs["unit"] in ("m", b"m")
        for ranks in (2, 3):
            several = fresh(self.base / f"traced_{ranks}")
            self.go(several, "-p2g", "gather", ranks=ranks, deck=deck)
            with self.last_frame(several) as there, self.last_frame(one) as here:
                assert np.array_equal(there["block/tracer"][:], here["block/tracer"][:]), ranks
        again = fresh(self.base / "traced_again")
        shutil.copytree(one, again)
        self.go(again, "-restart", checkpoints(again)[0], deck=deck)
        assert not differences(one, again), differences(one, again)
        for source in (sorted(one.glob("frames/frame_*.h5"))[-1], checkpoints(one)[-1]):
            from_file(source, "-block_(shape|lower|upper|velocity)|-heap_|-bodies")  # the block lies on the heap now
            started = fresh(self.base / "traced_start")
            self.go(started, "-time_max_steps", 1, deck=deck)
            with h5py.File(started / "frames/frame_00000.h5") as start, self.last_frame(one) as end:
                assert np.array_equal(start["block/tracer"][:], end["block/tracer"][:]), source

    def steps_of(self, folder):
        """Columns step, time and dt of a history."""
        return np.genfromtxt(folder / "history.csv", delimiter=",", names=True)[["step", "time", "dt"]]

    def check_time(self):
        """A law gets the time: the path counts from then on."""
        folder = fresh(self.base / "since")
        self.go(folder, "-soft_since", 0.45)
        for frame in sorted(folder.glob("frames/frame_*.h5")):
            with h5py.File(frame) as now:
                assert (now["block/shear_path"][:].max() > 0) == (now.attrs["time"] > 0.45), (frame, now.attrs["time"])

    def check_time_step(self):
        """The step follows the fastest wave, the same on ranks; a fixed one that becomes unsafe ends the run."""
        alone = self.base / "alone.opts"
        alone.write_text("".join("-bodies block\n" if line.startswith("-bodies") else line
                                 for line in DECK.read_text().splitlines(True) if not line.startswith("-heap_")))
        printed = {}
        for change in (-3, 30):
            more = ("-soft_change", change, "-block_lower", "0.5,0", "-block_upper", "1.5,0.75", "-block_velocity", "1,-1")
            folder = fresh(self.base / "follows")
            printed[change] = self.go(folder, *more, deck=alone)
            one = self.steps_of(folder)
            with self.last_frame(folder) as end:
                young = 4e5 * np.maximum(0.1, 1 + change * np.maximum(0, end["block/shear_path"][:] - 1e-3))
                modulus = young * 0.7 / (1.3 * 0.4)
                wave = np.sqrt((modulus * end["block/volume"][:] / end["block/mass"][:]).max())
            assert abs(one["dt"][-2] / (0.5 * 0.125 / wave) - 1) < 0.03, (one["dt"][-3:], 0.5 * 0.125 / wave)
            assert abs(one["dt"][-2] / one["dt"][0] - 1) > 0.05, one["dt"]
            assert (np.diff(one["time"]) > 0).all() and one["time"][-1] == 0.6
            folder = fresh(self.base / "follows_on_ranks")
            self.go(folder, *more, "-p2g", "gather", deck=alone, ranks=2)
            assert np.abs(self.steps_of(folder)["dt"] / one["dt"] - 1).max() < 1e-9
        assert "the time step follows the stiffness of the soil" in printed[30], printed[30]
        text = self.go(fresh(self.base / "fixed"), *more, "-time_step", 2.2e-3, deck=alone, status=3)
        assert re.search(r"mpm: step \d+, time [\d.]+ s: -time_step: given \"0.0022\", takes at most", text), text

    def check_dry_run(self):
        """The dry run counts the columns in use, and prints the fields."""
        sizes = {}
        plain = self.base / "plain.opts"
        plain.write_text("".join(line for line in DECK.read_text().splitlines(True) if "change" not in line and "threshold" not in line))
        for model in ("path_dependent", "linear_elastic"):
            more = ("-soft_model", model, "-heap_material", "soft", "-mesh_spacing", 0.02, "-block_particles_per_cell", 8)
            text = self.go(self.base / "dry", *more, "-dry_run", deck=plain)
            sizes[model] = 1e6 * float(re.search(r"memory +([\d.]+) MB on the device", text)[1])
            particles = int(re.search(r"(\d+) particles", text)[1])
        more = (sizes["path_dependent"] - sizes["linear_elastic"]) / particles
        assert 0.9 < more / (len(VARIABLES) * 8) < 2.1, (sizes, particles)  # room for growth and sorting is more of the same

    def check_message(self):
        """The law's own check of its parameters is one line with the option."""
        text = self.go(self.base / "wrong", "-soft_threshold", 0, status=2)
        assert "-soft_threshold: given \"0\", takes a path greater than 0 where -soft_change is given" in text, text

    def check_side(self):
        """A column on springs oscillates as a mass on a spring, and takes from them the work that it gives them."""
        mass, spring, start = 2000.0, 4e6 * 2.0, 1e-3  # kg/m, N/m of the side, m/s
        omega = np.sqrt(spring / mass)
        one = fresh(self.base / "spring")
        self.go(one, deck=SPRING_DECK)
        h = history(one)
        momentum, force, drift = h["column_momentum_y"], h["wall_ymin_force_y"], h["column_centre_y"] - h["column_centre_y"][0]
        zeros = np.flatnonzero(np.diff(np.sign(momentum)))  # twice a period
        at = of_velocities(h["time"], h["dt"])
        when = at[zeros] - momentum[zeros] * np.diff(at)[zeros] / np.diff(momentum)[zeros]
        found = np.pi / np.diff(when).mean()
        assert len(zeros) == 4 and abs(found / omega - 1) < 5e-3, (when, found, omega)
        size = start / omega
        assert np.abs(drift + size * np.sin(omega * h["time"])).max() < 0.04 * size
        # The force of a row is the mean since the row before.
        taken = force[1:] * np.diff(h["time"]) + np.diff(momentum)
        assert np.abs(taken).max() < 1e-9 * mass * start, np.abs(taken).max()
        mean = spring * (drift[1:] + drift[:-1]) / 2
        assert np.abs(force[1:] - mean).max() < 0.01 * spring * size, np.abs(force[1:] - mean).max() / (spring * size)
        energy = mass * start**2 / 2
        kept = h["energy_kinetic"] + h["energy_elastic"] - h["work_contact"]
        assert np.abs(kept / energy - 1).max() < 5e-3 and np.ptp(h["work_contact"]) > 0.98 * energy, (kept / energy).tolist()
        stored = h["energy_kinetic"] + spring * drift**2 / 2
        assert abs(stored[-1] / energy - 1) < 0.02, stored[-1] / energy
        again = fresh(self.base / "spring_again")
        shutil.copytree(one, again)
        self.go(again, "-restart", checkpoints(again)[0], deck=SPRING_DECK)
        assert not differences(one, again), differences(one, again)
        several = fresh(self.base / "spring_2")
        self.go(several, "-p2g", "gather", ranks=2, deck=SPRING_DECK)
        there = history(several)
        for name, size in (("wall_ymin_force_y", np.abs(force).max()), ("column_momentum_y", mass * start), ("work_contact", energy)):
            assert np.abs(there[name] - h[name]).max() < 1e-9 * size, (name, np.abs(there[name] - h[name]).max() / size)
        text = self.go(self.base / "wrong", "-mesh_xmax_stiffness", 1, status=2, deck=SPRING_DECK)
        assert "-mesh_xmax_stiffness" in text and "-mesh_xmax is roller" in text, text
        text = self.go(self.base / "wrong", "-mesh_xmax", "spring", status=2, deck=SPRING_DECK)
        assert "-mesh_xmax_stiffness: not given, takes a number in Pa/m" in text, text
        print(f"             omega {found:.4f} 1/s of the column on springs, {omega:.4f} exact")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    count_files()
    checks = Checks(build(given.source.resolve(), given.build.resolve(), given.jobs), given.build.resolve() / "runs")
    for name in (name for name in dir(checks) if name.startswith("check_")):
        getattr(checks, name)()
        print(f"{name[6:]:12} as it should be", flush=True)


if __name__ == "__main__":
    main()
