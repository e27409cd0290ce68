"""Fields along a line through the soil, from frames: profiles.png and profiles.csv. Needs matplotlib and scipy."""

import matplotlib.pyplot as plt
import numpy as np

from soil_mpm.fields import known_fields
from soil_mpm.plot.curves import COLOURS, save
from soil_mpm.plot.fields import NothingToDraw
from soil_mpm.results import read_frame
from soil_mpm.sample import sample

POINTS = 201
FIELDS = ["grid_velocity", "pressure"]


def parse_line(text):
    """Two points of "x,y:x,y", or of three coordinates each."""
    ends = [[float(word) for word in point.split(",")] for point in text.split(":")]
    if len(ends) != 2 or len(ends[0]) != len(ends[1]) or len(ends[0]) not in (2, 3) or ends[0] == ends[1]:
        raise ValueError(text)
    return np.array(ends)


def along_line(run, path, line, names):
    """Time [s] of a frame, and {field: (title, values along the line)} of all bodies together."""
    time, groups = read_frame(path)
    bodies = [groups[name] for name in run.words("bodies") if name in groups and "volume" in groups[name]]
    known = known_fields(bodies[0]) if bodies else {}
    for name in names:
        if name not in known:
            raise NothingToDraw(f"--profile: the frames have no field {name}; they have {', '.join(known)}")
    dim = int(run.number("dim", 2))
    if line.shape[1] != dim:
        raise NothingToDraw(f"--profile: takes points of {dim} coordinates")
    points = line[0] + np.linspace(0, 1, POINTS)[:, None] * (line[1] - line[0])
    values = np.concatenate([np.column_stack([known_fields(body)[name].of(body) for name in names]) for body in bodies])
    positions, volumes = (np.concatenate([body[key] for body in bodies]) for key in ("position", "volume"))
    found = sample(positions, volumes, values, points, run.number("mesh_spacing"))
    return time, {name: (known[name].title, found[:, k]) for k, name in enumerate(names)}


def draw_line(run, line, fields=(), time=None):
    """profiles.png and profiles.csv: fields along a line, at the frame nearest to a time [s], or at five from the first to the
    last. Returns the paths."""
    if not run.frames:
        raise NothingToDraw("--profile: takes a run with frames")
    names = list(fields) or FIELDS
    frames = [run.frame_near(time)] if time is not None else [run.frames[k] for k in sorted(
        set(np.linspace(0, len(run.frames) - 1, 5).astype(int)))]
    s = np.linspace(0, np.linalg.norm(line[1] - line[0]), POINTS)
    figure, all_axes = plt.subplots(len(names), 1, figsize=(8.2, 3.4 * len(names)), sharex=True, squeeze=False, layout="constrained")
    table, header = [s], ["s"]
    for frame, colour in zip(frames, COLOURS):
        at, profiles = along_line(run, frame, line, names)
        for axes, name in zip(all_axes[:, 0], names):
            title, values = profiles[name]
            axes.plot(s, values, color=colour, lw=1.4, label=f"{at:.4g} s")
            axes.set(ylabel=title)
            table.append(values), header.append(f"{name}_{at:.6g}s")
    all_axes[0, 0].legend(fontsize=8)
    all_axes[-1, 0].set(xlabel="way along the line (m)")
    for axes in all_axes[:, 0]:
        axes.grid(alpha=0.25)
    path = run.folder / "profiles.csv"
    path.write_text("\n".join([",".join(header)] + [",".join(f"{x:.9g}" for x in row) for row in zip(*table)]) + "\n")
    return [save(figure, run.folder / "profiles.png"), path]
