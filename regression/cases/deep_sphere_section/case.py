"""Deep sphere, in section

The sphere of the case `deep_sphere` as a body of revolution (`-geometry axisymmetric`), with `-velocity_update apic`. Rough and smooth
must lie in the same ranges. FLIP (`-velocity_update flip`, the default) carries 0.5 to 0.7 less with the same cells, because the noise of its
velocities strains soil that flows round a body; it is run for comparison, and only has to stay below APIC.
"""

import numpy as np

from mpm_regression.row import Row

STRENGTH = 3000.0
SOURCE = "Randolph, Martin & Hu (2000), and finite elements"
RANGES = {"rough": (14.5, 16.3), "smooth": (10.5, 12.5)}
SHARES = {"rough": 1, "smooth": 0}
RUNS = {surface: f"-sphere_shear_share {share}" for surface, share in SHARES.items()}
RUNS["smooth_flip"] = f"{RUNS['smooth']} -velocity_update flip"
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def curve(run):
    """Settlement over D and the factor, in the middle of each interval of the history."""
    z = -run.history["sphere_y"]
    return (z[1:] + z[:-1]) / 2, run.history["sphere_force_y"][1:] / (np.pi / 4 * STRENGTH)


def factor(run):
    z, n = curve(run)
    return n[(z > 0.06) & (z < 0.12)].mean()


def check(runs):
    for surface, (low, high) in RANGES.items():
        yield Row(f"N, {surface}, D/16, APIC", factor(runs[surface]), (low + high) / 2, (high - low) / 2, SOURCE)
    yield Row("N, smooth, D/16, FLIP less that of APIC", factor(runs["smooth_flip"]) - factor(runs["smooth"]), -0.5, 0.5, "a control: FLIP carries less")


def draw(axes, runs):
    for name, run in runs.items():
        axes.plot(*curve(run), lw=1, label=name.replace("_", " "))
    for low, high in RANGES.values():
        axes.axhspan(low, high, color="0.9", zorder=0)
    axes.set(xlabel="settlement over D", ylabel="$N$ (grey: accepted)", xlim=(0, 0.12), ylim=(0, 20))
    axes.legend(ncols=2, fontsize=8)
