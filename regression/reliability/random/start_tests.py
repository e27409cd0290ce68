"""Starts from a frame or a checkpoint of another run, and restarts with other options: tests that are not random."""
import dataclasses

import h5py
import numpy as np

from deck import Deck, Machine
from mpm_regression.folders import checkpoints, frames, fresh, history, run

FIELDS = ("position", "velocity", "stress", "volume", "plastic_strain", "mass", "reference_height")
PLAIN = Machine("serial", "auto")


def column(dim, cells=8, width=2):
    """A column between rollers whose strength grows with depth."""
    side = ",".join(["0"] * (dim - 1) + ["0"]), ",".join([str(width)] * (dim - 1) + [str(cells + 2)])
    top = ",".join([str(width)] * (dim - 1) + [str(cells)])
    vertical = "z" if dim == 3 else "y"
    return (f"-dim {dim} -mesh_lower {side[0]} -mesh_upper {side[1]} -mesh_spacing 1 -mesh_{vertical}min fixed "
            f"-mesh_{vertical}max free -gravity {','.join(['0'] * (dim - 1) + ['-10'])} -materials clay "
            "-clay_model von_mises -clay_density 1800 -clay_young 3e6 -clay_poisson 0.3 -clay_su 5e4 "
            f"-clay_su_gradient 2e3 -clay_su_datum {cells} -bodies soil -soil_material clay").split(), \
        f"-soil_shape box -soil_lower {side[0]} -soil_upper {top}".split()


def from_file(path, *more):
    return ["-soil_shape", "particles", "-soil_file", str(path), *more]


def bodies(path, name="soil"):
    with h5py.File(path) as file:
        return {key: item[()] for key, item in file[name].items()}


def apart(a, b):
    """Largest difference over the largest value."""
    if a.shape != b.shape or not (np.isfinite(a).all() and np.isfinite(b).all()):
        return np.inf
    return float(np.abs(a - b).max()) / max(float(np.abs(b).max()), 1e-300)


def column_of(folder, name):
    return history(folder)[name]


