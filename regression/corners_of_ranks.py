#!/usr/bin/env python3
"""Corner cases of several ranks: small runs that must give on 2 to 8 ranks what they give on one.

    regression/corners_of_ranks.py PROGRAM [--ranks 2,4] [--dims 2,3] [--precisions double] [--short]

More ranks than patches; a mesh one patch thick; a body that crosses the parts of all ranks, which fill and empty again; two
bodies and two rigids, one of them free, that meet at the cut of two ranks; a body so fast that lists hold for four steps. Each with `-partition box` and `metis`, whose
threshold is so low that patches change hands, and with `tile`, `gather` and whichever is the fastest: with --short, with one of
the three in turn. Bounds: those of compare.py. Needs numpy and h5py.
"""

import argparse
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True

from mpm_regression import cases, differences  # noqa: E402
from mpm_regression.compare import BOUNDS  # noqa: E402
from soil_mpm.bench.runs import performance  # noqa: E402
from soil_mpm.results import Run, read_frame  # noqa: E402

STRATEGIES = ("tile", "gather", "auto")
COMMON = ("-materials soft -soft_model linear_elastic -soft_density 1000 -soft_young 1e6 -soft_poisson 0.3"
          " -mesh_xmin free -mesh_xmax free -time_end 1 -output_interval 1e9 -history_interval 1e9")


def box(name, lower, upper, dim, more=""):
    """Options of a box from what it reaches in 2D; it is 0.8 m deep in 3D."""
    deep = ["", ""] if dim == 2 else [",0.8", ",1.6"]
    return (f"-{name}_shape box -{name}_lower {lower[0]},{lower[1]}{deep[0]} -{name}_upper {upper[0]},{upper[1]}{deep[1]} {more} ")


def mesh(length, height, spacing, dim):
    depth = "" if dim == 2 else ",2.4"
    return f"-dim {dim} -mesh_lower 0,0{depth and ',0'} -mesh_upper {length},{height}{depth} -mesh_spacing {spacing} "


def velocity(vx, vy, dim):
    return f"{vx},{vy}" + (",0.1" if dim == 3 else "")


def decks(dim):
    """{name: (options, steps, most checks by the host)}. A patch has 8 cells an edge in 2D, 4 in 3D."""
    patch = 8 if dim == 2 else 4
    soil = "-bodies soil -soil_material soft "
    return {
        "more ranks than patches": (mesh(1.6, 1.6, 0.2, dim) + soil
                                    + box("soil", (0.4, 0.2), (1.2, 1.0), dim, f"-soil_velocity {velocity(0.5, 0.2, dim)}"), 100, 50),
        "one patch thick": (mesh(0.8 * 6, 0.8, 0.8 / patch, dim) + soil
                            + box("soil", (0.2, 0.2), (4.0, 0.6), dim, f"-soil_velocity {velocity(0.5, 0.1, dim)}"), 100, 50),
        "across all ranks": (mesh(6.4, 1.6, 0.2, dim) + soil + "-time_courant 0.4 "
                             + box("soil", (0.4, 0.4), (1.2, 1.2), dim, f"-soil_velocity {velocity(5, 0, dim)}"), 420, 210),
        # The host checks soil that is so fast after each step.
        "fast": (mesh(6.4, 1.6, 0.2, dim) + soil + "-time_courant 0.4 "
                 + box("soil", (0.4, 0.4), (1.2, 1.2), dim, f"-soil_velocity {velocity(18, 0, dim)}"), 100, 100),
        "meeting at a cut": (mesh(6.4, 1.6, 0.2, dim) + "-bodies soil,other -soil_material soft -other_material soft "
                             + box("soil", (2.0, 0.4), (3.0, 1.2), dim, f"-soil_velocity {velocity(2, 0, dim)}")
                             + box("other", (3.4, 0.4), (4.4, 1.2), dim, f"-other_velocity {velocity(-2, 0, dim)}")
                             + "-rigid_bodies lid,floor " + box("lid", (2.4, 1.2), (4.0, 1.4), dim, "-lid_motion dynamic -lid_density 500 -lid_friction 0.3")
                             + box("floor", (1.0, 0.2), (5.4, 0.4), dim, "-floor_friction 0.3") + "-gravity 0,-9.81" + (",0" if dim == 3 else ""), 200, 100),
    }


