"""Probes and rasters.

A deck has soil that collapses or slides, with random probes of all kinds, and rasters. The mass that has passed a section must be the
change of the mass beyond it, which is found from the frames where nothing has left; a particle that is followed must be that of the
frames; the rasters must hold the volume of the soil at the end, and no raster may have more now than at its greatest. Some decks have
two stages.
"""
import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.folders import frames, history

END = 0.12  # s
DENSITY = 1800  # kg/m3
FEATURES = [[], [], ["-particle_domain", "stretch"], ["-particle_domain", "split"], ["-velocity_update", "apic"]]
BODIES = "one,two"


def soil_of(path, bodies, *keys):
    """The time of a frame, and fields of the particles of some bodies."""
    with h5py.File(path) as file:
        groups = [file[name] for name in bodies if name in file]
        none = lambda group: np.zeros(len(group["volume"]))  # noqa: E731
        return float(file.attrs["time"]), *(np.concatenate([group[key][()] if key in group else none(group) for group in groups]) for key in keys)


def raster_values(folder):
    """(max_depth, max_speed, arrival, final depth, area of a cell)"""
    if (folder / "rasters.csv").exists():
        data = np.genfromtxt(folder / "rasters.csv", delimiter=",", skip_header=1)
        return [*data.T[1:], data[1, 0] - data[0, 0]]
    values = []
    for name in ("max_depth", "max_speed", "arrival_time", "final_depth"):
        lines = (folder / f"raster_{name}.asc").read_text().splitlines()
        values.append(np.array([line.split() for line in lines[6:]], dtype=float))
    return [*values, float(lines[4].split()[1]) ** 2]


