"""Stages of a run

A column of elastic soil comes to equilibrium under its weight (the unbalanced ratio falls below $5 \\cdot 10^{-5}$), and its velocities
are set to zero. The base then carries the weight, and $\\sigma_h/\\sigma_v = \\nu/(1-\\nu)$. Without damping the column must
stay where it is: in 1.5 s, some hundred times that of a wave through a cell, no particle moves by $10^{-4}$ of a cell. A plate
above it then moves by a table whose time begins with the stage, until it has moved by 0.1 m; then it goes up, gravity is halved, and the soil comes to
equilibrium again.
A run of three stages with the same options must give the same positions and stresses as one without stages, bit by bit.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, stage_of

POISSON, DENSITY, GRAVITY, CELL = 0.3, 2000.0, 9.81, 0.25
# Steps whose multiple is the time of a stage, so that no stage ends with a shorter one. `gather` has the same bits on a GPU too.
PLAIN = " -p2g gather -time_step 0.001 -time_end 0.3 -history_interval 0.01 -output_interval 0.1 -damping 0.1 -rest_time_end 0.1"
ALONE = " -plate_motion prescribed -plate_velocity 0,-1"
RUNS = {"whole": "", "one": PLAIN + ALONE + " -stages rest -rest_time_end 0.3",
        "three": PLAIN + ALONE + " -stages rest,again,last -again_time_end 0.1 -last_time_end 0.1"}


def rows_of(run, stage):
    return np.flatnonzero(run.history["stage"] == stage)


def ends(run):
    """(stage, fields of the soil) of every frame."""
    return [(stage_of(path), read_frame(path)[1]["soil"]) for path in run.frames]


def check(runs):
    run = runs["whole"]
    h = run.history
    yield Row("stages that the history tells", len(np.unique(h["stage"])), 4, 0, "the deck")
    geostatic = rows_of(run, 1)[-1]
    yield Row("unbalanced ratio at the end of the first stage", h["unbalanced_ratio"][geostatic], 0, 5e-5, "the deck")
    weight = h["soil_mass"][0] * GRAVITY
    yield Row("force on the base over the weight", -h["wall_ymin_force_y"][geostatic] / weight, 1, 2e-4, "equilibrium")
    settled = [fields for stage, fields in ends(run) if stage == "geostatic"][-1]
    stress = settled["stress"]
    yield Row("sum of horizontal over sum of vertical stress", stress[:, 0].sum() / stress[:, 1].sum(), POISSON / (1 - POISSON),
              0.005, "elasticity, confined compression", relative=True)
    rest = [fields for stage, fields in ends(run) if stage == "rest"][-1]
    moved = np.abs(rest["position"] - settled["position"]).max() / CELL
    yield Row("largest movement without damping, cells", moved, 0, 1e-4, "equilibrium", single=2e-3)
    push = rows_of(run, 3)
    yield Row("displacement of the plate at the end of its stage, m", -h["plate_y"][push[-1]], 0.1,
              0.2 * run.number("history_interval") * 1.01, "the deck")
    yield Row("displacement of the plate a row before, m", min(-h["plate_y"][push[-2]], 0.1), 0.1,
              0.2 * run.number("history_interval") * 1.01, "the deck")
    begin = h["time"][push[0] - 1]
    t = h["time"][push] - begin
    travel = np.where(t < 0.2, t**2 / 2, 0.02 + 0.2 * (t - 0.2))
    yield Row("plate: largest error of the displacement over the largest",
              np.abs(-h["plate_y"][push] - travel).max() / travel.max(), 0, 1e-12, "integral of the table")
    relief = rows_of(run, 4)[-1]
    yield Row("force of the plate over the weight at the end of its stage", h["plate_force_y"][push[-1]] / weight, 0.1, 0,
              "the plate presses the soil", at_least=True)
    yield Row("force on the base over half of the weight, last stage", -h["wall_ymin_force_y"][relief] / (weight / 2), 1, 0.002,
              "equilibrium")
    moved = h["plate_y"][relief] - h["plate_y"][push[-1]]
    went = 0.1 * (h["time"][relief] - h["time"][push[-1]])
    yield Row("movement of the plate in the last stage over its velocity times the time", moved / went, 1, 1e-12, "the deck")
    one, three = ends(runs["one"])[-1][1], ends(runs["three"])[-1][1]
    differ = sum(not np.array_equal(one[key], three[key]) for key in one)
    yield Row("fields that differ between one stage and three with the same options", differ, 0, 0, "the same bits")


def draw(axes, runs):
    h = runs["whole"].history
    axes.semilogy(h["time"], np.maximum(h["unbalanced_ratio"], 1e-12), label="unbalanced ratio")
    for stage in range(2, 5):
        axes.axvline(h["time"][rows_of(runs["whole"], stage)[0]], color="k", lw=0.6, ls="--")
    axes.set(xlabel="time (s)", ylabel="unbalanced ratio")
    axes.legend()
