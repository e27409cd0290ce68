#!/usr/bin/env python3
"""Soil that is pressed together to a fraction of its height stays stable with domains that stretch.

    regression/reliability/compression.py PROGRAM [--stretches 0.6,0.4,0.3,0.22] [--counts 1,2,3,4] [--precisions double,single]
                                                  [--share S] [--short] [--jobs J]

A column of elastic soil between smooth walls is pressed together by gravity that grows slowly, until the soil at its foot has the
given fraction of its height. The half lengths of the lowest domains are then that fraction of those at the start, or 0.1 cells, the
least. While they pass through the cells, and at rest afterwards, every particle meets every place in a cell, with the shortest
domains. The Courant number is `share` (0.98) of the largest that -time_courant takes; the program follows the domains with its time
step. At the end the kinetic energy must be below 1e-3 of the elastic energy (FLIP keeps some noise; an instability is many times as
large), and the energy balance must miss less than 2 % of it.
The height of the centre of mass at the end is known: the elastic law is linear in the logarithm of the stretch.
"""

import argparse
import csv
import itertools
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from courant import LARGEST, limit

HEIGHT, DENSITY, MODULUS = 4.0, 1000.0, 1.35e5  # m, kg/m3, Pa of the P wave
POISSON = 0.3
YOUNG = MODULUS * (1 + POISSON) * (1 - 2 * POISSON) / (1 - POISSON)
RAMP, END = 6.0, 8.0  # s, to the full gravity, of the run: 17 times the column's period at the start
DECK = f"""-dim 2 -mesh_lower 0,0 -mesh_upper 1,4.5 -mesh_spacing 0.25 -mesh_xmin roller -mesh_xmax roller -mesh_ymin roller
-mesh_ymax free -materials rubber -rubber_model linear_elastic -rubber_density {DENSITY:g} -rubber_young {YOUNG:.17g}
-rubber_poisson {POISSON:g} -bodies body -body_material rubber -body_shape box -body_lower 0,0 -body_upper 1,{HEIGHT:g}
-particle_domain stretch -damping 0.05 -output_energy on -output_frames off -progress off -backend serial -p2g tile
-history_interval 0.1 -time_end {END:g} -gravity_table_interpolation smooth"""


def gravity(stretch):
    """That presses the foot of the column to this stretch [m/s2]."""
    return MODULUS * -math.log(stretch) / (DENSITY * HEIGHT)


def exact_centre(stretch):
    """Twice the height [m] of the centre of mass: the mean over the mass above of the height below it."""
    full = -math.log(stretch)
    # y(s) = (H / full) (exp(-full (1 - s)) - exp(-full)), s the share of the mass below
    return 2 * HEIGHT / full * ((1 - stretch) / full - stretch)


def result(program, stretch, per_cell, update, precision, share):
    """Kinetic over elastic energy, share of it that is missing, and twice the height of the centre [m]; a text where the run fails."""
    with tempfile.TemporaryDirectory(prefix="mpm_compression_") as folder:
        table = Path(folder) / "gravity.csv"
        table.write_text(f"time,x,y\n0,0,0\n{RAMP:g},0,{-gravity(stretch):.17g}\n{END + 1:g},0,{-gravity(stretch):.17g}\n")
        courant = share * min(LARGEST, limit(2, per_cell, 0.98)) / math.sqrt(1.05)
        text = f"{DECK} -gravity_table {table} -body_particles_per_cell {per_cell} -velocity_update {update}"
        text += f" -precision {precision} -time_courant {courant:.6g} -output_dir {folder}/out"
        run = subprocess.run([program, *text.split()], capture_output=True, text=True)
        if run.returncode != 0:
            return (run.stderr or run.stdout).strip().split("\n")[-1]
        with open(Path(folder) / "out/history.csv") as file:
            last = list(csv.DictReader(file))[-1]
    elastic = float(last["energy_elastic"])
    height = 2 * float(last["body_centre_y"])
    return float(last["energy_kinetic"]) / elastic, float(last["energy_error"]) / elastic, height


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--stretches", default="0.6,0.4,0.3,0.22")
    parser.add_argument("--counts", default="1,2,3,4", help="particles along a cell's edge")
    parser.add_argument("--updates", default="flip,xpic,apic")
    parser.add_argument("--precisions", default="double,single")
    parser.add_argument("--share", type=float, default=0.98, help="of the largest Courant number")
    parser.add_argument("--short", action="store_true", help="a few cases, as a test")
    parser.add_argument("--jobs", type=int, default=1)
    args = parser.parse_args()
    cases = [(float(stretch), int(count), update, precision)
             for stretch, count, update, precision in itertools.product(args.stretches.split(","), args.counts.split(","),
                                                                        args.updates.split(","), args.precisions.split(","))]
    if args.short:
        cases = [(0.3, 2, "flip", precision) for precision in args.precisions.split(",")]
    failed = 0
    with ThreadPoolExecutor(args.jobs) as pool:
        for case, found in zip(cases, pool.map(lambda case: result(args.program, *case, args.share), cases)):
            stretch, count, update, precision = case
            text = found if isinstance(found, str) else ""
            if not text:
                kinetic, missing, centre = found
                far = centre / exact_centre(stretch) - 1
                text = f"kinetic {kinetic:.1e}, missing {missing:.2%} of the elastic energy, centre {far:+.2%} of the exact height"
                sound = kinetic < 1e-3 and abs(missing) < 0.02 and abs(far) < 0.03
            else:
                sound = False
            failed += not sound
            print(f"{'ok  ' if sound else 'FAIL'} stretch {stretch:.2f} n {count} {update:4s} {precision:6s}: {text}", flush=True)
    print(f"{len(cases) - failed} of {len(cases)} are stable")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
