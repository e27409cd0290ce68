#!/usr/bin/env python3
"""Replays files of element tests by the program itself: -element_path with 40 parts a row, in both precisions.

Usage: replays.py PATH_TO_mpm [--folder FOLDER]   (FOLDER: files NAME.csv or soils_NAME.csv; default unit/replays)

The files are those of an independent program. Measured are the largest difference of the mean stress over the file's
largest mean, or over its largest deviator where that is more, and the largest difference of a component of the deviator
over the file's largest. Both have a tolerance, and one for the first state variable.
"""
import argparse
import pathlib
import sys

from mpm_regression.point import STRESS, deck_of, read_table, run_point, scratch_folder

HERE = pathlib.Path(__file__).resolve().parent
MEAN, DEVIATOR, STATE = 1e-3, 3e-3, 3e-3
LARGE_INCREMENTS = {"softening_random_ps": 2e-2}  # of the deviator
MEAN_ONLY = {"power_isotropic"}
# The independent program forgets the gap of soil that has parted: these are compared up to where it first does.
PARTS = {"dp_random_3d", "dp_random_ps", "mc_random_3d", "mc_random_ps"}
FREE_YZ = {"dp_random_3d", "mc_random_3d", "mcc_random_3d", "tresca_random_3d"}  # 3D alone

SAND = dict(young=2e7, poisson=0.3, cohesion=5000, friction_deg=30, dilation_deg=10)
CONE = dict(young=1e7, poisson=0.3, cohesion=8000, friction_deg=25, dilation_deg=5, tension=3000)
CLAY = dict(critical_state_ratio=1, kappa=0.04, poisson=0.25, specific_volume=2, pressure_min=1)
CLAY["lambda"] = 0.2
SOFT = dict(young=1.5e6, poisson=0.49, su=3000, remoulded_ratio=0.2, xi95=10, rate_factor=0.1, rate_reference=1e-3)
FLUID = dict(bulk_modulus=1e7, shear_modulus=1e4, yield_stress=30, consistency=5)
DECKS = {
    "dp_random_3d": ("drucker_prager", dict(CONE, match="compression")),
    "dp_random_ps": ("drucker_prager", dict(CONE, match="plane_strain")),
    "mc_oedometer": ("mohr_coulomb", dict(young=2e7, poisson=0.2, cohesion=0, friction_deg=30)),
    "mc_random_3d": ("mohr_coulomb", dict(SAND, tension=2000)),
    "mc_random_ps": ("mohr_coulomb", dict(SAND, tension=2000)),
    "mc_shear": ("mohr_coulomb", SAND),
    "mc_triaxial": ("mohr_coulomb", SAND),
    "mcc_drained": ("cam_clay", dict(CLAY, ocr=1)),
    "mcc_low_pressure": ("cam_clay", dict(CLAY, preconsolidation=8000)),
    "mcc_oedometer": ("cam_clay", dict(CLAY, ocr=1)),
    "mcc_random_3d": ("cam_clay", dict(CLAY, preconsolidation=150000)),
    "mcc_undrained_ocr1": ("cam_clay", dict(CLAY, ocr=1)),
    "mcc_undrained_ocr4": ("cam_clay", dict(CLAY, ocr=4)),
    "mui_shear": ("mu_i", dict(young=1e6, poisson=0.3, mu_static=0.38, mu_dynamic=0.64, inertial_number=0.279,
                               grain_diameter=5e-4, grain_density=2450)),
    "power_isotropic": ("power_elastic", dict(bulk_modulus=2e7, pressure_reference=1e5, exponent=0.5, poisson=0.25)),
    "softening_random_ps": ("softening_clay", SOFT),
    "softening_shear": ("softening_clay", SOFT),
    "tresca_random_3d": ("tresca", dict(young=5e5, poisson=0.49, su=1000)),
    "tresca_random_ps": ("tresca", dict(young=5e5, poisson=0.49, su=1000)),
    "yield_stress_fluid_n0.5": ("yield_stress_fluid", dict(FLUID, exponent=0.5)),
    "yield_stress_fluid_n1": ("yield_stress_fluid", dict(FLUID, exponent=1)),
}


