"""Runs on several ranks, a GPU each (or a core each): weak and strong scaling of the footing strip, and the landslide.

Weak: 5,898,240 particles a rank, a strip of L/B = 230.4 for each. Strong: strips of 23,592,960 and 94,371,840 particles
whatever the number of ranks. Landslide: the slab of L/H = 480, cut in boxes and by METIS. On processors all are smaller by
the factor SMALLER.
"""

import shlex
import shutil
import subprocess
from dataclasses import dataclass
from datetime import date

from soil_mpm.bench.runs import HISTORY, Setting, commit, environment, performance, speed_of
from soil_mpm.tree import ROOT

WEAK, STRONG, SLIDE = 5898240, (23592960, 94371840), 4423680
SMALLER = 64  # on processors
STEPS = {"cuda": 400, "serial": 100}


@dataclass(frozen=True)
class Case:
    kind: str       # weak, strong, landslide or largest
    particles: int  # of all ranks
    ranks: int
    backend: str
    precision: str
    partition: str

    def options(self):
        problem = "landslide" if self.kind == "landslide" else "footing"
        size = Setting(problem, self.particles, self.backend, self.precision, "tile").size()
        steps = STEPS[self.backend] * (4 if problem == "landslide" else 1)
        return (f"-options_file inputs/{problem}.opts -backend {self.backend} -precision {self.precision} -p2g tile"
                f" -partition {self.partition} -time_max_steps {steps} {size} {HISTORY}")

    def key(self):
        return (self.kind, self.particles, self.ranks, self.backend, self.precision, self.partition)


def cases(ranks, backend, precisions, largest):
    """largest: particles of one more case, in single precision on the most ranks; 0 for none."""
    shrink = 1 if backend == "cuda" else SMALLER
    found = []
    for n in ranks:
        for precision in precisions:
            found.append(Case("weak", n * WEAK // shrink, n, backend, precision, "box"))
            found += [Case("strong", size // shrink, n, backend, precision, "box") for size in STRONG]
            found += [Case("landslide", SLIDE // shrink, n, backend, precision, how) for how in ("box", "metis")
                      if n > 1 or how == "box"]
    if largest:
        found.append(Case("largest", largest, max(ranks), backend, "single", "box"))
    return found


def command(program, case, folder):
    """mpirun of the bundle where there is one."""
    beside = program.parent / "mpirun"
    start = [str(beside if beside.exists() else "mpirun"), "-n", str(case.ranks), "--bind-to", "none"]
    return [*start, str(program), *shlex.split(case.options()), "-output_dir", str(folder)]


def measure(program, case, repeats, folder):
    """The fastest of several runs, its figures of the ranks, and its machine."""
    done = []
    for _ in range(repeats):
        shutil.rmtree(folder, ignore_errors=True)
        words = command(program, case, folder)
        run = subprocess.run(words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                             env={"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMP_NUM_THREADS": "1", **environment()})
        if run.returncode != 0:
            return {"failed": f"{shlex.join(words)}: exit status {run.returncode}\n{run.stdout[-1500:]}"}
        report = performance(folder)
        done.append({**speed_of(report), **figures_of_ranks(report)})
    best = min(done, key=lambda each: each["us"])
    return {**case.__dict__, **best, "all_us": [each["us"] for each in done], "date": date.today().isoformat(),
            "commit": commit()}


def figures_of_ranks(report):
    """Balance of the particles, nodes and kB of the halo, and shares of the time, where there are several ranks."""
    ranks = report["between_ranks"]
    if ranks is None:
        return {}

    def balance(name):
        return ranks[name]["most"] / ranks[name]["mean"] if ranks[name]["mean"] > 0 else 1

    return {"balance": balance("particles"), "halo_nodes": ranks["halo_nodes"]["most"],
            "kB": ranks["sent_bytes_per_step"]["most"] / 1e3, "compute_s": ranks["compute_seconds"]["most"],
            "work_balance": balance("compute_seconds"), "wait_s": ranks["wait_seconds"]["most"]}


def cell(us, reference, weak):
    if us is None:
        return "-"
    rate = "" if reference is None else (f" ({100 * reference / us:.1f} %)" if weak else f" ({reference / us:.2f})")
    return f"{us:,.0f}{rate}"


def table(runs, kind, backend):
    """us a step by ranks; in brackets the efficiency (weak), or the speed over one rank."""
    mine = [each for each in runs if each["kind"] == kind and each["backend"] == backend]
    columns = list(dict.fromkeys((each["particles"] if kind != "weak" else 0, each["partition"], each["precision"])
                                 for each in mine))
    ranks = sorted({each["ranks"] for each in mine})

    def us(column, n):
        for each in mine:
            size = each["particles"] if kind != "weak" else 0
            if (size, each["partition"], each["precision"]) == column and each["ranks"] == n:
                return each["us"]
        return None

    def title(column):
        size, partition, precision = column
        words = [f"{size:,}"] if size else []
        return ", ".join([*words, *([partition] if kind == "landslide" else []), precision])

    lines = ["| ranks | " + " | ".join(map(title, columns)) + " |", "| --- |" + " --- |" * len(columns)]
    for n in ranks:
        cells = []
        for column in columns:
            first = (column[0], "box", column[2]) if kind == "landslide" else column
            cells.append(cell(us(column, n), us(first, 1) if n > 1 else None, kind == "weak"))
        lines.append(f"| {n} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def details(runs, backend):
    """Figures of the ranks of the runs on several of them."""
    lines = ["| case | ranks | particles, largest over mean | work, largest over mean | halo, nodes | kB a rank and step | "
             "waiting, share of the time | bytes a particle |", "| --- |" + " --- |" * 7]
    for each in runs:
        if each["backend"] != backend or (each["ranks"] == 1 and each["kind"] != "largest"):
            continue
        whole = each["us"] * each["steps"] / 1e6
        wait = f"{100 * each['wait_s'] / whole:.0f} %" if "wait_s" in each else "-"
        name = f"{each['kind']}, {each['particles']:,}, {each['partition']}, {each['precision']}"
        lines.append(f"| {name} | {each['ranks']} | {each.get('balance', 1):.3f} | {each.get('work_balance', 1):.3f} | "
                     f"{each.get('halo_nodes', 0):.0f} | {each.get('kB', 0):.1f} | {wait} | {each['bytes']:.1f} |")
    return "\n".join(lines)


def text_of(runs):
    parts = []
    for backend in dict.fromkeys(each["backend"] for each in runs):
        mine = [each for each in runs if each["backend"] == backend]
        unit = "GPUs" if backend == "cuda" else "cores"
        states = sorted({(each["date"], each["commit"], each["kind"]) for each in mine})
        when = "; ".join(f"{date}, commit {state}: {', '.join(kind for d, c, kind in states if (d, c) == (date, state))}"
                         for date, state in dict.fromkeys(each[:2] for each in states))
        parts.append(f"us a step on {unit} ({mine[0]['device']}; {when}).")
        for kind, what in (("weak", "Weak scaling, the footing strip (efficiency):"),
                           ("strong", "Strong scaling, the footing strip (speed over one):"),
                           ("landslide", "The landslide (speed over one):"), ("largest", "The largest:")):
            if any(each["kind"] == kind and each["backend"] == backend for each in runs):
                parts += [what, table(runs, kind, backend)]
        parts += ["What the ranks did:", details(runs, backend)]
    return "\n\n".join(parts)
