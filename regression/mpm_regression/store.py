"""Results of the suite in a JSON file, merged case by case:

    {"version": ..., "cases": {CASE: {BACKEND-PRECISION: {"machine": ..., "seconds": s, "rows": [...]}}}}
"""

import json
import math
import platform
import re
import subprocess
from pathlib import Path


def load(path):
    path = Path(path)
    return json.loads(path.read_text()) if path.exists() else {"cases": {}}


def keep(path, case, variant, rows, seconds, runs):
    """Puts the rows of a case in one variant into the file, in place of what it held for them."""
    results = load(path)
    results["version"] = version(runs)
    results["cases"].setdefault(case.name, {})["-".join(variant)] = {
        "machine": machine(variant[0]), "seconds": round(seconds, 1), "rows": [as_dict(row, variant[1]) for row in rows]}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n")


def merge(path, others):
    """Puts what other files hold into one, the later over the earlier: results of several machines or calls."""
    results = load(path)
    for other in map(load, others):
        results["version"] = other["version"]
        for name, variants in other["cases"].items():
            for variant, entry in variants.items():
                results["cases"].setdefault(name, {})[variant] = {"machine": other.get("machine", ""), **entry}
    path.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n")


def as_dict(row, precision):
    def number(x):
        return float(f"{x:.8g}") if math.isfinite(x) else None

    return {"what": row.what, "answer": number(row.answer), "exact": number(row.exact), "error": number(row.error()),
            "tolerance": row.tolerance_in(precision), "relative": row.relative, "at_least": row.at_least,
            "source": row.source, "shortfall": row.shortfall, "verdict": row.verdict(precision)}


def machine(backend):
    """The processor's name, and the GPU's where the back end is cuda."""
    if backend == "cuda":
        query = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
        gpu, driver = subprocess.run(query, stdout=subprocess.PIPE, text=True).stdout.splitlines()[0].split(", ")
        return f"{gpu}, driver {driver}"
    names = re.findall(r"^model name\s*:\s*(.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    return names[0] if names else platform.machine()


def version(runs):
    """The version of the program that made the runs."""
    return next((json.loads((run.folder / "options.json").read_text())["version"] for run in runs.values()), "")
