#!/usr/bin/env python3
"""Random materials on random paths: 2D is 3D, single precision is near double, stress control reaches what it wants, and the
strains that it found for elastic soil give the same stresses again when they are the path.

Usage: random_paths.py PATH_TO_mpm [--count N] [--seed S] [--law LAW]
"""
import argparse
import pathlib
import random
import sys

from mpm_regression.point import COMPONENTS, STRAIN, STRESS, deck_of, run_point, scratch_folder, write_path


def frictional(dice):
    friction = dice.uniform(20, 42)
    return dict(young=10 ** dice.uniform(6.5, 8), poisson=dice.uniform(0.1, 0.4), cohesion=dice.uniform(1e3, 2e4),
                friction_deg=friction, dilation_deg=dice.uniform(0, friction / 2))


def clay(dice):
    return dict(young=10 ** dice.uniform(6, 7.5), poisson=dice.uniform(0.2, 0.49), su=10 ** dice.uniform(3.5, 5))


def cam_clay(dice):
    parameters = dict(critical_state_ratio=dice.uniform(0.8, 1.4), kappa=dice.uniform(0.01, 0.05),
                      poisson=dice.uniform(0.1, 0.35), specific_volume=dice.uniform(1.6, 2.8), ocr=dice.uniform(1, 4))
    parameters["lambda"] = parameters["kappa"] * dice.uniform(3, 8)
    return parameters


def softening(dice):
    return dict(clay(dice), young=2e7, su=1e4, remoulded_ratio=dice.uniform(0.2, 0.9), xi95=dice.uniform(1, 20), rate_factor=0.1,
                rate_reference=1e-3, surface=dice.choice(("von_mises", "tresca")))


LAWS = {
    "linear_elastic": lambda dice: dict(young=10 ** dice.uniform(6, 8), poisson=dice.uniform(0, 0.45)),
    "von_mises": clay,
    "tresca": clay,
    "mohr_coulomb": frictional,
    "drucker_prager": lambda dice: dict(frictional(dice), match=dice.choice(("compression", "extension", "plane_strain"))),
    "cam_clay": cam_clay,
    "softening_clay": softening,
    "power_elastic": lambda dice: dict(bulk_modulus=10 ** dice.uniform(6.5, 8), pressure_reference=1e5,
                                       exponent=dice.uniform(0, 1), poisson=dice.uniform(0.1, 0.4)),
    "j2_hardening": lambda dice: dict(young=10 ** dice.uniform(6.5, 8), poisson=dice.uniform(0.1, 0.4),
                                      yield_stress=10 ** dice.uniform(4, 5), hardening_modulus=10 ** dice.uniform(5, 6)),
    "mu_i": lambda dice: dict(young=10 ** dice.uniform(6.5, 8), poisson=dice.uniform(0.1, 0.4), mu_static=0.38, mu_dynamic=0.64,
                              inertial_number=0.279, grain_diameter=1e-3, grain_density=2600),
    "yield_stress_fluid": lambda dice: dict(bulk_modulus=1e8, shear_modulus=1e6, yield_stress=dice.uniform(1e3, 1e5),
                                            consistency=dice.uniform(1e2, 1e4), exponent=dice.uniform(0.4, 1)),
    "newtonian": lambda dice: dict(bulk_modulus=1e7, viscosity=10 ** dice.uniform(2, 5)),
}
BY_STRESS = [law for law in LAWS if law not in ("newtonian", "yield_stress_fluid", "mu_i")]  # their shear stress is a rate's
ROWS, PARTS = 12, 20


def random_strains(dice, flat, start):
    """Columns of a path of random strain increments that turns twice; in plane strain ezz is 0."""
    columns = {"dt": [1.0] * (ROWS + 1)}
    for k, c in enumerate(COMPONENTS):
        columns["de" + c] = [0.0] * (ROWS + 1)
        columns["s" + c] = [start if k < 3 else 0.0] * (ROWS + 1)
    for n in range(1, ROWS + 1):
        if n % 4 == 1:
            size = 10 ** dice.uniform(-4, -2.7)
            rates = [dice.uniform(-1, 1) * size for _ in COMPONENTS]
            lift = sum(rates[:3]) / 3 + size * dice.uniform(-0.1, 0.3)
            rates = [rate - lift if k < 3 else rate for k, rate in enumerate(rates)]  # neither torn nor crushed
            if flat:
                rates[2] = rates[4] = rates[5] = 0.0
        for c, rate in zip(COMPONENTS, rates):
            columns["de" + c][n] = rate
    return columns


