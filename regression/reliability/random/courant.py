"""The limit of the Courant number: soil that drifts freely keeps its energy just below it. Its decks have names and are not random.

    --share S (of the limit, 0.98)   --time T (s in 2D, 20; a tenth of it in 3D)   --short (a few decks)

An elastic disc (in 3D a box) drifts through the cells of a mesh without gravity and walls, so that its rim meets every
place in a cell. For 1 to 16 particles along a cell's edge, each velocity update, with and without F-bar, in 2D and 3D
and both precisions, the Courant number is `share` of the largest that -time_courant takes. The largest kinetic energy of the run over
that at the start must stay below 1.02. A program that takes a Courant number above the limit can be shown to fail with --share 1.1.
"""
import itertools
import math

from deck import Deck
from mpm_regression.folders import history

DISC = "-dim 2 -mesh_lower 0,0 -mesh_upper 4,2 -body_shape disc -body_centre 1.2,1 -body_radius 0.3 -body_velocity 0.01,0.003"
BOX = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 1.6,1,1 -body_shape box -body_lower 0.3,0.3,0.3 -body_upper 0.7,0.7,0.7 "
       "-body_velocity 0.01,0.003,0.002 -mesh_zmin free -mesh_zmax free")
COMMON = ("-mesh_spacing 0.1 -mesh_xmin free -mesh_xmax free -mesh_ymin free -mesh_ymax free -materials rubber "
          "-rubber_model linear_elastic -rubber_density 1000 -rubber_young 1e5 -rubber_poisson 0.3 -bodies body "
          "-body_material rubber -output_frames off")
UPDATES = {"flip": "", "blend": "-flip_fraction 0.9", "xpic": "-velocity_update xpic", "apic": "-velocity_update apic"}
LARGEST = 0.6  # whatever the particles are
WITHOUT_F_BAR = 0.94  # of the limit by particles


def limit(dim, per_cell, f_bar):
    rim = math.sqrt(2 / (dim * (per_cell if per_cell > 1 else 3)))
    return min(LARGEST, rim * (1 if f_bar > 0 else WITHOUT_F_BAR))


class Listed(Deck):
    """Decks that are not random, each run once: NAME is its parts with dashes."""
    backends, strategies = ("serial",), ("tile",)
    restarts = several = others = 0.0
    is_random = False

    def __str__(self):
        return f"{max([0, *self.noted['kinetic energy']]):.4g}"


class Courant(Listed):
    more = {"share": 0.98, "time": 20.0, "short": False}

    @classmethod
    def names(cls, given):
        counts = {2: (2, 6), 3: (2,)} if given.short else {2: (1, 2, 3, 4, 6, 8, 12, 16), 3: (1, 2, 3, 4, 6)}
        updates = ("flip",) if given.short else UPDATES
        return [f"{dim}D_{n}_{update}_{f_bar}_{precision}" for dim in counts
                for n, update, f_bar, precision in itertools.product(counts[dim], updates, (0.98, 0), given.precisions)]

    def make(self):
        dim, per_cell, update, f_bar, self.precision = self.key.split("_")
        self.dim = int(dim[0])
        courant = self.given.share * limit(self.dim, int(per_cell), float(f_bar))
        self.options = (f"{DISC if self.dim == 2 else BOX} {COMMON} {UPDATES[update]} -body_particles_per_cell {per_cell} "
                        f"-f_bar_fraction {f_bar} -time_courant {courant:.6g} -time_end {self.given.time / (1 if self.dim == 2 else 10):g}").split()

    def check(self, folder):
        energy = history(folder)["body_kinetic_energy"]
        self.note("kinetic energy", energy.max() / energy[0])
        assert energy.max() < 1.02 * energy[0], f"the kinetic energy is {energy.max() / energy[0]:.4f} of that at the start"
