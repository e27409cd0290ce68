"""Flows whose particles are brought to an even density

The dam break of the case `dam_break` with `-position_correction delta`, beside the same runs without it.
The depth of a column of cells may differ from the mean of both neighbours by 2 % of the mean depth (standard deviation; columns of two cells
or more), and the share of a node's volume that particles fill may scatter by as much inside the fluid. The correction may add no energy to
speak of, and no momentum: mass times velocity is what gravity and the walls have made of it (`reliability/random/run correction`).
"""

import numpy as np

from mpm_regression import cases
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.flow import depths, filling, unevenness
from soil_mpm.results import read_frame

DAM = cases.Case("dam_break").module
DECK = "regression/cases/dam_break/case.opts"
SPLIT = "-basin_file {start} -particle_domain split"
RUNS = {"split": f"{SPLIT} -position_correction delta", "split_none": SPLIT,
        "fixed": "-basin_file {start} -position_correction delta", "fixed_none": "-basin_file {start}"}
LOWER, UPPER, SPACING, COUNT = (-3.6, 0.0), (6.0, 1.2), 0.05, 192
LONG = True
prepare = DAM.prepare
LINES = "Particles gather in bands without the correction."


def halves(frame):
    size = len(frame["position"])
    return np.stack([frame.get(f"half_length_{axis}", np.full(size, SPACING / 4)) for axis in "xy"], axis=1)


def even(frame):
    return unevenness(depths(frame["position"], frame["volume"], halves(frame)[:, 0], LOWER, SPACING, COUNT))


def even_inside(frame):
    return filling(frame["position"], frame["volume"], halves(frame), LOWER, UPPER, SPACING, [[True, False]] * 2)[1]


def check(runs):
    for domain in ("split", "fixed"):
        with_it, without = runs[domain], runs[domain + "_none"]
        for when, time in (("halfway", 0.48), ("at the end", 0.96)):
            pair = [read_frame(run.frame_near(time))[1]["basin"] for run in (with_it, without)]
            yield Row(f"standard deviation of the depth {when}, {domain} domains", even(pair[0]), 0, 0.02, "an even flow",
                      shortfall="Domains of a fixed size." if domain == "fixed" else "", bound=0.04)
            yield Row(f"standard deviation of the filled share of a node {when}, {domain} domains", even_inside(pair[0]), 0, 0.03, "an even density")
            yield Row(f"the same without the correction, {when}, {domain} domains", even_inside(pair[1]), 0, 0.03, "an even density",
                      shortfall=LINES, bound=0.3)
        energy = with_it.history["basin_kinetic_energy"][-1]
        yield Row(f"kinetic energy that the correction adds, over that of the fluid, {domain} domains",
                  with_it.history["basin_corrected_energy"][-1] / energy, 0, 0.01, "none")
        yield Row(f"energy of height that it adds, over the kinetic energy, {domain} domains",
                  with_it.history["basin_raised_energy"][-1] / energy, 0, 0.01, "none")
        yield Row(f"speed of the front over Ritter's, {domain} domains", DAM.front_speed(with_it) / DAM.FRONT, 0.875, 0.125,
                  "at most 1, and 3/4 at least")


def draw(axes, runs):
    for k, name in enumerate(("fixed_none", "fixed")):
        place = last_frame(runs[name], "basin")["position"]
        axes.plot(place[:, 0], place[:, 1] + 1.0 * k, ".", ms=0.8, label=("without correction", "with, moved by 1 m")[k])
    axes.set(xlabel="x (m)", ylabel="height (m)", aspect="equal")
    axes.legend(loc="upper right")