class Probes(Deck):
    strategies = ("tile", "gather")
    several, others = 0.5, 0.0

    def make(self):
        draw, dim = self.draw, self.dim
        self.lower = lower = [draw.choice([0.0, -3.25, 100.0]) for _ in range(dim)]
        self.upper = [a + b for a, b in zip(lower, [3.0, 2.0] if dim == 2 else [2.5, 1.0, 1.5])]
        corner = lambda *x: vector(a + b for a, b in zip(lower, x))  # noqa: E731
        flat, across = [0] * (dim - 2), [1.0] * (dim - 2)
        self.options = (f"-dim {dim} -mesh_lower {vector(lower)} -mesh_upper {vector(self.upper)} -mesh_spacing 0.25 -materials sand "
                        f"-sand_model mohr_coulomb -sand_density {DENSITY} -sand_young 1e6 -sand_poisson 0.3 -sand_cohesion 200 "
                        f"-sand_friction_deg 25 -bodies {BODIES} -gravity {vector([0] * (dim - 1) + [-9.81])} -mesh_xmax free "
                        f"-mesh_{self.up}max free -one_shape box -one_lower {corner(0, *flat, 0)} -one_upper {corner(1, *across, 0.5)} "
                        f"-two_shape box -two_lower {corner(0, *flat, 0.5)} -two_upper {corner(1, *across, 1)} "
                        f"-history_interval {draw.choice(['0.01', '0.0037'])} -output_interval 0.04").split()
        for name, fastest in (("one", 4), ("two", 6)):
            self.options += [f"-{name}_material", "sand", f"-{name}_velocity", vector([draw.uniform(0, fastest)] + [0] * (dim - 1))]
        self.options += draw.choice(FEATURES)
        kinds = [draw.choice(["point", "particle", "gauge", "section"]) for _ in range(draw.randint(1, 5))] + ["particle", "section"]
        self.kinds = {f"p{k}": kind for k, kind in enumerate(kinds)}
        self.options += ["-probes", ",".join(self.kinds)]
        for name, kind in self.kinds.items():
            self.add_probe(name, kind)
        self.options += ["-output_rasters", "on", "-raster_spacing", draw.choice(["0.25", "0.1", "0.4"])]
        self.options += draw.choice([[], ["-raster_interval", "0.007"], ["-raster_threshold_speed", "0.5"], ["-raster_bodies", "two"]])
        more = draw.choice([[], ["-second_remove", "two"], ["-first_reset", "on"]])
        self.options += ["-time_end", str(END)] if draw.random() < 0.7 else ["-stages", "first,second", "-time_end", str(END / 2), *more]

    def add_probe(self, name, kind):
        """Somewhere in the mesh."""
        draw, lower, upper = self.draw, self.lower, self.upper
        inside = lambda d: draw.uniform(lower[d] + 0.1, upper[d] - 0.1)  # noqa: E731
        self.options += [f"-{name}_kind", kind]
        if kind == "section":
            axis = draw.randrange(self.dim)
            self.options += [f"-{name}_axis", "xyz"[axis], f"-{name}_at", repr(inside(axis))]
        elif kind == "gauge":
            self.options += [f"-{name}_at", vector(inside(d) for d in range(self.dim - 1))]
            self.options += draw.choice([[], [f"-{name}_width", draw.choice(["0", "0.1", "0.7"])]])
        else:
            self.options += [f"-{name}_at", vector(draw.uniform(x + 0.1, x + 0.9) for x in lower)]
        self.options += draw.choice([[], [], [f"-{name}_bodies", draw.choice(["one", "two", BODIES])]])

    def option(self, name, default=""):
        return self.options[self.options.index(name) + 1] if name in self.options else default

    def check(self, folder):
        values = history(folder)
        for name, kind in self.kinds.items():
            if kind == "particle" and np.isfinite(values[f"{name}_x"]).all():
                self.check_particle(folder, values, name)
            lost = any(values[f"{body}_lost_mass"][-1] > 0 for body in ("one", "two"))
            if kind == "section" and not lost and "-stages" not in self.options:
                self.check_section(folder, values, name)
        self.check_rasters(folder)

    def check_section(self, folder, values, name):
        """Mass beyond a section by the frames, to the half width of a particle."""
        bodies = self.option(f"-{name}_bodies", BODIES).split(",")
        axis, place = "xyz".index(self.option(f"-{name}_axis")), float(self.option(f"-{name}_at"))
        bounds = []
        for path in (frames(folder)[0], frames(folder)[-1]):
            time, position, mass = soil_of(path, bodies, "position", "mass")
            bounds.append([mass[position[:, axis] > place + aside].sum() for aside in (0.13, -0.13)])
        (least_then, most_then), (least, most) = bounds
        passed, slack = np.interp(time, values["time"], values[f"{name}_mass"]), 1e-6 * max(most, 1)
        assert least - most_then - slack <= passed <= most - least_then + slack, \
            f"section {name}: {passed:.6g} kg have passed, and by the frames from {least - most_then:.6g} to {most - least_then:.6g}"
        apart = abs(values[f"{name}_mass"] - values[f"{name}_volume"] * DENSITY).max()
        assert apart <= self.bound(1e-9, 1e-3) * DENSITY, f"section {name}: mass and volume differ"

    def check_particle(self, folder, values, name):
        """A particle that is followed is one of the frames, at each frame."""
        for path in frames(folder):
            time, position = soil_of(path, ("one", "two"), "position")
            row = np.flatnonzero(np.abs(values["time"] - time) < 1e-12)
            if len(row):
                place = [values[f"{name}_{axis}"][row[0]] for axis in self.axes]
                assert np.abs(position[:, :self.dim] - place).max(axis=1).min() < 1e-5, f"{name} is not where a particle is at {time} s"

    def check_rasters(self, folder):
        depth, _, arrival, final, area = raster_values(folder)
        _, position, volume, gap = soil_of(frames(folder)[-1], self.option("-raster_bodies", BODIES).split(","), "position", "volume", "parted_volume")
        volume = volume * np.exp(-np.minimum(gap, 4))  # depths leave out the gaps of soil that has parted
        if len(volume) and position[:, 0].max() < self.upper[0] - 0.15:
            held = final.sum() * area
            assert abs(held - volume.sum()) <= 1e-5 * volume.sum(), f"the rasters hold {held:.9g} m3 of {volume.sum():.9g}"
        assert (final <= depth + 1e-9).all(), "the depth at the end is more than the greatest"
        assert ((np.nan_to_num(arrival, nan=-9999) >= 0) <= (depth > 0.025 - 1e-9)).all(), "soil arrived where none is deep enough"

    def check_other(self, folder, whole, what):
        self.check(folder)
        mine, theirs, bound = history(folder), history(whole), self.bound(1e-6, 0.02)
        for name in (name for name in theirs if name.startswith("p") and name[1].isdigit()):
            scale = max(np.nanmax(np.abs(theirs[name]), initial=0), 1 if "stress" not in name and "pressure" not in name else 1e4)
            assert len(mine[name]) == len(theirs[name]), f"{what}: other rows"
            both = np.isfinite(mine[name]) & np.isfinite(theirs[name])
            assert both.sum() >= len(both) * 0.97 or (np.isnan(mine[name]) == np.isnan(theirs[name])).all(), f"{what}: {name} is elsewhere"
            off = np.abs(mine[name] - theirs[name])[both].max(initial=0) / scale
            assert off < bound, f"{what}: {name} is {off:.3g} off"
        for got, wanted in zip(raster_values(folder)[:2], raster_values(whole)[:2]):
            assert np.abs(got - wanted).max() < bound * max(wanted.max(), 1), f"{what}: rasters differ by {np.abs(got - wanted).max():.3g}"
