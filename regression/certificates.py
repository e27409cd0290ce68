#!/usr/bin/env python3
"""Certificates (soil-mpm certify) of answers whose exact values are known, from decks of regression/cases: whether their bars hold them.

Usage: regression/certificates.py PATH_TO_mpm --out FOLDER [--only WORD,...] [--docs]

FOLDER keeps the runs, so that a certificate is not computed again. --docs writes the table into docs/certify.md. The exit status is 1 where fewer
than 18 of 20 bars hold.
"""
import argparse
import math
import pathlib
import shlex
import sys

from mpm_regression.cases import ROOT, Case  # puts the package on the path
from soil_mpm.answer import Answer
from soil_mpm.certificate import Certificate, certify
from soil_mpm.deck import Deck
from soil_mpm.problems import Problem

PAGE = ROOT / "docs" / "certify.md"
LEAST = 0.9  # share of the bars that must hold
G = 9.81
LAME = 2e-4 * 2e7 * 3 / (1.3 * (0.4 + 4))  # Pa, pressure in the hole of the thick cylinder
CHANNEL = 1.25 * (1 - 32 / math.pi ** 3 * math.exp(-math.pi ** 2 / 4 * 0.5 / 0.25))  # m/s, first term of the start from rest, at 0.5 s
PIPE = {a: math.pi + 2 * math.asin(a) + 2 * math.cos(math.asin(a)) + 4 * (math.cos(math.asin(a) / 2) + math.sin(math.asin(a) / 2)) for a in (0, 1)}
CIRCLE = "-mesh_spacing 0.0625"
STRIP = "-mesh_spacing 0.05"
PROBE = " -probes wire -wire_kind point -wire_at "
# title: (case, its run, more options, answer, exact value)
ANSWERS = {
    "strip footing, smooth: force (N/m)": ("strip", "smooth_0.05", "", "plate_force_y over plate_y=-0.05:-0.02", (2 + math.pi) * 1500),
    "strip footing, rough: force (N/m)": ("strip", "rough_0.05", "", "plate_force_y over plate_y=-0.05:-0.02", (2 + math.pi) * 1500),
    "circular footing, smooth: force (N)": ("circle", "smooth", CIRCLE, "footing_force_y over footing_y=-0.012:-0.004", 5.689 * math.pi / 4 * 3000),
    "circular footing, rough: force (N)": ("circle", "rough", CIRCLE, "footing_force_y over footing_y=-0.012:-0.004", 6.048 * math.pi / 4 * 3000),
    "deep pipe, smooth: force (N/m)": ("pipe", "a_0", "-mesh_spacing 0.125", "pipe_force_x over pipe_x=0.04:0.06", -PIPE[0] * 3000),
    "deep pipe, rough: force (N/m)": ("pipe", "a_1", "-mesh_spacing 0.125", "pipe_force_x over pipe_x=0.04:0.06", -PIPE[1] * 3000),
    "T-bar: force on its half (N/m)": ("tbar", "ideal", "", "bar_force_x over bar_x=0.1:0.2", -PIPE[1] * 1500),
    "slab dragged over clay, ends on nodes: force (N/m)": ("dragged_slab", "ends_on_nodes", "", "slab_force_x over time=0.2:0.6", -2000.0),
    "slab dragged over clay, ends off nodes: force (N/m)": ("dragged_slab", "ends_off_nodes", "", "slab_force_x over time=0.2:0.6", -2025.0),
    "block on a slope, friction: momentum (kg m/s)": ("contact_pairs", "friction", "-mesh_spacing 0.05", "block_momentum_x at end", 1034.1),
    "block on a slope, limit of shear: momentum (kg m/s)": ("contact_pairs", "limit", "-mesh_spacing 0.05", "block_momentum_x at end", 2645.9),
    "two elastic bars: force between them (N)": ("contact_pairs", "bars", "", "a_b_force_x over time=0.07:0.115", -0.05 * 3162.3),
    "two elastic bars: momentum of the second (kg m/s)": ("contact_pairs", "bars", "", "b_momentum_x at end", 10.0),
    "wheel that rolls: momentum (kg m/s)": ("rolling", "rolls_coarse", "", "wheel_momentum_x at end", 250 * math.pi * 2 / 3 * G * math.sin(math.radians(20))),
    "plate in a fluid: velocity at 0.1 m (m/s)": ("plate", "d_20mm", "-mesh_upper 1.9,0.48 -layer_upper 1.5,0.48" + PROBE + "0,0.1",
                                                  "wire_velocity_x at end", 0.1 * math.erf(0.1 / 2 / math.sqrt(0.005))),
    "channel: velocity in the middle (m/s)": ("channel", "newtonian", PROBE + "0.5,0.5", "wire_velocity_x at end", CHANNEL),
    "thick cylinder: force on the ring (N)": ("thick_cylinder", "20_cells", "-mesh_spacing 0.0125", "ring_force_x over time=0.7:0.8",
                                              -2 * math.pi * 0.05 * LAME),
    "thick cylinder: radial stress at 1.5 m (Pa)": ("thick_cylinder", "20_cells", "-mesh_spacing 0.0125" + PROBE + "1.5,0.025",
                                                    "wire_stress_xx at end", LAME / 3 * (1 - 4 / 2.25)),
    "strip load on ground: reaction of the base (N/m)": ("surface_loads", "strip", "", "wall_ymin_force_y at end", -(16e3 * G + 50e3)),
    "embankment: reaction of the base (N/m)": ("embankment", "embankment", "", "wall_ymin_force_y at end", -19e3 * G),
}


