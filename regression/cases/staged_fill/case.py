"""A column built in lifts

A column of elastic soil is built in two lifts, each 2 m high, between rollers. Stages place the second lift, and then a rigid plate
that its own weight moves. The vertical stress is the weight of what lies above. The first lift settles by $q h / (2 M)$ in the
mean under a load $q$ on it, where $M$ is the constrained modulus and $h$ the height of a lift, and the second by
$q h / M + q h / (2 M)$. A stage gives the first lift a material that is four times as stiff: nothing moves by
that alone, and a force on the plate then settles the first lift by a quarter. The new material has another density,
and the masses stay. The last stage removes the plate, and the column rises by what the plate's load has settled it,
with the present stiffness. The same column with pore water that does not flow carries the plate by an excess pore
pressure $u = q K_w / (K_w + M)$; a stage in which the pores drain gives the settlement of drained soil. Where
the ground is higher than the foot of the second lift, `-upper_cut_out` leaves out its part that is in the ground.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame, stage_of

GRAVITY, HEIGHT, DENSITY, PLATE, FORCE, WATER = 10.0, 2.0, 2000.0, 3000.0, 20e3, 4e8
POISSON = 0.2
CONSTRAINED = 1e8 * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
WET = (" -stages first,fill,plated,drained -soil_pore_stiffness 4e8 -drained_soil_pore_stiffness 0 -drained_time_end 6")
CUT = " -rigid_bodies -stages first,fill -upper_lower 0,1.5 -upper_cut_out lower"
RUNS = {"whole": "", "wet": WET, "cut": CUT}
LIFT, LOAD = DENSITY * GRAVITY * HEIGHT, PLATE * GRAVITY


def last(run, stage):
    """The last row of a stage."""
    return np.flatnonzero(run.history["stage"] == stage)[-1]


def ends(run):
    """Fields of the last frame of each stage."""
    return {stage_of(path): read_frame(path)[1] for path in run.frames}


def stress_error(fields):
    """The largest error of the mean vertical stress of the two layers of particles in a cell, over the largest stress."""
    worst = 0.0
    for name in ("lower", "upper"):
        depth = 2 * HEIGHT - fields[name]["reference_height"]
        cell = np.floor(depth / 0.25)
        for n in np.unique(cell):
            mean = fields[name]["stress"][cell == n, 1].mean()
            worst = max(worst, abs(mean + DENSITY * GRAVITY * (n + 0.5) * 0.25))
    return worst / (2 * LIFT)


def check(runs):
    run, h = runs["whole"], runs["whole"].history
    at = [last(run, stage) for stage in range(1, 6)]
    base = -h["wall_ymin_force_y"]

    def settled(body, one, other):
        return h[f"{body}_centre_y"][at[one]] - h[f"{body}_centre_y"][at[other]]

    yield Row("mass of the second lift before it is placed, kg", h["upper_mass"][at[0]], 0, 0, "the deck")
    yield Row("mass of the second lift then, kg", h["upper_mass"][at[1]], DENSITY * HEIGHT, 1e-9, "the deck", relative=True,
              single=1e-6)
    yield Row("mass of the first lift with its new material, kg", h["lower_mass"][at[3]], DENSITY * HEIGHT, 1e-9, "masses stay",
              relative=True, single=1e-6)
    for n, (what, load) in enumerate((("the first lift", LIFT), ("both lifts", 2 * LIFT), ("lifts and plate", 2 * LIFT + LOAD),
                                      ("all and the force", 2 * LIFT + LOAD + FORCE), ("both lifts again", 2 * LIFT))):
        yield Row(f"force on the base over the weight: {what}", base[at[n]] / load, 1, 1e-3, "equilibrium")
    yield Row("error of the vertical stress of cells over the largest, both lifts", stress_error(ends(run)["fill"]), 0, 0.004,
              "the weight above")
    mean = LIFT * HEIGHT / (2 * CONSTRAINED)
    yield Row("settlement of the first lift by the second", settled("lower", 0, 1), mean, 0.01, "elasticity", relative=True,
              single=0.02)
    mean = LOAD * HEIGHT / (2 * CONSTRAINED)
    yield Row("settlement of the first lift by the plate", settled("lower", 1, 2), mean, 0.01, "elasticity", relative=True,
              single=0.02)
    yield Row("settlement of the second lift by the plate", settled("upper", 1, 2), 3 * mean, 0.01, "elasticity", relative=True,
              single=0.02)
    late = slice(at[2] - 20, at[2])  # rows of equal intervals
    yield Row("mean force on the plate over its weight, last second", h["plate_force_y"][late].mean() / LOAD, 1, 1e-3, "equilibrium")
    mean = FORCE * HEIGHT / (2 * 4 * CONSTRAINED)
    yield Row("settlement of the first lift by the force, four times as stiff", settled("lower", 2, 3), mean, 0.02, "elasticity",
              relative=True, single=0.05)
    yield Row("settlement of the second lift by the force", settled("upper", 2, 3),
              2 * mean + FORCE * HEIGHT / (2 * CONSTRAINED), 0.02, "elasticity", relative=True, single=0.05)
    mean = (LOAD + FORCE) * HEIGHT / (2 * 4 * CONSTRAINED)
    yield Row("rise of the first lift without the plate", -settled("lower", 3, 4), mean, 0.02, "elasticity", relative=True,
              single=0.05)
    yield Row("movement of the plate after it was removed, m", np.ptp(h["plate_y"][at[3] + 1:]), 0, 0, "it is not there")
    yield Row("force of the plate after it was removed, N", np.abs(h["plate_force_y"][at[3] + 1:]).max(), 0, 0, "it is not there")
    yield from check_water(runs["wet"])
    yield from check_cut(runs["cut"])


def check_water(run):
    h, at = run.history, [last(run, stage) for stage in range(1, 5)]
    excess = ends(run)["plated"]["lower"]["excess_pore_pressure"].mean()
    before = ends(run)["fill"]["lower"]["excess_pore_pressure"].mean()
    yield Row("excess pore pressure by the plate", excess - before, LOAD * WATER / (WATER + CONSTRAINED), 0.01,
              "elasticity and stiff water", relative=True, single=0.02)
    full = ((LIFT + LOAD) / 2 + LIFT / 3) * HEIGHT / CONSTRAINED
    wet = full * CONSTRAINED / (WATER + CONSTRAINED)
    moved = h["lower_centre_y"][at[2]] - h["lower_centre_y"][at[3]]
    yield Row("settlement of the first lift as its pores drain", moved, full - wet, 0.01, "elasticity", relative=True, single=0.02)


def check_cut(run):
    h, at = run.history, [last(run, stage) for stage in range(1, 3)]
    yield Row("second lift, cut where the ground is: mass, kg", h["upper_mass"][at[1]], DENSITY * HEIGHT, 1e-9, "the shapes",
              relative=True, single=1e-6)
    yield Row("second lift, cut: force on the base over the weight", -h["wall_ymin_force_y"][at[1]] / (2 * LIFT), 1, 1e-3,
              "equilibrium")


def draw(axes, runs):
    h = runs["whole"].history
    for body, label, start in (("lower", "first lift", 0.5 * HEIGHT), ("upper", "second lift", 1.5 * HEIGHT)):
        there = h[f"{body}_mass"] > 0
        axes.plot(h["time"][there], 1e3 * (h[f"{body}_centre_y"][there] - start), label=label)
    for stage in range(2, 6):
        axes.axvline(h["time"][np.flatnonzero(h["stage"] == stage)[0]], color="k", lw=0.6, ls="--")
    axes.set(xlabel="time (s)", ylabel="mean displacement (mm)")
    axes.legend()