class StartTests(Deck):
    @staticmethod
    def expect(good, what):
        assert good, what

    def do(self, name, *options, ranks=1, status=0):
        """The folder of a run of these options alone, and what it printed."""
        return self.launch(name, *options, options=[], machine=dataclasses.replace(PLAIN, ranks=ranks), status=status)

    def test_column(self):
        exact = self.bound(1e-13, 1e-5)
        columns = ((2, 1, "flip"), (2, 2, "apic"), (3, 1, "apic"), (3, 2, "flip"))
        for dim, ranks, update in columns[:2] if self.given.short else columns:
            base, box = column(dim)
            what = f"{dim}D, {ranks} ranks, {update}"
            common = [*base, "-velocity_update", update, "-damping", 0.7]
            name = f"column_{dim}_{ranks}_{update}"
            end = 2.0
            first, _ = self.do(name, *common, *box, "-time_end", end, "-output_interval", end / 2,
                                "-checkpoint_interval", end, ranks=ranks)
            mark, left = bodies(checkpoints(first)[-1]), bodies(frames(first)[-1])
            self.expect(len(set(left["mass"])) == 1 and len(set(left["volume"])) > 1, f"{what}: masses of a settled column")
            created = bodies(frames(first)[0])
            self.expect((left["reference_height"] == created["position"][:, dim - 1]).all(), f"{what}: reference heights")
            settled = created["position"][:, dim - 1] - left["position"][:, dim - 1]
            self.expect(settled.max() > 0.05, f"{what}: the column settles by {settled.max():.3g} m")
            speeds = column_of(first, "soil_grid_velocity")
            self.expect(speeds[-1] < 0.05 * speeds.max(), f"{what}: {speeds[-1]:.3g} m/s are left of {speeds.max():.3g}")
            for source in (frames(first)[-1], checkpoints(first)[-1]):
                second, _ = self.do(name + "_again", *common, *from_file(source), "-time_end", end / 2,
                                     "-output_interval", end / 2, "-checkpoint_interval", end / 2, ranks=ranks)
                again, end_of_it = bodies(frames(second)[0]), bodies(frames(second)[-1])
                for key in FIELDS:
                    self.expect(apart(again[key], left[key]) <= exact, f"{what}: {key} of {source.name}: "
                               f"{apart(again[key], left[key]):.3g}")
                self.expect((end_of_it["mass"] == left["mass"]).all(), f"{what}: masses at the end")
                strength = bodies(checkpoints(second)[-1])["strength"]
                self.expect(apart(strength, mark["strength"]) <= self.bound(0, 1e-7),
                           f"{what}: strengths of {source.name}")
                wrong = 5e4 + 2e3 * (8 - left["position"][:, dim - 1])
                self.expect(apart(strength[:, 0], wrong) > 1e-3, f"{what}: strengths of creation differ from those of now")
                speed = column_of(second, "soil_grid_velocity").max()
                self.expect(speed < 1.05 * speeds[-1] + 0.005 * speeds.max(),
                           f"{what}: from {source.name} {speed:.3g} m/s, before {speeds[-1]:.3g}, at first {speeds.max():.3g}")
                moved = np.abs(end_of_it["position"] - left["position"]).max()
                self.expect(moved < 0.02 * settled.max(), f"{what}: from {source.name} it moves {moved:.3g} m")

    def test_cut(self):
        """A bank that falls over itself. F-bar brings pressures together when lists are rebuilt, and a start makes them anew:
        only without F-bar the parts are the whole to round-off, with it they differ as a whole run does whose lists are
        rebuilt at other times."""
        round_off = self.bound(1e-12, 2e-3)
        for dim, ranks in ((2, 1), (3, 2)):
            base, box = column(dim, cells=6, width=6)
            box[-1] = ",".join(["3"] * (dim - 1) + ["6"])
            base[base.index("-clay_su") + 1] = "1e3"
            for f_bar in (0, 0.98):
                common = [*base, "-f_bar_fraction", f_bar, "-time_step", 2e-3, "-p2g", "gather"]
                name = f"cut_{dim}_{ranks}"
                ends = [*common, *box, "-time_end", 0.4, "-output_interval", 0.2, "-checkpoint_interval", 0.2]
                whole, _ = self.do(name + "_whole", *ends, ranks=ranks)
                other, _ = self.do(name + "_other", *ends, "-rebuild_margin", 0.35, ranks=ranks)
                before, wanted = (bodies(frames(whole)[k]) for k in (1, -1))
                again = bodies(frames(other)[-1])
                for source in (frames(whole)[1], checkpoints(whole)[0]):
                    part, _ = self.do(name + "_part", *common, *from_file(source), "-time_end", 0.2, ranks=ranks)
                    found = bodies(frames(part)[-1])
                    for key in FIELDS:
                        change = max(apart(wanted[key], before[key]), round_off)
                        differs, usual = (apart(values[key], wanted[key]) / change for values in (found, again))
                        self.expect(differs < (round_off if f_bar == 0 else max(3 * usual, round_off)),
                                   f"cut, {dim}D, {ranks} ranks, F-bar {f_bar}, {source.name}: {key} differs "
                                   f"by {differs:.3g} of its change, with other lists by {usual:.3g}")

    def own_masses(self, path, left, **change):
        with h5py.File(path, "w") as file:
            group = file.create_group("soil")
            for key, values in {**left, **change}.items():
                if values is not None:
                    group[key] = values
        return path

    def test_refused(self):
        base, box = column(2, 4)
        common = [*base, "-time_end", 0.02]
        first, _ = self.do("left", *common, *box, "-output_interval", 0.02, "-checkpoint_interval", 0.02)
        bare, _ = self.do("bare", *common, *box, "-output_interval", 0.02, "-output_fields", "velocity,volume,mass,plastic_strain")
        frame, mark = frames(first)[-1], checkpoints(first)[-1]
        solid, other = column(3, 4)
        left = bodies(frame)
        light = self.own_masses(self.folder / "light.h5", left, mass=left["mass"] / 2)
        damaged = self.folder / "damaged.h5"
        damaged.write_bytes(mark.read_bytes()[:-200] + b"x" + mark.read_bytes()[-199:])
        odd = [str(word).replace("soil", "bank") for word in common]
        cases = [
            ([*common, *from_file(frames(bare)[-1])], ["a frame with soil/stress, which -output_fields of its run left out"]),
            ([*solid, "-time_end", 0.02, *from_file(frame)], ["takes a frame of a run in 3D"]),
            ([*solid, "-time_end", 0.02, *from_file(mark)], ["takes a checkpoint of a run in 3D"]),
            ([*common, *from_file(mark, "-soil_file_body", "sand")], ["takes a checkpoint with the body sand; it has soil"]),
            ([*odd, "-bank_shape", "particles", "-bank_file", str(frame)], ["takes a file with the group bank"]),
            ([*common, *from_file(light)], ["takes particles whose mass over volume is about the density of clay, 1800 kg/m3"]),
            ([*common, *from_file(damaged)], ["-soil_file: given"]),
            ([*common, *from_file(mark), "-mesh_upper", "2,3"], ["takes particles inside the mesh"]),
            ([*common, *box, "-restart_change", "gravity"], ["-restart_change: given \"gravity\", takes nothing here: there is no -restart"]),
            ([*common, *box, "-restart", str(mark), "-restart_change", "gravity,mesh_spacing"],
             ["-restart_change: given \"gravity,mesh_spacing\", takes names of options among gravity"]),
            ([*common, *box, "-restart", str(mark), "-gravity", "0,-5"], ["-gravity: given \"0,-5\", takes \"0,-10\""]),
            ([*common, *box, "-restart", str(mark), "-restart_change", "gravity", "-gravity", "0,-5", "-f_bar_fraction", 0.5],
             ["-f_bar_fraction: given \"0.5\", takes \"0.98\""]),
        ]
        for options, lines in cases:
            folder = fresh(self.folder / "refused")
            done = run(self.given.binary, None, folder, "-backend", "serial", "-precision", self.precision, *options, status=2)
            errors = done.stderr.splitlines()
            self.expect(len(errors) == len(lines) and all(b in a for a, b in zip(errors, lines)), f"{lines}: {errors}")
            self.expect(not folder.exists(), f"{lines}: {folder} was written")
        for source in (frame, mark):  # the run would remove what it starts from
            done = run(self.given.binary, None, first, "-precision", self.precision, *common, *from_file(source), status=2)
            self.expect("takes a file that this run does not remove" in done.stderr, done.stderr)
            self.expect(source.exists(), f"{source} has gone")
        self.plain_files(common, left)

    def plain_files(self, common, left):
        """A file of one's own may leave out what is not needed; masses follow the volumes then."""
        position = left["position"]
        volume = 0.25 * np.where(position[:, 0] < 1, 1.5, 0.5)
        path = self.own_masses(self.folder / "plain.h5", {"position": position, "volume": volume})
        second, done = self.do("plain", *common, *from_file(path), "-soil_velocity", "0.5,0", "-history_interval", 0.01)
        again = bodies(frames(second)[0])
        self.expect((again["volume"] == volume).all() and apart(again["mass"], 1800 * volume) < 1e-7, "plain: masses")
        self.expect((again["velocity"][:, 0] == 0.5).all(), "plain: velocity")
        self.expect("without masses" in done.stdout and "without reference heights" in done.stdout, done.stdout)
        momentum = column_of(second, "soil_momentum_x")[0]
        self.expect(abs(momentum / (0.5 * 1800 * volume.sum()) - 1) < 1e-6, f"plain: momentum {momentum}")

    def test_changed(self):
        small = self.bound(1e-9, 1e-4)
        base = ("-dim 2 -mesh_lower 0,0 -mesh_upper 8,8 -mesh_spacing 1 -materials rock -rock_model linear_elastic "
                "-rock_density 2000 -rock_young 1e6 -rock_poisson 0.2 -bodies soil -soil_material rock -soil_shape box "
                "-soil_lower 2,4 -soil_upper 4,6 -rigid_bodies plate -plate_shape box -plate_lower 6,1 -plate_upper 7,2 "
                "-plate_motion prescribed -plate_velocity 0,0.5 -time_step 1e-3 -history_interval 0.01").split()
        common = [*base]
        first, _ = self.do("fall", *common, "-time_end", 0.1, "-checkpoint_interval", 0.1, "-gravity", "0,-1")
        change = ["-restart", "latest", "-time_end", 0.2, "-gravity", "0,-3", "-plate_velocity", "0,-2",
                  "-mesh_xmin", "fixed", "-damping", 0, "-checkpoint_interval", 0.1]
        _, done = self.do("fall", *common, *change, "-restart_change", "gravity,plate_velocity,mesh_xmin,damping")
        for line in ("changed here: -gravity 0,-1 -> 0,-3", "changed here: -plate_velocity 0,0.5 -> 0,-2",
                     "changed here: -mesh_xmin roller -> fixed"):
            self.expect(line in done.stdout, f"{line} is missing in\n{done.stdout}")
        self.expect("-damping" not in done.stdout.split("goes on from")[1], "damping has not changed")
        time, speed = column_of(first, "time"), column_of(first, "soil_momentum_y") / (4 * 2000)
        half_step = np.where(time > 0, 0.0005, 0)  # s: velocities belong to the middle of the step that ends at `time`
        expected = half_step - np.where(time < 0.1, time, 0.1 + 3 * (time - 0.1))
        self.expect(np.abs(speed - expected).max() < 1e3 * small * 0.4, f"falls with {np.abs(speed - expected).max()}")
        plate = column_of(first, "plate_y")
        self.expect(np.abs(plate - np.where(time < 0.1, 0.5 * time, 0.05 - 2 * (time - 0.1))).max() < 1e-9, f"plate {plate}")
        self.expect(len(time) == 21, f"{len(time)} rows")
        with h5py.File(checkpoints(first)[-1]) as file:  # the next restart compares with what holds now
            text = file["options"][()].tobytes().decode()
        self.expect("-gravity\t0,-3" in text, text)
        self.do("fall", *common, "-restart", "latest", "-time_end", 0.3, "-gravity", "0,-3", "-plate_velocity", "0,-2", "-mesh_xmin", "fixed",
                "-damping", 0)
