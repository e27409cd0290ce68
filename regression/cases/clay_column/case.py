"""Collapse of a column of soft clay

Clay of 1800 kg/m3 that stands 2 m high is too weak to stand: it falls, strikes the wall and comes back. There is no exact
answer, but soil that flows has no gaps and an even surface. The depth of a column of cells may differ from the mean of both
neighbours by 2 % of the mean depth (standard deviation), and no cell below the surface may be empty. The wave breaks, so
that a single run means little: for 500 Pa the mean of seven strengths from 470 to 530 Pa is compared. With domains of a fixed
size and FLIP the soil comes apart into fingers. With half the cells, APIC and corrected positions, columns that are 0.5 m and
more away from the walls, where a wave stands, are even.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.flow import depths, measures, unevenness
from soil_mpm.results import read_frame

LONG = True
LOWER, SPACING, COUNT = (0.0, 0.0), 0.1, 40
FINE, AWAY = SPACING / 2, 10  # m, and columns of these cells in 0.5 m
FIXED = "-particle_domain fixed -velocity_update flip"
NEAR = {f"su{pascal}": f"-clay_su {pascal}" for pascal in (470, 480, 490, 510, 520, 530)}
NEAR_FIXED = {f"fixed{name[2:]}": f"{FIXED} {su}" for name, su in NEAR.items()}
RUNS = {"su500": "", "su2000": "-clay_su 2000", "fixed500": FIXED, "fixed2000": f"{FIXED} -clay_su 2000", **NEAR, **NEAR_FIXED,
        "even": f"-mesh_spacing {FINE} -velocity_update apic -position_correction delta -position_correction_rate 5"}
WHAT = {"su500": "su = 500 Pa", "su2000": "su = 2000 Pa"}
SHALLOW = "The layer is only five cells deep."
FINGERS = "Domains of a fixed size and FLIP."
TEN = "The layer is ten cells deep."


def even(frame):
    """Standard deviation of the depth of a column from the mean of its neighbours, over the mean depth."""
    half = frame.get("half_length_x", np.full(len(frame["position"]), SPACING / 4))
    return unevenness(depths(frame["position"], frame["volume"], half, LOWER, SPACING, COUNT))


def uneven_of(runs, names):
    """The mean of even() at the ends of some runs."""
    return np.mean([even(last_frame(runs[name], "soil")) for name in names])


def even_inside(frame):
    """As even(), in the finer run, over columns that are not at a wall."""
    depth = depths(frame["position"], frame["volume"], frame["half_length_x"], LOWER, FINE, round(COUNT * SPACING / FINE))
    return unevenness(depth[AWAY:-AWAY])


def check(runs):
    for name, what in WHAT.items():
        frame, alike = last_frame(runs[name], "soil"), name == "su500"
        yield Row(f"standard deviation of the depth between columns, {what}", uneven_of(runs, [name, *NEAR] if alike else [name]), 0, 0.02,
                  "an even flow", shortfall=SHALLOW, bound=0.12 if alike else 0.1)
        fixed = "fixed" + name[2:]
        yield Row(f"the same, fixed domains, FLIP, {what}", uneven_of(runs, [fixed, *NEAR_FIXED] if alike else [fixed]), 0, 0.02,
                  "an even flow", shortfall=FINGERS, bound=0.25 if alike else 0.2)
        _, empty = measures(frame["position"], LOWER, SPACING, COUNT)
        yield Row(f"empty cells below the surface, {what}", empty, 0, 0, "no gap")
        rough, _ = measures(frame["position"], LOWER, SPACING, COUNT)
        yield Row(f"mean second difference of the surface, {what} (cells)", rough, 0, 0.25, "an even flow")
        mass = runs[name].history["soil_mass"] + runs[name].history["soil_lost_mass"]
        yield Row(f"largest change of the mass, {what}", np.abs(mass / mass[0] - 1).max(), 0, 1e-12, "definition", single=1e-5)
        pieces = runs[name].history["soil_particles"][-1] / runs[name].history["soil_particles"][0]
        yield Row(f"particles over those at the start, {what}, at most 8", max(pieces, 8), 8, 0, "bound on splitting")
    for time in (1.5, 3):
        frame = read_frame(runs["even"].frame_near(time))[1]["soil"]
        yield Row(f"standard deviation 0.5 m away from walls, su = 500 Pa, cells of 0.05 m, APIC, corrected, {time} s",
                  even_inside(frame), 0, 0.02, "an even flow", shortfall=TEN, bound=0.04)


def draw(axes, runs):
    for name, height in (("fixed500", 0), ("su500", 1)):
        frame = last_frame(runs[name], "soil")
        x, y = frame["position"][:, 0], frame["position"][:, 1]
        axes.plot(x + 4.3 * height, y, ".", ms=1.5, label=("fixed domains, FLIP", "split, XPIC(2)")[height])
    axes.set(xlabel="x (m); the second run is moved by 4.3 m", ylabel="height (m)", aspect="equal")
    axes.legend(loc="upper right")
