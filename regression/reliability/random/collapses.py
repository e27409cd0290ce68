"""Clay that collapses, slides and strikes: every run reaches its end, and every kilogram is accounted for.

The collapse of a column in nine variants, which have names, and random decks (collapse_decks.py) with all strengths, shapes, sides and
velocity updates. --every 4 takes every fourth variant, --particle_domain one kind of domains for all, --limit the seconds that a run
may take. Of each run:

- the last row is that of the end;
- mass in the mesh + mass lost = mass of the first row, in each row, up to round-off; where no side is free none is lost;
- every number of the history is finite, and each body lies inside the mesh;
- kinetic energy never exceeds that of the start and what gravity has given since.
"""
import numpy as np

from collapse_decks import COLLAPSE, VARIANTS, Options, random_options
from deck import Deck, Machine
from mpm_regression.folders import history

ROUND_OFF = {"double": 1e-12, "single": 1e-6}  # of the mass
ENERGY_SLACK = 0.05  # of the energy so far: steps are explicit, and nodes see the particles' mass spread


class Collapses(Deck):
    more = {"every": 1, "particle_domain": "", "limit": 300.0}
    precisions = ("double", "double", "double", "single")
    strategies = ("sequential", "atomic", "mosaic", "mosaic", "gather", "gather", "tile", "tile", "tile", "tile", "auto")
    ranks = (1, 1, 1, 1, 1, 1, 2, 2, 3, 4)
    threads = (1, 2)
    partitions = ("box", "metis")
    restarts, several, others = 0.1, 0.0, 0.0  # round-off grows in flows
    seconds = (0.5, 4.0)  # of a run on one core, about
    frame_options = ["-output_frames", "off"]

    @classmethod
    def names(cls, given):
        return list(VARIANTS)[::given.every]

    def make(self):
        self.time_limit = self.given.limit
        if self.key in VARIANTS:
            self.deck = Options(self.key, {**COLLAPSE, **VARIANTS[self.key]})
            self.precision, self.exact, self.machine = "double", True, Machine("openmp", "auto")
        else:
            self.draw_deck()
        if self.given.particle_domain:
            self.deck.options["particle_domain"] = self.given.particle_domain
        self.dim = self.deck.dim
        self.up, self.axes = "xyz"[self.dim - 1], "xyz"[:self.dim]
        self.options = [*self.deck.words(), *self.frame_options]

    def draw_deck(self):
        self.deck = self.random_options()

    def random_options(self):
        dims = [int(word) for word in self.given.dims]
        return random_options(f"{self.given.name} {self.given.seed} {self.key}", dims, self.precision, *self.seconds)

    def __str__(self):
        return f"{super().__str__()}, {self.deck.name}"

    def check(self, folder):
        faults = list(self.faults(folder))
        assert not faults, "\n".join(faults)

    def faults(self, folder):
        values, end = history(folder), float(self.deck.value("time_end"))
        if abs(values["time"][-1] - end) > 1e-9 * end:
            yield f"the last row is of {values['time'][-1]:.9g} s"
        for name, column in values.items():
            if not np.isfinite(column).all():
                row = int((~np.isfinite(column)).argmax())
                yield f"{name} is {column[row]} in row {row} (t = {values['time'][row]:.6g} s)"
        for body in self.deck.bodies():
            yield from self.mass_faults(values, body)
            yield from self.place_faults(values, body)
        if not self.deck.loaded and all(f"{body}_{column}" in values for body in self.deck.bodies() for column in ("mass", "lost_mass")):
            yield from self.energy_faults(values)

    def mass_faults(self, values, body):
        missing = [name for name in (f"{body}_mass", f"{body}_lost_mass") if name not in values]
        if missing:
            yield f"history.csv has no column {', '.join(missing)}"
            return
        kept, lost = values[f"{body}_mass"], values[f"{body}_lost_mass"]
        if not kept[0] > 0 or lost[0] != 0:
            yield f"{body} starts with {kept[0]:.17g} kg and {lost[0]:.17g} kg lost"
            return
        error = np.abs(kept + lost - kept[0]) / kept[0]
        row = int(error.argmax())
        if not error[row] <= ROUND_OFF[self.precision]:
            yield (f"mass of {body}: row {row} (t = {values['time'][row]:.6g} s) has {kept[row]:.17g} kg and {lost[row]:.17g} kg"
                   f" lost of {kept[0]:.17g} kg: {error[row]:.2g} of it")
        if (np.diff(lost) < 0).any():
            yield f"lost mass of {body} grows smaller"
        sides = [self.deck.options.get(f"mesh_{axis}{end}") for axis in self.axes for end in ("min", "max")]
        if "free" not in sides and self.deck.options.get("stray_particles") != "remove" and lost.any():
            yield f"{body} lost {lost.max():.6g} kg where no side is free"

    def place_faults(self, values, body):
        """A body, while there is any of it, lies inside the mesh."""
        there = values.get(f"{body}_mass", np.ones(len(values["time"]))) > 0
        slack = self.bound(1e-9, 1e-4) * float(self.deck.value("mesh_spacing"))
        for axis, lower, upper in zip("xyz", *self.deck.mesh()):
            least, most = (values[f"{body}_{axis}{end}"][there] for end in ("min", "max"))
            # A particle that has passed a free side leaves at the next rebuild of the bins, after half a cell at most.
            below, above = (slack + (self.deck.options.get(f"mesh_{axis}{end}") == "free") * float(self.deck.value("mesh_spacing")) / 2
                            for end in ("min", "max"))
            if there.any() and (least.min() < lower - below or most.max() > upper + above):
                yield (f"{body} reaches {axis} = {least.min():.12g} to {most.max():.12g} m, the mesh {lower:.12g} to"
                       f" {upper:.12g} m")

    def energy_faults(self, values):
        """Kinetic energy beyond that of the start and what gravity gave: each particle that is lost may have left at the
        place of the mesh where gravity gives the most. Water carries up to the share `lift` of soil that rises."""
        g = np.array([float(x) for x in self.deck.value("gravity").split(",")])
        corners = self.deck.mesh()
        lowest = sum(max(a * lower, a * upper) for a, lower, upper in zip(g, *corners))  # J/kg
        kinetic = given = heavy = 0
        for body in self.deck.bodies():
            mass = values[f"{body}_mass"]
            lost = values[f"{body}_lost_mass"]
            height = sum(a * values[f"{body}_centre_{axis}"] for a, axis in zip(g, "xyz"))
            kinetic = kinetic + values[f"{body}_kinetic_energy"]
            given = given + np.where(mass > 0, mass * height, 0) + lost * lowest - mass[0] * height[0]
            heavy += mass[0]
        given = np.where(given < 0, (1 - self.deck.lift) * given, given)
        cell = float(self.deck.value("mesh_spacing"))
        scale = kinetic[0] + np.maximum.accumulate(np.abs(given)) + heavy * np.linalg.norm(g) * cell
        excess = kinetic - kinetic[0] - given - ENERGY_SLACK * scale
        row = int(excess.argmax())
        if not excess[row] <= 0:
            yield (f"energy grows without a source: row {row} (t = {values['time'][row]:.6g} s) has {kinetic[row]:.6g} J, the start"
                   f" {kinetic[0]:.6g} J, and gravity gave {given[row]:.6g} J")
