#!/usr/bin/env python3
"""The limit of the Courant number: soil that drifts freely keeps its energy just below it.

    regression/reliability/courant.py PROGRAM [--share S] [--periods N] [--precisions double,single] [--short] [--jobs J]

An elastic disc (in 3D a box) drifts through the cells of a mesh without gravity and walls, so that its rim meets every
place in a cell. For 1 to 16 particles along a cell's edge, each velocity update, with and without F-bar, in 2D and 3D
and both precisions, the Courant number is `share` (0.98) of the largest that -time_courant takes. The largest kinetic
energy of the run over that at the start must stay below 1.02. A program that takes a Courant number above the limit can be
shown to fail with --share 1.1.
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

DISC = """-dim 2 -mesh_lower 0,0 -mesh_upper 4,2 -body_shape disc -body_centre 1.2,1 -body_radius 0.3
-body_velocity 0.01,0.003"""
BOX = """-dim 3 -mesh_lower 0,0,0 -mesh_upper 1.6,1,1 -body_shape box -body_lower 0.3,0.3,0.3 -body_upper 0.7,0.7,0.7
-body_velocity 0.01,0.003,0.002"""
COMMON = """-mesh_spacing 0.1 -mesh_xmin free -mesh_xmax free -mesh_ymin free -mesh_ymax free -materials rubber
-rubber_model linear_elastic -rubber_density 1000 -rubber_young 1e5 -rubber_poisson 0.3 -bodies body
-body_material rubber -backend serial -p2g tile -output_frames off -progress off"""
UPDATES = {"flip": "", "flip 0.9": "-flip_fraction 0.9", "xpic": "-velocity_update xpic", "apic": "-velocity_update apic"}
LARGEST = 0.6  # whatever the particles are
WITHOUT_F_BAR = 0.94  # of the limit by particles


def limit(dim, per_cell, f_bar):
    rim = math.sqrt(2 / (dim * (per_cell if per_cell > 1 else 3)))
    return min(LARGEST, rim * (1 if f_bar > 0 else WITHOUT_F_BAR))


def ratio(program, dim, per_cell, update, f_bar, precision, share, time):
    """Largest kinetic energy over that at the start; a word where the run does not end well."""
    with tempfile.TemporaryDirectory(prefix="mpm_courant_") as folder:
        text = f"{DISC if dim == 2 else BOX} {COMMON} {UPDATES[update]} -body_particles_per_cell {per_cell}"
        if dim == 3:
            text += " -mesh_zmin free -mesh_zmax free"
        text += f" -f_bar_fraction {f_bar} -precision {precision} -time_courant {share * limit(dim, per_cell, f_bar):.6g}"
        text += f" -time_end {time:g} -output_dir {folder}/out"
        run = subprocess.run([program, *text.split()], capture_output=True, text=True)
        history = Path(folder) / "out/history.csv"
        if run.returncode not in (0, 3) or not history.exists():
            return (run.stderr or run.stdout).strip().split("\n")[-1]
        with open(history) as file:
            energy = [float(row["body_kinetic_energy"]) for row in csv.DictReader(file)]
        return math.inf if run.returncode == 3 else max(energy) / energy[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--share", type=float, default=0.98, help="of the limit")
    parser.add_argument("--time", type=float, default=20, help="s, in 2D; a tenth of it in 3D")
    parser.add_argument("--precisions", default="double,single")
    parser.add_argument("--short", action="store_true", help="a few cases, as a test")
    parser.add_argument("--jobs", type=int, default=1)
    args = parser.parse_args()
    flat, deep = ((2, 6), (2,)) if args.short else ((1, 2, 3, 4, 6, 8, 12, 16), (1, 2, 3, 4, 6))
    updates = ("flip",) if args.short else tuple(UPDATES)
    cases = [(dim, n, update, f_bar, precision)
             for dim, counts in ((2, flat), (3, deep))
             for n, update, f_bar, precision in itertools.product(counts, updates, (0.98, 0), args.precisions.split(","))]
    with ThreadPoolExecutor(args.jobs) as pool:
        found = pool.map(lambda case: ratio(args.program, *case, args.share, args.time / (1 if case[0] == 2 else 10)), cases)
        failed = 0
        for case, value in zip(cases, found):
            dim, n, update, f_bar, precision = case
            sound = isinstance(value, float) and value < 1.02
            failed += not sound
            print(f"{'ok  ' if sound else 'FAIL'} {dim}D n {n:2d} {update:9s} F-bar {f_bar:4g} {precision:6s}"
                  f" Courant {args.share * limit(dim, n, f_bar):.4f}: {value if isinstance(value, str) else f'{value:.4f}'}", flush=True)
    print(f"{len(cases) - failed} of {len(cases)} keep their energy")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
