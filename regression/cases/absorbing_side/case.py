"""Absorbing side

A pulse runs along a bar to an absorbing side, whose dashpots have the factor $a$ (`-mesh_xmax_dashpot_factor`). The reflected
pulse has the velocity $R = (1 - a)/(1 + a)$ times that of the first one, and so the momentum of the bar is $R$ times as large. The same holds for a
shear pulse, which runs between periodic sides to the dashpots along the absorbing one. Level ground that starts with the stress of its weight must stay at rest between absorbing sides, which carry
the static stress, and so must a bank that has come to rest between rollers, when its sides begin to absorb.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.checks.absorbing import reflection_rows, rest_row

SPACING, CELLS, CENTRE = 0.25, 60, 35
DENSITY, PEAK = 2000.0, 0.01
SPEEDS = {"": 100.0, "shear ": 100 / np.sqrt(2)}  # m/s
FACTORS = {"0.5": 20, "1": 20, "2": 20, "1, short pulse": 10, "shear 0.5": 20, "shear 1": 20, "shear 2": 20}  # cells that the pulse is long
GROUND = ("-mesh_upper 4,4 -mesh_ymin absorbing -mesh_xmin absorbing -mesh_ymax free -elastic_poisson 0.3 -gravity 0,-10"
          " -time_courant 0.4")
LEVEL = GROUND + " -bar_shape box -bar_lower 0,0 -bar_upper 4,3 -bar_stress k0 -time_end 4 -history_interval 0.1"
BANK = (GROUND + " -bar_shape polygon -bar_polygon 0,0,4,0,4,1.5,2.5,1.5,1.5,3,0,3 -stages rest,shake -rest_end equilibrium -rest_damping 0.6 -rest_unbalanced_ratio 3e-7 -rest_time_end 5"
        " -rest_mesh_xmin roller -rest_mesh_xmax roller -rest_mesh_ymin fixed -rest_reset on -shake_time_end 4 -history_interval 0.05")


def kind_of(name):
    return "shear " if name.startswith("shear ") else ""


def factor_of(name):
    return name.removeprefix("shear ").split(",")[0]


def run_of(name):
    return name.replace(", ", "_").replace(" ", "_")


def options(name):
    shear = f" -mesh_upper 15,2 -mesh_ymin periodic -mesh_ymax periodic -time_end {0.125 * np.sqrt(2):.6g} -output_interval 1" if kind_of(name) else ""
    return f"-bar_file {{start}} -mesh_xmax_dashpot_factor {factor_of(name)}{shear}"


RUNS = {run_of(name): options(name) for name in FACTORS} | {"level": LEVEL, "bank": BANK}


def prepare(run, path, options):
    pulses = {run_of(name): (kind_of(name), cells) for name, cells in FACTORS.items()}
    if run not in pulses:
        return
    kind, cells = pulses[run]
    position = particles.lattice((0, 0), (CELLS * SPACING, (8 if kind else 1) * SPACING), SPACING / 2)
    x = (position[:, 0] / SPACING - CENTRE) / cells
    pulse = np.where(abs(x) < 0.5, np.cos(np.pi * x) ** 2, 0.0)
    velocity, stress = np.zeros_like(position), np.zeros((len(position), 6))
    velocity[:, 1 if kind else 0] = PEAK * pulse
    stress[:, 3 if kind else 0] = -DENSITY * SPEEDS[kind] * PEAK * pulse
    particles.write(path, "bar", position, SPACING / 2, velocity=velocity, stress=stress)


def check(runs):
    for name in FACTORS:
        axis, begin = ("y", "shear: ") if kind_of(name) else ("x", "")
        yield from reflection_rows(runs[run_of(name)].history, "bar", axis, float(factor_of(name)), (begin, name.removeprefix("shear ")),
                                   0.03 if "short" in name else 0.01)
    yield rest_row(runs["level"].history, "bar", "level", 1e-6)
    yield rest_row(runs["bank"].history, "bar", "bank", 1e-5)


def draw(axes, runs):
    for name in filter(lambda name: not kind_of(name), FACTORS):
        run = runs[run_of(name)].history
        axes.plot(run["time"], run["bar_momentum_x"] / run["bar_momentum_x"][0], label=f"a = {name}")
    axes.set(xlabel="time (s)", ylabel="momentum over that at the start")
    axes.legend()
