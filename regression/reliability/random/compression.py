"""Soil that is pressed together to a fraction of its height stays stable with domains that stretch. Its decks have names and are not random.

    --stretches 0.6,0.4,0.3,0.22   --counts 1,2,3,4   --updates flip,xpic,apic   --share S (0.98)   --short (one deck a precision)

A column of elastic soil between smooth walls is pressed together by gravity that grows slowly, until the soil at its foot has the
given fraction of its height. The half lengths of the lowest domains are then that fraction of those at the start, or 0.1 cells, the
least. While they pass through the cells, and at rest afterwards, every particle meets every place in a cell, with the shortest
domains. The Courant number is `share` of the largest that -time_courant takes; the program follows the domains with its time
step. At the end the kinetic energy must be below 1e-3 of the elastic energy (FLIP keeps some noise; an instability is many times as
large), and the energy balance must miss less than 2 % of it.
The height of the centre of mass at the end is known: the elastic law is linear in the logarithm of the stretch.
"""
import itertools
import math

from courant import LARGEST, Listed, limit
from mpm_regression.folders import history

HEIGHT, DENSITY, MODULUS = 4.0, 1000.0, 1.35e5  # m, kg/m3, Pa of the P wave
POISSON = 0.3
YOUNG = MODULUS * (1 + POISSON) * (1 - 2 * POISSON) / (1 - POISSON)
RAMP, END = 6.0, 8.0  # s, to the full gravity, of the run: 17 times the column's period at the start
DECK = f"""-dim 2 -mesh_lower 0,0 -mesh_upper 1,4.5 -mesh_spacing 0.25 -mesh_xmin roller -mesh_xmax roller -mesh_ymin roller
-mesh_ymax free -materials rubber -rubber_model linear_elastic -rubber_density {DENSITY:g} -rubber_young {YOUNG:.17g}
-rubber_poisson {POISSON:g} -bodies body -body_material rubber -body_shape box -body_lower 0,0 -body_upper 1,{HEIGHT:g}
-particle_domain stretch -damping 0.05 -output_energy on -output_frames off -history_interval 0.1 -time_end {END:g}
-gravity_table_interpolation smooth"""


def gravity(stretch):
    """Gravity [m/s2] that presses the foot of the column to this stretch."""
    return MODULUS * -math.log(stretch) / (DENSITY * HEIGHT)


def exact_centre(stretch):
    """Twice the height [m] of the centre of mass: the mean over the mass above of the height below it."""
    full = -math.log(stretch)
    # y(s) = (H / full) (exp(-full (1 - s)) - exp(-full)), s the share of the mass below
    return 2 * HEIGHT / full * ((1 - stretch) / full - stretch)


class Compression(Listed):
    more = {"stretches": "0.6,0.4,0.3,0.22", "counts": "1,2,3,4", "updates": "flip,xpic,apic", "share": 0.98, "short": False}

    @classmethod
    def names(cls, given):
        lists = (["0.3"], ["2"], ["flip"]) if given.short else (given.stretches.split(","), given.counts.split(","), given.updates.split(","))
        return ["_".join(parts) for parts in itertools.product(*lists, given.precisions)]

    def make(self):
        stretch, per_cell, update, self.precision = self.key.split("_")
        self.dim, self.stretch = 2, float(stretch)
        g = -gravity(self.stretch)
        courant = self.given.share * min(LARGEST, limit(2, int(per_cell), 0.98)) / math.sqrt(1.05)
        self.options = (f"{DECK} -gravity_table 0:0:0,{RAMP:g}:0:{g:.17g},{END + 1:g}:0:{g:.17g} -body_particles_per_cell {per_cell} "
                        f"-velocity_update {update} -time_courant {courant:.6g}").split()

    def check(self, folder):
        last = {name: values[-1] for name, values in history(folder).items()}
        elastic = last["energy_elastic"]
        kinetic, missing = last["energy_kinetic"] / elastic, last["energy_error"] / elastic
        far = 2 * last["body_centre_y"] / exact_centre(self.stretch) - 1
        self.note("kinetic energy", kinetic)
        printed = f"kinetic {kinetic:.1e}, missing {missing:.2%} of the elastic energy, centre {far:+.2%} of the exact height"
        assert kinetic < 1e-3 and abs(missing) < 0.02 and abs(far) < 0.03, printed
