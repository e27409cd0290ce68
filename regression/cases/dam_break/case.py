"""Dam break

Water of the depth $h$ = 1 m stands behind a dam that disappears. By the shallow-water equations (Ritter 1892) the depth
where the dam was is $4h/9$ from then on, and the front moves at $2\\sqrt{g h}$ over a smooth dry bed. These equations
neglect the vertical acceleration, which matters in the first $2 \\sqrt{h/g}$; the depth is the mean from then to $3
\\sqrt{h/g}$, when the wave from the back wall is still on its way. The front must not be faster than Ritter's, and its speed
must approach it.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.row import Row
from soil_mpm.results import read_frame

DENSITY, G, DEPTH, LENGTH = 1000.0, 9.81, 1.0, 3.6
SPACING = 0.05
WIDTH = 3 * SPACING  # m, of the columns in the picture
END = 3.01  # over sqrt(h / g), of the mean of the depth
FRONT = 2 * np.sqrt(G * DEPTH)  # m/s
RUNS = {"water": "-basin_file {start}"}


def prepare(run, path, options):
    place = particles.lattice((-LENGTH, 0), (0, DEPTH), SPACING / 2)
    stress = np.zeros((len(place), 6))
    stress[:, :3] = (-DENSITY * G * (DEPTH - place[:, 1]))[:, None]
    particles.write(path, "basin", place, SPACING / 2, stress=stress)


def depths(run):
    """Time over sqrt(h / g) and depth at the dam, m, of each frame: volume within two cells on either side over the width."""
    times, depth = [], []
    for path in run.frames:
        time, groups = read_frame(path)
        near = np.abs(groups["basin"]["position"][:, 0]) < 2 * SPACING
        times.append(time * np.sqrt(G / DEPTH))
        depth.append(groups["basin"]["volume"][near].sum() / (4 * SPACING))
    return np.array(times), np.array(depth)


def front_speed(run):
    """Speed of the front, m/s, as the slope of the 99.9th percentile of x over the second half of the run."""
    t, x = run.history["time"], run.history["basin_xq999"]
    late = t > t[-1] / 2
    return np.polyfit(t[late], x[late], 1)[0]


def check(runs):
    t, depth = depths(runs["water"])
    for begin, short in ((2.0, ""), (0.5, "Vertical acceleration, which the shallow-water equations neglect: the water has not fallen yet.")):
        yield Row(f"depth at the dam, mean from {begin:g} to 3 sqrt(h/g) (m)", depth[(t > begin) & (t < END)].mean(), 4 / 9 * DEPTH, 0.1,
                  "Ritter 1892", relative=True, shortfall=short, bound=0.35)
    yield Row("speed of the front over Ritter's", front_speed(runs["water"]) / FRONT, 0.875, 0.125, "at most 1, and 3/4 at least")


def draw(axes, runs):
    for path in runs["water"].frames[4::4]:
        time, groups = read_frame(path)
        x = groups["basin"]["position"][:, 0]
        columns = np.floor(x / WIDTH).astype(int)
        first = columns.min()
        height = np.bincount(columns - first, groups["basin"]["volume"]) / WIDTH
        line, = axes.plot((np.arange(len(height)) + first + 0.5) * WIDTH, height, ".", ms=3, label=f"{time:.2g} s")
        wave = np.linspace(-np.sqrt(G * DEPTH) * time, FRONT * time, 50)
        axes.plot(np.r_[-LENGTH, wave], np.r_[DEPTH, (FRONT - wave / time) ** 2 / (9 * G)], color=line.get_color(), lw=0.8)
    axes.set(xlabel="distance from the dam (m; lines: Ritter)", ylabel="depth (m)", xlim=(-LENGTH, 6))
    axes.legend()