def deck_of(case, run, more, program):
    """The deck of a run of a case."""
    deck = Deck.read(ROOT / Case(case).deck, program)
    words = shlex.split(f"{Case(case).runs[run]} {more} -backend serial")
    names = [k for k, word in enumerate(words) if word.startswith("-") and word[1:2].isalpha()]
    deck.update({words[k][1:]: " ".join(words[k + 1:end]) for k, end in zip(names, [*names[1:], len(words)])})
    return deck


def row_of(title, found, exact):
    """A row of the table: a certificate and the exact value, or why there is none."""
    if not isinstance(found, Certificate):
        return f"| {title} | | | | {exact:.5g} | | refused: {found} |"
    order = "-" if found.order is None else f"{found.order:.1f}"
    bar = "none" if found.bar is None else f"{found.bar:.2g}"
    holds = "yes" if found.holds(exact) else "no" if found.bar is not None else "no bar"
    values = ", ".join(f"{value:.5g}" for value in reversed(found.values))
    return f"| {title} | {values} | {order} | {found.value:.5g} ± {bar} | {exact:.5g} | {holds} | {found.verdict} |"


def table(found):
    """The table of {title: certificate or reason}."""
    head = ["| answer | at 4h, 2h, h | order | answer and bar | exact | holds it | verdict |", "| --- | --- | --- | --- | --- | --- | --- |"]
    return "\n".join([*head, *(row_of(title, each, ANSWERS[title][4]) for title, each in found.items())])


def write_page(found):
    begin, end = "<!-- certificates -->\n", "<!-- end of certificates -->"
    before, _, rest = PAGE.read_text().partition(begin)
    counted = [isinstance(each, Certificate) and each.holds(ANSWERS[title][4]) for title, each in found.items()]
    PAGE.write_text(f"{before}{begin}\n{sum(counted)} of {len(counted)} bars hold the exact value.\n\n{table(found)}\n\n{end}{rest.partition(end)[2]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--only", default="")
    parser.add_argument("--docs", action="store_true")
    arguments = parser.parse_args()
    found = {}
    for number, (title, (case, run, more, answer, exact)) in enumerate(ANSWERS.items()):
        if arguments.only and not any(word in title for word in arguments.only.split(",")):
            continue
        try:
            folder = arguments.out / f"{case}_{run}_{sum(map(ord, more)):d}"
            found[title] = certify(deck_of(case, run, more, arguments.program.resolve()), Answer.of(answer), folder)
        except Problem as problem:
            found[title] = str(problem).splitlines()[0]
        print(f"{number + 1}: {row_of(title, found[title], exact)}", flush=True)
    holding = sum(isinstance(each, Certificate) and each.holds(ANSWERS[title][4]) for title, each in found.items())
    print(f"{holding} of {len(found)} bars hold the exact value")
    if arguments.docs:
        write_page(found)
    sys.exit(0 if holding >= LEAST * len(found) else 1)


if __name__ == "__main__":
    main()