def run(program, options, ranks, folder):
    command = [str(program), *shlex.split(options), "-output_dir", str(folder), "-progress", "off"]
    if ranks > 1:
        command = [cases.launcher(), "-n", str(ranks), "--bind-to", "none", *command]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600,
                          env={"OMP_NUM_THREADS": "1", **cases.environment()})
    if done.returncode != 0:
        raise cases.ProgramFailed(f"{shlex.join(command)}: exit status {done.returncode}\n{done.stdout[-1500:]}")
    return Run(folder)


def rebuilds(folder):
    """How many there were, and steps between them: those of one rank."""
    return performance(folder)["rebuilds"]


def looks_too_often(folder, most):
    """How often the host checked the steps, where that is more than `most` times: it should be seldom, on several ranks too, or a device
    waits for it. The host looks each 0.05 s, so that on a machine with other load it may look after each step."""
    done = performance(folder)
    looks = done["looks_of_host"]
    return looks if looks > max(most, done["stepping_seconds"] / 0.02) else 0


def moves(done):
    """Whether the soil moves at the end: a run which does nothing is no success."""
    return abs(read_frame(done.frame)[1]["soil"]["velocity"]).max() > 0


def check(given, folder):
    wrong = 0
    for dim in map(int, given.dims.split(",")):
        for number, (name, (deck, steps, looks)) in enumerate(decks(dim).items()):
            for precision in given.precisions.split(","):
                for strategy in STRATEGIES[number % 3:][:1] if given.short else STRATEGIES:
                    options = f"{COMMON} {deck} -backend {given.backend} -precision {precision} -p2g {strategy} -time_max_steps {steps}"
                    alone = run(given.program, options, 1, folder / "alone")
                    assert moves(alone), name
                    for ranks in map(int, given.ranks.split(",")):
                        for partition in ("box", "metis -rebalance_threshold 1.01"):
                            wrong += compare(given, f"{options} -partition {partition}", looks, ranks, alone, folder / "several",
                                             f"{dim}D {name}, {precision}, {strategy}, {ranks} ranks, {partition.split()[0]}", precision)
    return wrong


def compare(given, options, most_looks, ranks, alone, folder, title, precision):
    bound = BOUNDS[100][precision]
    try:
        apart, where = differences.largest(run(given.program, options, ranks, folder), alone)
        if rebuilds(folder) != rebuilds(folder.parent / "alone"):
            apart, where = float("inf"), f"rebuilds: {rebuilds(folder)}, alone {rebuilds(folder.parent / 'alone')}"
        if looks := looks_too_often(folder, most_looks):
            apart, where = float("inf"), f"{looks} looks of the host, {most_looks} at most"
    except (cases.ProgramFailed, subprocess.TimeoutExpired) as error:
        apart, where = float("inf"), str(error)
    print(f"{'pass' if apart <= bound else 'FAIL'} {title}: {apart:.2g} apart at {where}", flush=True)
    return not apart <= bound


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--ranks", default="2,4")
    parser.add_argument("--dims", default="2,3")
    parser.add_argument("--precisions", default="double")
    parser.add_argument("--backend", default="serial")
    parser.add_argument("--short", action="store_true")
    given = parser.parse_args()
    given.program = given.program.absolute()
    with tempfile.TemporaryDirectory() as folder:
        wrong = check(given, Path(folder))
    print("all agree" if wrong == 0 else f"{wrong} differ")
    return wrong != 0


if __name__ == "__main__":
    sys.exit(main())
