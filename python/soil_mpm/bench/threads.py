"""How the threads of `-backend openmp` share a footing, and what as many programs at once do with a part of it each.

Cores that are all at work run slower than one alone (their clock, their share of the memory's bandwidth), whatever the
program. So the threads are held against single threads that are at work at the same time, each bound to a core, with as many
particles as a thread has, and all for the same time, so that none has the machine to itself at the end: what is lost against
them is the program's own.
"""

import os
import shlex
import shutil
import statistics
import subprocess
from datetime import date

from soil_mpm.bench.runs import HISTORY, Setting, commit, environment, performance, speed_of
from soil_mpm.tree import ROOT

SIZES = (737280, 5898240)  # particles of all threads: strips of L/B = 28.8 and 230.4
LEAST = 25600              # of a thread: a shorter strip has no room for the plate
UPDATES_A_THREAD = 4e7     # particle updates of a run
LEAST_STEPS = 20           # the first one makes sums that each of the others finds made
AT_ONCE = 5                # s, that programs run which are at work at the same time
STOPPED = 75               # exit status of those


def cases(sizes, words):
    """Numbers of particles, those given or of two strips, and of threads: those given, or 1, 2, 4 ... and all cores."""
    cores = len(os.sched_getaffinity(0))
    threads = [int(word) for word in words.split(",")] if words else sorted({2**k for k in range(12) if 2**k <= cores} | {cores})
    sizes = [int(word) for word in sizes.split(",")] if sizes else SIZES
    return [(size, count) for size in sizes for count in threads if size // count >= LEAST]


def command(program, threads, particles, precision, length, folder):
    size = Setting("footing", particles, "openmp", precision, "tile").size()
    options = (f"-options_file inputs/footing.opts -backend openmp -precision {precision} -p2g tile {length}"
               f" {size} {HISTORY} -output_dir {folder}")
    return [str(program), *shlex.split(options)], {**environment(), "OMP_NUM_THREADS": str(threads),
                                                   "OMP_PROC_BIND": "spread" if threads > 1 else "false",
                                                   "OMP_PLACES": "threads", "OMPI_MCA_ess_singleton_isolated": "1"}


def run_at_once(program, programs, threads, particles, precision, folder):
    """The figures of several programs at once, each of so many threads and particles and, if they are many, on a core."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    length = f"-wall_time_limit {AT_ONCE}"
    if programs == 1:
        length = f"-time_max_steps {max(LEAST_STEPS, round(UPDATES_A_THREAD * threads / particles))}"
    cores = sorted(os.sched_getaffinity(0))
    started = []
    for n in range(programs):
        words, env = command(program, threads, particles, precision, length, folder / str(n))
        bind = ["taskset", "-c", str(cores[n * len(cores) // programs])] if threads == 1 else []
        started.append(subprocess.Popen([*bind, *words], cwd=ROOT, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True))
    texts = [each.communicate()[0] for each in started]
    for process, text in zip(started, texts):
        if process.returncode not in (0, STOPPED):
            raise SystemExit(f"{shlex.join(process.args)}: exit status {process.returncode}\n{text[-2000:]}")
    return [speed_of(performance(folder / str(n))) for n in range(programs)]


def measure(program, particles, threads, precision, repeats, folder):
    """M particle updates/s of the threads, and of as many programs at once; medians of runs that take turns."""
    together, apart = [], []
    part = particles // threads // 640 * 640  # 640: a column of cells
    for _ in range(repeats):
        (one,) = run_at_once(program, 1, threads, particles, precision, folder)
        together.append(one["count"] / one["us"])
        parts = run_at_once(program, threads, 1, part, precision, folder) if threads > 1 else [one]
        apart.append(sum(each["count"] / each["us"] for each in parts))
    return {"kind": "threads", "particles": particles, "ranks": threads, "backend": "openmp", "precision": precision,
            "rate": statistics.median(together), "apart": statistics.median(apart), "device": one["device"],
            "machine": one["machine"], "copy": one["copy"], "moved": one["moved"],
            "functions": one["functions"], "date": date.today().isoformat(),
            "commit": commit()}


def text_of(runs):
    parts = []
    for table in dict.fromkeys((each["particles"], each["precision"]) for each in runs):
        mine = sorted((each for each in runs if (each["particles"], each["precision"]) == table), key=lambda each: each["ranks"])
        where, one = mine[0], mine[0]["rate"] / mine[0]["ranks"]
        lines = ["| threads | M particle updates/s | over as many times the first row | programs at once, M updates/s | over those | "
                 "share of the copy's bandwidth |", "| --- |" + " --- |" * 5]
        for each in mine:
            share = f"{100 * each['moved'] / each['copy']:.0f} %" if each.get("copy") else "-"
            lines.append(f"| {each['ranks']} | {each['rate']:.1f} | {100 * each['rate'] / (one * each['ranks']):.0f} % | "
                         f"{each['apart']:.1f} | {100 * each['rate'] / each['apart']:.0f} % | {share} |")
        parts += [f"Footing, {where['particles']:,} particles, {where['precision']} precision ({where['machine'].split(', ')[0]}; "
                  f"{where['date']}, commit {where['commit']}):", "\n".join(lines)]
    return "\n\n".join(parts)
