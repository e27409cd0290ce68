"""Energy balance of clay that collapses

Clay that is too weak to stand falls apart over a smooth floor: a wall in 2D, a square block in 3D. Three works of the
[balance](method.md#what-is-measured) have exact values: gravity does the weight times the fall of the centre of mass, smooth walls
do none, and plastic flow takes the strength times the field `plastic_strain`, $\\sum V s_u \\xi$. What is missing must be less than
the share that the log warns of, 5 %, and must fall with the time step. FLIP misses most: noise from cell to cell is lost.
"""

import numpy as np

from mpm_regression.curves import last_frame
from mpm_regression.row import Row

LONG = True
STRENGTH, G = 1000.0, 9.81
BLOCK = ("-dim 3 -mesh_lower 0,0,0 -mesh_upper 1.5,1.5,1.2 -mesh_ymax roller -mesh_zmin roller -mesh_zmax free -gravity 0,0,-9.81 "
         "-soil_lower 0,0,0 -soil_upper 0.5,0.5,1")
FLIP, EVEN, SMALL = "-velocity_update flip -particle_domain fixed", "-position_correction delta", "-time_courant 0.1"
RUNS = {"wall_flip": FLIP, "wall_apic": "", "wall_even": EVEN, "wall_small": SMALL,
        "block_flip": f"{BLOCK} {FLIP}", "block_apic": BLOCK, "block_even": f"{BLOCK} {EVEN}", "block_small": f"{BLOCK} {SMALL}"}
DIMS = {"wall": "2D", "block": "3D"}
UPDATES = {"flip": "FLIP", "apic": "APIC, split", "even": "APIC, split, corrected"}
MISSING = {"flip": 0.05, "apic": 0.02, "even": 0.02}


def largest(h):
    """The largest energy of the run, J."""
    return max(h[name].max() for name in ("energy_kinetic", "energy_internal", "work_gravity"))


def missing(run):
    return np.abs(run.history["energy_error"]).max() / largest(run.history)


def unbalanced(h):
    """Energy that a row of the balance does not explain, over the largest energy."""
    works = sum(h[name] for name in h if name.startswith("work_"))
    held = h["energy_kinetic"] - h["energy_kinetic"][0] + h["energy_internal"] + h["energy_lost"]
    return np.abs(held - works - h["energy_error"]).max() / largest(h)


def fall(h):
    """Weight times the fall of the centre of mass, but for what the correction of positions has raised, J."""
    centre = h["soil_centre_z" if "soil_centre_z" in h else "soil_centre_y"]
    return G * h["soil_mass"] * (centre[0] - centre) + h.get("soil_raised_energy", 0)


def plastic_work(run):
    frame = last_frame(run, "soil")
    return STRENGTH * np.sum(frame["volume"] * frame["plastic_strain"])


def check(runs):
    for shape, dim in DIMS.items():
        for update, words in UPDATES.items():
            run, what = runs[f"{shape}_{update}"], f"{dim}, {words}"
            h = run.history
            yield Row(f"row of the balance, over the largest energy, {what}", unbalanced(h), 0, 1e-12, "definition")
            yield Row(f"largest share of the energy that is missing, {what}", missing(run), 0, MISSING[update], "definition")
            yield Row(f"work of gravity less that of the centre, over the largest energy, {what}",
                      np.abs(h["work_gravity"] - fall(h)).max() / largest(h), 0, 0.005, "weight times fall")
            yield Row(f"work of the smooth walls over the largest energy, {what}", np.abs(h["work_contact"]).max() / largest(h), 0, 1e-12,
                      "smooth walls", single=1e-5)
            yield Row(f"dissipated energy over that of the plastic strain, {what}", h["energy_dissipated"][-1] / plastic_work(run), 1,
                      0.05 if update == "flip" else 0.02, "strength times plastic strain")
        ratio = missing(runs[f"{shape}_apic"]) / missing(runs[f"{shape}_small"])
        yield Row(f"what is missing over that with a fifth of the time step, {dim}", ratio, 1.5, 0, "falls with the time step", at_least=True)


def draw(axes, runs):
    h = runs["block_apic"].history
    for name, label in (("work_gravity", "work of gravity"), ("energy_kinetic", "kinetic"), ("energy_dissipated", "dissipated in the soil"),
                        ("work_update", "velocity update"), ("energy_error", "missing")):
        axes.plot(h["time"], h[name], label=label)
    axes.set(xlabel="time (s)", ylabel="energy (J), block in 3D, APIC")
    axes.legend()
