"""Convergence of the run-out of the submarine landslide of Dong, Wang & Randolph (2015), inputs/landslide.opts, with the mesh.

The soil is that of the paper (fixed domains, FLIP), and the same that keeps together (-particle_domain split, APIC). The run-out
is that of the furthest particle and of the 99.9th percentile of the particles' x; the slide has stopped when the latter has come
within 0.05 m of its end.
"""

import json
import shlex

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from soil_mpm.markdown_table import print_table
from soil_mpm.runout import run_out
from soil_mpm.tree import ROOT

BACKEND = "cuda"
DECK = ROOT / "inputs" / "landslide.opts"
PAPER, SPLIT = "as in the paper", "split, APIC"
SOILS = {PAPER: "-time_step {step}", SPLIT: "-particle_domain split -velocity_update apic"}
TIMES = (4.0, 8.0, 11.0, 15.0)  # s
STOPPED = 0.05                  # m before the end


def options(spacing):
    """The deck's mesh and base with cells of another size [m]."""
    h = float(spacing)
    return (f"-mesh_spacing {spacing} -mesh_lower -12,{-2 * h:g} -mesh_upper 88,{5 + 3 * h:g} -base_lower -12,{-2 * h:g}"
            f" -output_frames off")


def add_options(parser):
    parser.add_argument("--spacings", type=lambda text: text.split(","), default=["0.25", "0.1", "0.05", "0.025"], help="m, coarsest first")


def deck_without_step(folder):
    """The deck without its time step: domains that become short ask for shorter steps than the paper's."""
    deck = folder / "landslide.opts"
    deck.parent.mkdir(parents=True, exist_ok=True)
    deck.write_text("\n".join(line for line in DECK.read_text().splitlines() if not line.startswith("-time_step")))
    return deck


def runs_of(arguments):
    """{(soil, spacing): options}."""
    deck = deck_without_step(arguments.folder)
    return {(name, spacing): f"-options_file {shlex.quote(str(deck))} {options(spacing)} {SOILS[name].format(step=2e-3 * float(spacing))}"
            for name in SOILS for spacing in arguments.spacings}


def stop(of):
    """Time [s] at which the slide has stopped."""
    toe = run_out(of, "slide", "xq999")
    return of.history["time"][np.flatnonzero(toe < toe[-1] - STOPPED)[-1] + 1]


def print_tables(arguments, runs):
    """Run-outs at several times, and when the slide has stopped."""
    rows = []
    for (name, spacing), of in runs.items():
        toes = [np.interp(TIMES, of.history["time"], run_out(of, "slide", column)) for column in ("xmax", "xq999")]
        report = json.loads((of.folder / "performance.json").read_text())["particles"]
        particles = of.history["slide_particles"][-1] if "slide_particles" in of.history else report
        cells = [f"{first:.2f} / {most:.2f}" for first, most in zip(*toes)]
        rows.append([name, spacing, f"{particles:,.0f}", *cells, f"{stop(of):.1f}"])
    print_table("Run-out (m) of the furthest particle / of the 99.9th percentile",
                ["soil", "cells (m)", "particles", *(f"{time:g} s" for time in TIMES), "stops at (s)"], rows)


def draw(arguments, runs):
    """The toe over time."""
    figure, axes = plt.subplots(1, len(SOILS), sharey=True, layout="constrained", figsize=(9, 3.2))
    for axis, name in zip(axes, SOILS):
        for spacing, style in zip(arguments.spacings, ("C0:", "C1--", "C2-.", "C3-")):
            of = runs[name, spacing]
            axis.plot(of.history["time"], run_out(of, "slide", "xq999"), style, lw=1.3, label=f"{spacing} m")
        axis.axhspan(20, 25, color="0.9", zorder=0)
        axis.axvline(11, color="0.7", lw=0.8, zorder=0)
        axis.set(title=name, xlabel="time (s)", xlim=(0, 15), ylim=(0, 27))
    axes[0].set_ylabel("run-out, 99.9th percentile (m)")
    axes[0].legend(title="cells", fontsize=8, title_fontsize=8, loc="lower right")
    axes[1].text(0.3, 20.3, "published: 20 to 25 m, 11 s", fontsize=8, color="0.4")
    return figure
