"""Regression cases in groups for one GPU, and long tests for 16 cores of a processor beside it, for scripts/gpu_checks.

Each group ends well within ten minutes. Processes that share a GPU take turns of some milliseconds, and a row of the history
waits for several turns: one run at a time (--jobs 1) is the fastest unless all runs of a group are long.
"""

import os
import shlex
import signal
import subprocess
import sys
import tarfile
import time

from soil_mpm.bench.runs import environment
from soil_mpm.tree import ROOT

ANSWERS = {  # cases on the GPU
    "limits": ["footing_surcharge", "footing_weight", "cut_friction", "cut_tresca", "retaining_wall_fine", "footing_square",
               "footing_cohesion"],
    "flows": ["strip_gradient", "film_fine", "tbar", "slump", "deep_sphere", "collapse_fine", "landslide"],
    "clay": ["footing", "footing_coarse", "landslide_coarse", "strip", "strip_fine", "pipe", "pipe_fine", "cut", "cut_fine",
             "shear_band"],
    "variants": ["footing_variants"],  # with `sequential`, one thread of the GPU
    "contact": ["incline", "incline_turned", "dragged_slab", "pushed_slab", "rolling", "rigid_body", "half_model", "patch",
                "free_stream", "simple_shear", "spin"],
    "quick": ["bar", "column", "water_column", "water_footing", "water_slope", "water_undrained", "infinite_slope", "film", "channel",
              "collapse", "plate", "sloshing", "dam_break", "retaining_wall", "footing_cohesion_coarse", "footing_surcharge_coarse",
              "footing_weight_coarse", "cut_friction_coarse"],
    "site": ["masses", "k0_ground", "embankment", "timed_loads", "stages", "staged_fill", "probes", "moving_side", "absorbing_side",
             "absorbing_cylinder", "stiffness_field", "surface_loads", "sliding_side", "free_field"],
    "periodic": ["periodic", "periodic_flow", "periodic_slope", "oblique_wave"],
    "domains": ["clay_column", "large_deformation", "large_waves", "energy", "energy_collapse", "even_flow", "vortex"],
    "revolution": ["thick_cylinder", "cylinders", "circle", "deep_sphere_section", "circle_fine", "quarter", "cavity", "cavity_sphere"],
    "pairs": ["contact_pairs", "pair_bars", "pair_bending", "pair_hertz", "pair_pullout"],
    "balls": ["pair_balls"],
    "bodies": ["rigid_contact", "rolling", "cad", "joints", "parts", "masses", "turning", "light_body"],
}
PROCESSOR_ANSWERS = {  # back ends, threads and runs at a time, cases: the longest first
    "limits": ("openmp", 2, 7, ["footing_surcharge", "footing_weight", "footing_cohesion", "cut_tresca", "cut_friction",
                                "retaining_wall_fine"]),
    "flows": ("openmp", 2, 7, ["deep_sphere", "footing_square", "collapse_fine", "landslide", "film_fine", "tbar", "cavity", "cavity_sphere", "circle_fine",
                              "vortex"]),
    "clay": ("serial,openmp", 2, 9, ["footing_variants", "strip_fine", "cut_fine", "pipe_fine", "strip_gradient", "footing", "pipe",
                                     "slump", "strip", "cut", "footing_coarse"]),
}
PROCESSOR_ANSWERS["quick"] = ("serial,openmp", 1, 14, [*ANSWERS["contact"], *ANSWERS["quick"], "shear_band", "landslide_coarse"])
PROCESSORS = {  # commands at the same time, in regression/; random decks take up to 4 ranks of 2 threads
    "soil": ["reliability/random/run collapses {program} --count 200 --jobs 4", "reliability/random/run water {program} --count 60 --jobs 2",
             "reliability/random/run courant {program} --jobs 2"],
    "files": ["reliability/kill.py {program} --kills 220", "reliability/kill.py {program} --kills 40 --seed 3 --ranks 2",
              "reliability/faults.py {program} {inject}", "reliability/files.py {program} {inject}",
              "reliability/random/run starts {program} --count 40", "fuzz/decks.py {program} --count 10000 --jobs 6"],
    "images": ["metamorphic/run {program} --count 1000 --seed 3 --each 6 --jobs 16 --minutes 8 --json {out}/images.json"
               " --keep {out}/differ"],
}