def mean_of(table, n):
    return sum(table[name][n] for name in STRESS[:3]) / 3


def deviator_of(table, n):
    mean = mean_of(table, n)
    return [table[name][n] - (mean if k < 3 else 0) for k, name in enumerate(STRESS)]


def misfit(table, right, until_it_parts):
    """Differences of the mean, the deviator and the first state variable, each over the file's largest."""
    rows = range(len(right["time"]))
    if len(table["time"]) != len(right["time"]):
        raise RuntimeError(f"{len(table['time'])} rows in lieu of {len(right['time'])}")
    largest = max(abs(x) for n in rows for x in deviator_of(right, n))
    largest_mean = max([largest] + [abs(mean_of(right, n)) for n in rows])
    if until_it_parts:
        rows = range(next((n for n in rows if table["parted_volume"][n] > 0), len(rows)))
        if len(rows) < 2:
            raise RuntimeError(f"only {len(rows)} rows before the soil parts")
    mean = max(abs(mean_of(table, n) - mean_of(right, n)) for n in rows)
    deviator = max(abs(a - b) for n in rows for a, b in zip(deviator_of(table, n), deviator_of(right, n)))
    state = 0.0
    for brief, full in (("xi", "plastic_strain"), ("Pc", "preconsolidation"), ("v", "specific_volume")):
        if brief in right:
            size = max(max(map(abs, right[brief])), 1e-6)
            state = max(state, max(abs(table[full][n] - right[brief][n]) for n in rows) / size)
    return mean / largest_mean, deviator / max(largest, 1e-300), state


def check(binary, name, file, folder, precision):
    model, parameters = DECKS[name]
    right = read_table(file)
    faults = []
    for dim in (3,) if name in FREE_YZ else (2, 3):
        table = run_point(binary, pathlib.Path(folder) / f"{name}_{precision}_{dim}", deck_of(model, **parameters), file,
                          "-element_parts", 40, "-precision", precision, "-dim", dim)
        mean, deviator, state = misfit(table, right, name in PARTS)
        print(f"{name:26s} {precision:6s} {dim}D: mean {mean:.2e}, deviator {deviator:.2e}, state {state:.2e}")
        if not mean <= MEAN:
            faults.append(f"{name} {precision} {dim}D: the mean differs by {mean:.2e}, at most {MEAN}")
        most = LARGE_INCREMENTS.get(name, DEVIATOR)
        if name not in MEAN_ONLY and not deviator <= most:
            faults.append(f"{name} {precision} {dim}D: the deviator differs by {deviator:.2e}, at most {most}")
        if not state <= STATE:
            faults.append(f"{name} {precision} {dim}D: a state variable differs by {state:.2e}, at most {STATE}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("--folder", type=pathlib.Path, default=HERE.parent / "unit" / "replays")
    arguments = parser.parse_args()
    binary = pathlib.Path(arguments.binary).resolve()
    files = {path.stem.removeprefix("soils_"): path for path in sorted(arguments.folder.glob("*.csv"))}
    files = {name: path for name, path in files.items() if name in DECKS or path.stem.startswith("soils_")
             or arguments.folder == HERE.parent / "unit" / "replays"}
    faults = [f"no deck for the replay {name}" for name in files if name not in DECKS]
    faults += [f"the replay {name} is missing" for name in DECKS if name not in files]
    with scratch_folder() as folder:
        for name, file in files.items():
            if name in DECKS:
                for precision in ("double", "single"):
                    faults += check(binary, name, file, folder, precision)
    print("\n".join(faults) or f"{len(files)} replays passed")
    sys.exit(1 if faults else 0)


main()
