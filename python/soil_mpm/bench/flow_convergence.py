"""Convergence of the collapse of a column of clay (the case clay_column) with the mesh, for several strengths and velocity updates.

The outline of a run is the depth of the soil, volume over width, in columns of 0.1 m whatever the mesh is. Two meshes are compared
by the sum of the differences of the depth over that of the depth.
"""

import shlex

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from soil_mpm.flow import depths, measures, unevenness
from soil_mpm.markdown_table import print_table
from soil_mpm.results import read_frame
from soil_mpm.tree import CASES

BACKEND = "serial"
DECK = CASES / "clay_column" / "case.opts"
LOWER, LENGTH, WIDTH = (0.0, 0.0), 4.0, 0.1  # m, of the mesh and of a column of the outline
TIMES = (0.5, 1.0, 1.5, 3.0)  # s
COUNT = round(LENGTH / WIDTH)


def add_options(parser):
    words = lambda text: text.split(",")
    parser.add_argument("--su", type=words, default=["100", "500", "1000", "2000"], help="Pa")
    parser.add_argument("--updates", type=words, default=["flip", "xpic", "apic"])
    parser.add_argument("--spacings", type=words, default=["0.1", "0.05", "0.025"], help="m, the coarsest first")


def runs_of(arguments):
    """{(update, su, spacing): options}."""
    return {(update, su, h): f"-options_file {shlex.quote(str(DECK))} -p2g tile -clay_su {su} -velocity_update {update} -mesh_spacing {h}"
            for h in arguments.spacings for su in arguments.su for update in arguments.updates}


def soil_at(of, time):
    return read_frame(of.frame_near(time))[1]["soil"]


def outline(soil):
    """Depth [m] in each column."""
    return depths(soil["position"], soil["volume"], soil["half_length_x"], LOWER, WIDTH, COUNT) * WIDTH


def difference(coarse, fine):
    """Difference of two outlines, over the finer one [%]."""
    return 100 * np.abs(coarse - fine).sum() / fine.sum()


def evenness(of, spacing, time):
    """Standard deviation of the depth between columns of cells over the mean depth [%], and empty cells, of all cells below the
    surface [%]."""
    soil, count = soil_at(of, time), round(LENGTH / float(spacing))
    depth = depths(soil["position"], soil["volume"], soil["half_length_x"], LOWER, float(spacing), count)
    _, empty = measures(soil["position"], LOWER, float(spacing), count)
    return 100 * unevenness(depth), 100 * empty / (soil["volume"].sum() / float(spacing) ** 2)


def print_tables(arguments, runs):
    """Differences of outlines between meshes, and how even the soil is."""
    pairs = list(zip(arguments.spacings, arguments.spacings[1:]))
    rows, even = [], []
    for su in arguments.su:
        for update in arguments.updates:
            lines = {h: [outline(soil_at(runs[update, su, h], time)) for time in TIMES] for h in arguments.spacings}
            cells = [" / ".join(f"{difference(lines[a][n], lines[b][n]):.1f}" for a, b in pairs) for n in range(len(TIMES))]
            rows.append([su, update, *cells])
            figures = [evenness(runs[update, su, h], h, time) for time in (1.5, 3.0) for h in arguments.spacings]
            even.append([su, update, *(f"{uneven:.1f} / {empty:.1f}" for uneven, empty in figures)])
    print_table("Difference of the outlines of two meshes (%): " + ", ".join(f"{a} and {b} m" for a, b in pairs),
                ["su (Pa)", "update", *(f"{time} s" for time in TIMES)], rows)
    print_table("Standard deviation of the depth between columns of cells over the mean depth (%) / empty cells (%)",
                ["su (Pa)", "update", *(f"{time} s, {h} m" for time in (1.5, 3.0) for h in arguments.spacings)], even)


def draw(arguments, runs):
    """The outlines at two times."""
    figure, axes = plt.subplots(len(arguments.su), len(arguments.updates), squeeze=False, sharex=True, sharey=True,
                                layout="constrained", figsize=(4.2 * len(arguments.updates), 2.3 * len(arguments.su)))
    edges = LOWER[0] + WIDTH * np.arange(COUNT + 1)
    for row, su in zip(axes, arguments.su):
        for axis, update in zip(row, arguments.updates):
            for spacing, style in zip(arguments.spacings, ("C0:", "C1--", "C2-", "C3-")):
                for time in (0.5, 1.5):
                    depth = outline(soil_at(runs[update, su, spacing], time))
                    axis.plot((edges[1:] + edges[:-1]) / 2, depth, style, lw=1.2, label=f"{spacing} m" if time == 0.5 else None)
            axis.set_title(f"su = {su} Pa, {update}", fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel("x (m)")
    for axis in axes[:, 0]:
        axis.set_ylabel("depth (m)")
    axes[0, 0].legend(title="cells; at 0.5 and 1.5 s", fontsize=7, title_fontsize=7)
    return figure
