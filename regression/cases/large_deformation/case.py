"""Stretched by 4, sheared by 400 %

An elastic block is stretched by a factor of 4, or sheared by 400 %. All particles keep their velocity, $v = A X$, so the deformation is
$F = I + t A$, the same in the whole block, and so is the stress, by the Jaumann rate. The block is so dense that its stress changes the
motion by only $10^{-8}$. Particles whose [domains](method.md#domains-that-stretch) become too long are split. With domains of a fixed
size, a block that is stretched by 4 comes apart into particles two cells apart, which do not see each other. The check compares
particles more than three cells inside the block, because neither APIC nor FLIP keeps the velocity at a free surface that stretches.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.results import read_frame

CENTRE = np.array([-1.3, -0.1])
SIZES = {"stretched": (12.0, 12.0), "sheared": (32.0, 8.0)}
DEEP = 3  # cells from the surface, which FLIP strains
MODULUS, POISSON = 2.6, 0.3
MOTIONS = {"stretched": [[3, 0], [0, 0]], "sheared": [[0, 4], [0, 0]]}
WHAT = {"stretched": "stretched by 4", "sheared": "sheared by 400 %"}
RUNS = {name: "-block_file {start}" for name in MOTIONS}
RUNS |= {"flip": "-block_file {start} -velocity_update flip", "fixed": "-block_file {start} -particle_domain fixed"}


def motion(run):
    return np.array(MOTIONS.get(run, MOTIONS["stretched"]), dtype=float)


def size(run):
    return np.array(SIZES.get(run, SIZES["stretched"]))


def prepare(run, path, options):
    position = particles.lattice(CENTRE - size(run) / 2, CENTRE + size(run) / 2, 0.5)
    particles.write(path, "block", position, 0.5, velocity=(position - CENTRE) @ motion(run).T)


def exact_stress(A, end, steps=4000):
    """Stress xx, yy, xy at the time `end`: the Jaumann rate, by the midpoint rule."""
    G = MODULUS / (2 * (1 + POISSON))
    LAME = MODULUS * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))

    def rate(stress, time):
        L = A @ np.linalg.inv(np.eye(2) + time * A)
        D, W = (L + L.T) / 2, (L - L.T) / 2
        return W @ stress - stress @ W + 2 * G * D + LAME * np.trace(D) * np.eye(2)

    stress, dt = np.zeros((2, 2)), end / steps
    for k in range(steps):
        middle = stress + dt / 2 * rate(stress, k * dt)
        stress = stress + dt * rate(middle, (k + 0.5) * dt)
    return np.array([stress[0, 0], stress[1, 1], stress[0, 1]])


def is_inside(place, name, time):
    """Whether places [N, 2] are deep inside the block, wherever that is at this time."""
    back = np.linalg.inv(np.eye(2) + time * motion(name))
    half = size(name) / 2 - DEEP * np.linalg.norm(back, axis=1)  # m of the start
    return np.all(np.abs((place - CENTRE) @ back.T) < half, axis=1)


def inside(fields, name, time):
    """Stress xx, yy, xy of the particles inside the block."""
    return fields["stress"][is_inside(fields["position"][:, :2], name, time)][:, [0, 1, 3]]


def error(run, name):
    """Root of the mean square error of the stress, over the largest component of the exact stress."""
    exact = exact_stress(motion(name), 1.0)
    stress = inside(last_frame(run, "block"), name, 1.0)
    return np.sqrt(np.mean((stress - exact) ** 2)) / np.abs(exact).max() if len(stress) else np.nan


def empty_share(run, name):
    """Share of the cells inside the block that hold no particle."""
    lower = np.array([float(x) for x in run.options["mesh_lower"].split(",")])
    cells = np.floor(last_frame(run, "block")["position"][:, :2] - lower).astype(int)
    held = {tuple(cell) for cell in cells}
    count = np.floor(np.array([float(x) for x in run.options["mesh_upper"].split(",")]) - lower).astype(int)
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), axis=-1).reshape(-1, 2)
    grid = grid[is_inside(grid + 0.5 + lower, name, 1.0)]
    return sum(tuple(cell) not in held for cell in grid) / len(grid)


def check(runs):
    for name in MOTIONS:
        yield Row(f"rms error of the stress over the largest, {WHAT[name]}", error(runs[name], name), 0, 0.01, "Jaumann rate")
        yield Row(f"share of cells inside that are empty, {WHAT[name]}", empty_share(runs[name], name), 0, 0, "no gap")
    yield Row("rms error of the stress over the largest, stretched by 4, FLIP", error(runs["flip"], "flip"), 0, 0.01,
              "Jaumann rate", shortfall="The strain that FLIP makes at the free surface comes inwards.", bound=0.03)
    yield Row("share of cells inside that are empty, stretched by 4, domains of a fixed size", empty_share(runs["fixed"], "fixed"),
              0, 0, "no gap", shortfall="Particles come to lie two cells apart.", bound=0.6)


def draw(axes, runs):
    frames = [read_frame(path) for path in sorted(runs["stretched"].folder.glob("frames/frame_*.h5"))]
    fixed = [read_frame(path) for path in sorted(runs["fixed"].folder.glob("frames/frame_*.h5"))]
    for label, of, mark in (("split", frames, "o"), ("fixed", fixed, "s")):
        stress = [inside(groups["block"], "stretched", time)[:, 0].mean() for time, groups in of]
        axes.plot([1 + 3 * time for time, _ in of], np.array(stress) / MODULUS, mark, ms=4, label=label)
    stretch = np.linspace(1, 4, 31)
    exact = [exact_stress(motion("stretched"), (x - 1) / 3, 400)[0] / MODULUS for x in stretch]
    axes.plot(stretch, exact, "k--", lw=0.8, label="exact")
    axes.set(xlabel="stretch", ylabel="stress over Young's modulus")
    axes.legend()
