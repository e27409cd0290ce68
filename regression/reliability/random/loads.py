"""Tables in time: gravity, velocities, displacements and forces of rigid bodies, on soil that they touch.

A deck has soil under gravity in time and up to three rigid bodies, each with a table of a random kind, in a line or in a CSV file,
straight or smooth, of components or of factors. The displacement of a driven body must be the integral of its table, to round-off,
at every row. A constant table in the place of a constant must give the same bits.
"""
import numpy as np

from deck import Deck, flat_table, vector
from mpm_regression.folders import history

END = 0.2  # s
LARGEST = {"velocity": 0.4, "displacement": 0.03, "force": 500}
FASTEST = 5.0  # m/s, of displacements between two times of a table: waves of the soil have 30 m/s


def table_options(draw, folder, name, times, values):
    """A table in a line, or in a file of the deck's folder, straight or smooth."""
    points = [[repr(float(x)) for x in (t, *row)] for t, row in zip(times, values)]
    text = ",".join(":".join(point) for point in points)
    if draw.random() < 0.5:
        path = folder / f"{name}.csv"
        path.write_text(draw.choice(["", "# a record\n", f"time{',a,b,c'[:2 * len(values[0])]}\n"]) +
                        "".join(",".join(point) + "\n" for point in points))
        text = str(path)
    return [f"-{name}_table", text, *([f"-{name}_table_interpolation", "smooth"] if draw.random() < 0.4 else [])]


class Table:
    """A random table of `dim` components with its options."""

    def __init__(self, draw, folder, name, dim, largest, factors_of=None):
        count = draw.choice([2, 3, 5, 12, 200])
        times = sorted(draw.uniform(-0.2, 1.3) * END for _ in range(count))
        times[0], times[-1] = min(times[0], draw.choice([0.0, -0.03])), max(times[-1], END * draw.choice([1, 1.5]))
        columns = 1 if factors_of is not None else dim
        values = np.array([[draw.uniform(-1, 1) * (1 if factors_of is not None else largest) for _ in range(columns)] for _ in times])
        if name.endswith("displacement"):
            values *= min(1, FASTEST / np.abs(np.diff(values, axis=0) / np.diff(times)[:, None]).max())
        self.options = table_options(draw, folder, name, times, values)
        self.times, self.smooth = np.array(times), "smooth" in self.options
        self.values = values * np.array(factors_of) if factors_of is not None else values

    def way(self, t):
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        length = np.diff(self.times)[k]
        return k, length, np.clip((t - self.times[k]) / length, 0, 1)

    def value(self, t):
        k, _, x = self.way(t)
        return self.values[k] + np.diff(self.values, axis=0)[k] * (x**2 * (3 - 2 * x) if self.smooth else x)[:, None]

    def integral_from_start(self, t):
        k, length, x = self.way(t)
        parts = np.diff(self.times)[:, None] * (self.values[1:] + self.values[:-1]) / 2
        whole = np.concatenate([0 * self.values[:1], np.cumsum(parts, axis=0)])
        share = x**3 - x**4 / 2 if self.smooth else x**2 / 2
        return whole[k] + length[:, None] * (self.values[k] * x[:, None] + np.diff(self.values, axis=0)[k] * share[:, None])

    def integral(self, t):
        return self.integral_from_start(t) - self.integral_from_start(np.zeros(1))


class Loads(Deck):
    strategies = ("tile",)

    def make(self):
        draw, dim, self.driven, self.placed = self.draw, self.dim, {}, {}
        across = [4.0, 3.0] if dim == 2 else [4.0, 2.0, 3.0]
        self.options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.25 "
                        "-materials clay -clay_model von_mises -clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 "
                        f"-clay_su {draw.choice([500, 3000])} -bodies soil -soil_material clay -soil_shape box "
                        f"-soil_lower {vector([0] * dim)} -soil_upper {vector([*across[:-1], 1.5])} -damping {draw.choice([0, 0.1])} "
                        f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} "
                        f"-time_end {END} -time_courant {draw.choice([0.2, 0.33])} -history_interval 0.01 -output_interval 0.1").split()
        weight, by_factor = [0.0] * (dim - 1) + [-9.81], True
        if draw.random() < 0.7:
            by_factor = draw.random() < 0.5
            self.options += Table(draw, self.folder, "gravity", dim, 8, weight if by_factor else None).options
        self.options += ["-gravity", vector(weight)] if by_factor else []
        names = draw.sample(["pile", "plate", "block"], draw.choice([1, 2, 3]))
        self.options += ["-rigid_bodies", ",".join(names)]
        for k, name in enumerate(names):
            self.add_rigid(k, name)

    def add_rigid(self, k, name):
        draw, dim = self.draw, self.dim
        lower = [0.3 + 1.2 * k, *[0.4] * (dim - 2), 1.6]
        self.options += f"-{name}_shape box -{name}_lower {vector(lower)} -{name}_upper {vector(x + 0.7 for x in lower)}".split()
        self.options += draw.choice([[], [f"-{name}_friction", "0.3"], [f"-{name}_contact_normal", "gradient"]])
        kind = draw.choice(list(LARGEST))
        by_factor = kind != "displacement" and draw.random() < 0.4
        constant = [0.2 if kind == "velocity" else 300.0] * dim
        table = Table(draw, self.folder, f"{name}_{kind}", dim, LARGEST[kind], constant if by_factor else None)
        self.options += table.options + ([f"-{name}_{kind}", vector(constant)] if by_factor else [])
        self.options += [f"-{name}_motion", "dynamic" if kind == "force" else "prescribed"]
        self.options += [f"-{name}_density", "2000"] if kind == "force" else []
        {"velocity": self.driven, "displacement": self.placed}.get(kind, {})[name] = table

    def check(self, folder):
        values = history(folder)
        t, start = values["time"], np.zeros(1)
        exact = [(f"{name}_", table.integral(t), "the integral of its velocity") for name, table in self.driven.items()]
        exact += [(f"{name}_velocity_", table.value(t), "its velocity") for name, table in self.driven.items()]
        exact += [(f"{name}_", table.value(t) - table.value(start), "its displacement") for name, table in self.placed.items()]
        for name, wanted, what in exact:
            error = np.abs(np.column_stack([values[name + axis] for axis in self.axes]) - wanted).max()
            assert error < 1e-12, f"{name} is {error:.3g} off {what}"

    def compare(self, whole):
        """The constants of a deck, and tables of one value in their place."""
        pairs = {name: value for name, value in zip(self.options[::2], self.options[1::2])
                 if not name.endswith(("_table", "_table_interpolation"))}
        for name in [*self.driven, *self.placed]:
            pairs.setdefault(f"-{name}_velocity", vector([0.0] * (self.dim - 1) + [-0.21]))
        pairs.setdefault("-gravity", vector([0.0] * (self.dim - 1) + [-3.3]))
        constant = [word for pair in pairs.items() for word in pair]
        timed = [word for name, value in pairs.items() for word in (
            (f"{name}_table", flat_table(value)) if name == "-gravity" or name.endswith(("_velocity", "_force")) else (name, value))]
        self.check_same_bits(self.go("timed", options=timed), self.go("constant", options=constant), "tables of one value")
