"""Timed runs of the two problems of Dong, Wang & Randolph (2015) at any of their sizes.

A run makes as many steps as its back end does in a second or so, without frames. What it took is read from its
performance.json: us a step (steps and rebuilds, without output) and the time of each function. Repeated, the run with the
median counts.
"""

import json
import os
import re
import shlex
import shutil
import statistics
import subprocess
from dataclasses import asdict, dataclass
from datetime import date

from soil_mpm.tree import ROOT

# Particles of the paper's Tables 1 and 3: strips of L/B = 3 to 230.4, 25,600 particles for each B, and slabs of
# L/H = 7.5 to 480, 9,216 particles for each H, which is 48 cells.
FOOTING = (76800, 115200, 245760, 737280, 1474560, 2949120, 5898240)
LANDSLIDE = (69120, 138240, 276480, 552960, 1105920, 2211840, 3317760, 4423680)
UPDATES = {"serial": 3e7, "openmp": 1e8, "cuda": 2e9}  # particle updates of a run
FEWEST = {"serial": 3, "openmp": 3, "cuda": 200}       # steps: on a GPU some are timed function by function
MOST_STEPS = 10000
SLOWER = {"gather": 3, "mosaic": 8}  # than the others, about: they make fewer steps
HISTORY = "-output_frames off -history_interval 1e6 -progress off"


@dataclass(frozen=True)
class Setting:
    problem: str    # footing or landslide
    particles: int  # of the soil
    backend: str
    precision: str
    strategy: str

    def size(self):
        """Options beside the deck's that give the problem its size."""
        if self.problem == "footing":
            length = f"{self.particles / 25600:.12g}"  # m, B = 1 m; 4 B deep, cells of B/40, 4 particles each
            return f"-mesh_upper {length},4.45 -soil_upper {length},4"
        length = self.particles / 9216 * 4.8  # m, H = 4.8 m; cells of H/48, 4 particles each
        # The mesh begins 16 cells below the soil, so that the soil fills whole patches.
        return (f"-mesh_lower -4,-1.6 -mesh_upper {length + 8:.12g},5.3 -base_lower -4,-0.2 -base_upper {length + 8:.12g},0"
                f" -slide_polygon 0,0,{length:.12g},0,{length:.12g},4.8,0,4.8")

    def steps(self):
        wanted = min(MOST_STEPS, UPDATES[self.backend] / self.particles) / SLOWER.get(self.strategy, 1)
        return max(FEWEST[self.backend], round(wanted))

    def key(self):
        return (self.problem, self.particles, self.backend, self.precision, self.strategy)


def run(program, options, folder):
    """Runs the program; its performance.json."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [str(program), *shlex.split(options), "-output_dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment())
    if done.returncode != 0:
        raise SystemExit(f"{shlex.join(command)}: exit status {done.returncode}\n{done.stdout[-2000:]}")
    return performance(folder)


def performance(folder):
    """Report of the run in a folder on its speed (docs/running.md)."""
    return json.loads((folder / "performance.json").read_text())


def environment():
    """Variables with which Open MPI runs for root too."""
    return {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_PROC_BIND": "false", **os.environ}


def backends(program):
    """Back ends that the program was built with: serial, openmp, cuda."""
    text = subprocess.run([str(program), "-help"], stdout=subprocess.PIPE, text=True, env=environment()).stdout
    return re.findall(r"\w+", re.search(r"-backend\n.*\n +takes (.*);", text)[1].replace(" or ", " "))


def speed_of(report):
    """Of a performance.json: us a step in all and of each function {name: us}, bytes a particle, GB/s of a copy and of the
    steps, the strategy that ran, machine and device."""
    steps, copy = report["steps"], report["copy_bandwidth_bytes_per_second"]
    return {"us": 1e6 * report["stepping_seconds"] / steps, "steps": steps, "count": report["particles"], "ran": report["strategy"],
            "functions": {each["name"]: 1e6 * each["seconds"] / steps for each in report["functions"]
                          if 2 * each["calls"] > steps or "rebuild" in each["name"]},  # others were done by few steps alone
            "bytes": report["memory_bytes"] / report["particles"], "copy": copy and copy / 1e9,
            "moved": copy and report["moved_bytes_per_second"] / 1e9,
            "machine": f"{report['processor']}, {report['cores']} cores", "device": report["device"]}


def commit():
    """Commit of the tree, or of the bundle, that was measured."""
    if (ROOT / "BUNDLE").exists():
        return re.search(r"commit (\S+?),", (ROOT / "BUNDLE").read_text())[1]
    done = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    return done.stdout.strip() or "unknown"


def measure(program, setting, repeats, folder):
    """The median of `repeats` runs: the setting, the results of speed_of, us of all repeats, date and commit."""
    options = (f"-options_file inputs/{setting.problem}.opts -backend {setting.backend} -precision {setting.precision}"
               f" -p2g {setting.strategy} -time_max_steps {setting.steps()} {setting.size()} {HISTORY}")
    done = sorted((speed_of(run(program, options, folder)) for _ in range(repeats)), key=lambda each: each["us"])
    median = done[(repeats - 1) // 2]
    if median["count"] != setting.particles:
        raise SystemExit(f"{options}: {median['count']} particles instead of {setting.particles}")
    return {**asdict(setting), **median, "us": statistics.median_low(each["us"] for each in done),
            "all_us": [each["us"] for each in done], "date": date.today().isoformat(), "commit": commit()}