class Clock:
    """How long commands may still run."""

    def __init__(self, minutes):
        self.end = time.monotonic() + 60 * minutes

    def left(self):
        return max(1.0, self.end - time.monotonic())


def processor_build():
    """The folder of a bundle's build without CUDA; None if it has none, or in the source tree."""
    builds = sorted((ROOT / "libexec").glob("*/mpm"))
    return next((path.parent for path in builds if not path.parent.name.startswith("cuda")), None)


def settings(threads):
    """Environment of tests on processors: the bundle's mpirun first, its build for processors, and so many threads."""
    more = {"OMP_NUM_THREADS": str(threads), "OMP_WAIT_POLICY": "passive", "OMPI_MCA_rmaps_base_oversubscribe": "1",
            "OMPI_MCA_hwloc_base_binding_policy": "none"}
    build = processor_build()
    if build:
        more |= {"PATH": f"{ROOT / 'bin'}:{os.environ['PATH']}", "MPM_PRESET": build.name}
    return environment() | more


def run_together(commands, log, clock, setting):
    """Runs commands at the same time until the clock ends them; their output goes to a file, one after another. Whether all
    ended with 0."""
    begin, running = time.monotonic(), []
    for k, command in enumerate(commands):
        part = log.with_suffix(f".part{k}")
        with open(part, "w") as file:
            running.append((command, part, subprocess.Popen(command, cwd=ROOT, stdout=file, stderr=subprocess.STDOUT, env=setting,
                                                            start_new_session=True)))
    sound = True
    for command, part, process in running:
        try:
            printed = f"exit status {process.wait(clock.left())}"
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            printed = f"exit status {process.wait()}, ended for lack of time"
        took = time.monotonic() - begin
        sound = sound and process.returncode == 0
        text = f"$ {shlex.join(map(str, command))}\n{part.read_text(errors='replace')}{printed} after {took:.0f} s at most\n"
        with open(log, "a") as file:
            file.write(text)
        part.unlink()
        print("".join(text.splitlines(True)[-6:]), end="", flush=True)
    return sound


def suite(program, backends, cases, given, results, log, setting, jobs):
    """Runs regression/run for some cases and keeps the results."""
    command = [sys.executable, "regression/run", "--binary", program, "--backends", backends, "--jobs", str(jobs), "--json",
               given.out / results, "--out", given.scratch / "cases", *cases]
    return run_together([command], given.out / log, given.clock, setting)


def answers(name, program, given):
    return suite(program, given.backend, ANSWERS[name], given, "gpu.json", "answers.txt", environment(), given.jobs)


def processor_answers(name, program, given):
    backends, threads, jobs, cases = PROCESSOR_ANSWERS[name]
    return suite(program, backends, cases, given, "cpu.json", "processors.txt", settings(threads), jobs)


def processors(name, program, given):
    inject = (processor_build() or program.parent.parent / "regression") / "libmpm_inject.so"
    commands = [[sys.executable, *shlex.split(f"regression/{line}".format(program=program, inject=inject, out=given.out))] for line in PROCESSORS[name]]
    return run_together(commands, given.out / "processors.txt", given.clock, settings(1) | {"TMPDIR": str(given.scratch)})


def keep_curves(given):
    """Puts options and history of the cases' runs on the GPU into runs.tar.xz, for regression/run --draw."""
    paths = [path for history in sorted((given.scratch / "cases").glob(f"*/{given.backend}-*/*/history.csv"))
             for path in (history.parent / "options.json", history)]
    if paths:
        with tarfile.open(given.out / "runs.tar.xz", "w:xz") as archive:
            for path in paths:
                archive.add(path, path.relative_to(given.scratch / "cases"))