def bearable(parameters, start):
    """A stress increment [Pa] of a row that is small against the stress and, over all rows, against the strength."""
    strength = parameters.get("su", float("inf")) * parameters.get("remoulded_ratio", 1)
    return min(0.05 * abs(start), 0.03 * strength)


def random_control(dice, columns, size):
    """Replaces the strains of some sides in the columns by stress increments of at most `size` [Pa]; the columns."""
    for c in dice.sample(COMPONENTS[:3], dice.choice((1, 2, 2, 3))):
        columns["ds" + c] = [None] + [size * dice.uniform(-1, 1) for _ in range(ROWS)]
        columns["de" + c] = [None] * (ROWS + 1)
        for n in range(1, ROWS + 1):
            if dice.random() < 0.25:  # a row by strain, after which the stress is as it is
                columns["ds" + c][n], columns["de" + c][n] = None, -1e-5
    return columns


def largest(table, names):
    return max(max(map(abs, table[name])) for name in names)


def difference(one, other, names):
    return max(abs(a - b) for name in names for a, b in zip(one[name], other[name])) / max(largest(other, names), 1e-300)


def misses(columns, table, start):
    """Largest difference of a stress from what the path wants, over the largest stress."""
    most = 0.0
    for c in COMPONENTS[:3]:
        if "ds" + c not in columns:
            continue
        goal = start
        for n in range(1, ROWS + 1):
            change = columns["ds" + c][n]
            if change is None:
                goal = table["s" + c][n]
                continue
            goal += change
            most = max(most, abs(table["s" + c][n] - goal))
    return most / largest(table, STRESS)


def check_strains(run, dice, law, parameters, start):
    deck, flat = deck_of(law, **parameters), dice.random() < 0.7
    columns, faults = random_strains(dice, flat, start), []
    double = run(deck, columns, "double", 3)
    single = run(deck, columns, "single", 3)
    if flat:
        for precision, right, most in (("double", double, 1e-9), ("single", single, 1e-3)):
            off = difference(run(deck, columns, precision, 2), right, STRESS)
            if not off <= most:
                faults.append(f"2D differs from 3D by {off:.1e} in {precision}")
    off = difference(single, double, STRESS)
    if not off <= 5e-3:
        faults.append(f"single differs from double by {off:.1e}")
    return faults


def check_control(run, dice, law, parameters, start):
    deck = deck_of(law, **parameters)
    columns, faults = random_control(dice, random_strains(dice, True, start), bearable(parameters, start)), []
    for precision, most in (("double", 1e-7), ("single", 5e-4)):
        table = run(deck, columns, precision, dice.choice((2, 3)))
        if not (off := misses(columns, table, start)) <= most:
            faults.append(f"stress control misses by {off:.1e} of the largest stress in {precision}")
        if precision == "double" and law == "linear_elastic":  # others depend on the way within a row
            replayed = {"time": table["time"], **{name: table[name] for name in STRAIN + STRESS}}
            off = difference(run(deck, replayed, precision, 3), table, STRESS)
            if not off <= 1e-6:
                faults.append(f"the strains that were found give stresses that differ by {off:.1e}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--law", help="only the paths of this law, of those N")
    arguments = parser.parse_args()
    binary, faults = pathlib.Path(arguments.binary).resolve(), []
    with scratch_folder() as folder:
        folder = pathlib.Path(folder)

        def run(deck, columns, precision, dim):
            write_path(folder / "path.csv", columns)
            return run_point(binary, folder / "run", deck, folder / "path.csv", "-precision", precision, "-dim", dim,
                             "-element_parts", PARTS)

        for n in range(arguments.count):
            dice = random.Random(1000 * arguments.seed + n)
            by_stress = n % 2 == 1
            law = (BY_STRESS if by_stress else list(LAWS))[n // 2 % len(BY_STRESS if by_stress else LAWS)]
            if arguments.law not in (None, law):
                continue
            parameters, start = LAWS[law](dice), -(10 ** dice.uniform(4.5, 5.5))
            check = check_control if by_stress else check_strains
            try:
                found = check(run, dice, law, parameters, start)
            except RuntimeError as error:
                found = [str(error)]
            faults += [f"path {n}, {law}: {fault}\n{deck_of(law, **parameters)}" for fault in found]
            print(f"path {n:3d} {law:20s} {'stress' if by_stress else 'strain'}: {'; '.join(found) or 'sound'}")
    print("\n".join(faults) or f"{arguments.count} paths passed")
    sys.exit(1 if faults else 0)


main()
