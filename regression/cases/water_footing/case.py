"""Footing on submerged sand

A footing on sand under water carries what one carries on sand of the buoyant weight $\\gamma'$: the water above the ground
presses on all of it alike. With stiffness, cohesion and the square of the speed in the ratio $r = \\gamma'/\\gamma$, the
submerged run is the dry one with time stretched by $r^{-1/2}$ and all stresses times $r$, step by step, so that the force on
the footing is too. Water 0.3 m above the ground and 20 m above it must give the same.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row

DENSITY, WATER, G, TOP, SPACING = 2000.0, 1000.0, 10.0, 2.0, 0.0625
RATIO = 1 - WATER / DENSITY
END, SPEED, YOUNG, COHESION = 0.25, 0.2, 10e6, 100.0


def scaled(r):
    return (f"-sand_young {YOUNG * r:.15g} -sand_cohesion {COHESION * r:.15g} -plate_velocity 0,{-SPEED * r**0.5:.15g}"
            f" -time_end {END * r**-0.5:.15g} -history_interval {END / 50 * r**-0.5:.15g} -ground_file {{start}}")


RUNS = {"dry": scaled(1), "shallow": scaled(RATIO) + " -water_level 2.3", "deep": scaled(RATIO) + " -water_level 22"}


def prepare(run, path, options):
    place = particles.lattice((0, 0), (4, TOP), SPACING)
    stress = np.zeros((len(place), 6))
    stress[:, 1] = -(DENSITY - WATER * (run != "dry")) * G * (TOP - place[:, 1])
    stress[:, 0] = stress[:, 2] = 0.5 * stress[:, 1]
    particles.write(path, "ground", place, SPACING, stress=stress)


def force(run):
    """Mean force on the plate over the last quarter of the run, N/m."""
    history = run.history["plate_force_y"]
    return history[-len(history) // 4:].mean()


def check(runs):
    for name in ("shallow", "deep"):
        yield Row(f"force on the plate over gamma'/gamma times the dry one, {name} water", force(runs[name]) / force(runs["dry"]) / RATIO,
                  1, 1e-3, "similarity", single=0.02)
