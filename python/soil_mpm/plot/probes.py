"""Pictures of probes against time, and of the rasters of what passed. Needs matplotlib."""

import csv

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LightSource

from soil_mpm.ground.raster import Raster, read_ascii
from soil_mpm.plot.curves import COLOURS, STYLES, mark_stages, mark_time, run_label, save
from soil_mpm.units import axis_unit


# Panels of a probe: quantity, columns behind NAME_, and SI unit. {axis} stands for each axis of the run.
PANELS = {
    "point": [("velocity", ["velocity_{axis}"], "m/s"), ("pressure", ["pressure", "pore_pressure"], "Pa")],
    "particle": [("displacement", ["displacement_{axis}"], "m"), ("velocity", ["velocity_{axis}"], "m/s")],
    "gauge": [("depth", ["depth"], "m"), ("speed", ["speed", "mean_velocity_{axis}"], "m/s")],
    "section": [("mass flux", ["mass_flux"], "kg/s"), ("mass that has passed", ["mass"], "kg")],
}
RASTERS = {"max_depth": ("greatest depth (m)", "magma_r"), "max_speed": ("greatest speed (m/s)", "viridis"),
           "arrival_time": ("time of arrival (s)", "viridis_r"), "final_depth": ("depth at the end (m)", "magma_r")}


def columns_of(run, probe, names):
    """Columns of these names that the history has, with the axes of the run."""
    all_names = [name.format(axis=axis) for name in names for axis in ("xyz" if "{axis}" in name else "x")]
    return [name for name in all_names if f"{probe}_{name}" in run.history]


def draw_probe(axes, run, others, probe, panel, time):
    title, names, unit = panel
    shown = [each.history[f"{probe}_{name}"] for each in [run] + others for name in columns_of(each, probe, names)]
    text, size = axis_unit(run, np.concatenate(shown or [np.zeros(1)]), unit)
    for each, style in zip([run] + others, STYLES):
        for name, colour in zip(columns_of(each, probe, names), COLOURS):
            axes.plot(each.history["time"], each.history[f"{probe}_{name}"] / size, style, color=colour, lw=1.3,
                      label=name.replace("_", " ") + (f", {run_label(each, others)}" if others else ""))
    mark_time(axes, run, time, run.history["time"])
    mark_stages(axes, run)
    axes.set(xlabel="time (s)", ylabel=f"{title} ({text})", title=probe)
    axes.grid(alpha=0.25)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8)


def draw_probes(run, others, time=None):
    """probes.png: two panels a probe, against time. Returns its path, or None without probes."""
    probes = [name for name in run.words("probes") if run.text(f"{name}_kind") in PANELS]
    if not probes or "time" not in run.history:
        return None
    figure, all_axes = plt.subplots(len(probes), 2, figsize=(11, 2.9 * len(probes)), squeeze=False, layout="constrained")
    for row, probe in zip(all_axes, probes):
        for axes, panel in zip(row, PANELS[run.text(f"{probe}_kind")]):
            draw_probe(axes, run, others, probe, panel, time)
    return save(figure, run.folder / "probes.png")


# ---------------------------------------------------------------------------------------------- rasters


def read_profile(path):
    """Columns of rasters.csv."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).T))


def draw_along(run):
    """The rasters of a run in 2D, along x."""
    table = read_profile(run.folder / "rasters.csv")
    figure, (depth, speed, arrival) = plt.subplots(3, 1, figsize=(8.2, 8), sharex=True, layout="constrained")
    depth.fill_between(table["x"], table["final_depth"], step="mid", color=COLOURS[4], alpha=0.6, label="at the end")
    depth.step(table["x"], table["max_depth"], where="mid", color=COLOURS[1], label="greatest")
    depth.legend(fontsize=9)
    speed.step(table["x"], table["max_speed"], where="mid", color=COLOURS[0])
    arrival.plot(table["x"], table["arrival_time"], ".", color=COLOURS[2])
    for axes, label in ((depth, "depth (m)"), (speed, "greatest speed (m/s)"), (arrival, "arrival (s)")):
        axes.set(ylabel=label)
        axes.grid(alpha=0.25)
    arrival.set(xlabel="x (m)")
    return save(figure, run.folder / "rasters.png")


def at_site(terrain, origin):
    """A terrain in the coordinates of the mesh as one in those of the site, whose origin is x, y, z [m]: heights too."""
    return Raster(terrain.values + origin[2], terrain.x + origin[0], terrain.y + origin[1], terrain.cell)


def cut_to(terrain, window):
    """The cells of a terrain in a window x0, x1, y0, y1 [m], and those beside them; all where none lies in it."""
    x0, x1, y0, y1 = window
    x, y = terrain.centres()
    columns = np.flatnonzero((x > x0 - terrain.cell) & (x < x1 + terrain.cell))
    rows = np.flatnonzero((y > y0 - terrain.cell) & (y < y1 + terrain.cell))
    if len(columns) < 2 or len(rows) < 2:
        return terrain
    values = terrain.values[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
    return Raster(values, terrain.x + columns[0] * terrain.cell, terrain.y + rows[0] * terrain.cell, terrain.cell)


def shade(axes, terrain, window):
    """Shaded relief with contour lines of the height, and their labels, in a window x0, x1, y0, y1 [m]."""
    light = LightSource(azdeg=315, altdeg=45).hillshade(terrain.values, dx=terrain.cell, dy=-terrain.cell, vert_exag=1.5)
    axes.imshow(light, cmap="gray", vmin=-0.8, vmax=1.1, origin="lower", extent=terrain.extent, interpolation="bilinear")
    seen = cut_to(terrain, window)
    lines = axes.contour(*seen.centres(), seen.values, levels=12, colors="0.25", linewidths=0.4)
    axes.set(xlim=window[:2], ylim=window[2:])  # labels are placed where they are seen
    x0, x1, y0, y1 = window
    for label in axes.clabel(lines, fontsize=6, fmt="%.0f m"):
        u, v = (label.get_position()[0] - x0) / (x1 - x0), (label.get_position()[1] - y0) / (y1 - y0)
        label.set_visible(0.04 < u < 0.96 and 0.04 < v < 0.96)  # the frame would cut off digits


def seen_part(name, rasters, least):
    """Values of a raster where soil came deeper than `least`; those of the depth at the end where it lies so deep."""
    values = rasters[name].values
    there = rasters["final_depth" if name == "final_depth" else "max_depth"].values > least
    return np.ma.masked_where(~there | np.isnan(values), values)


def draw_map(axes, run, name, rasters, terrain):
    title, colours = RASTERS[name]
    least = run.number("raster_threshold_depth", 0.1 * run.number("mesh_spacing"))
    if terrain is not None:
        shade(axes, terrain, rasters[name].extent)
    seen = seen_part(name, rasters, least)
    top = float(np.quantile(seen.compressed(), 0.99)) if seen.count() else 1
    image = axes.imshow(seen, cmap=colours, origin="lower", extent=rasters[name].extent, vmin=0, vmax=top,
                        alpha=0.85 if terrain is not None else 1)
    axes.figure.colorbar(image, ax=axes, shrink=0.8, label=title)
    x0, x1, y0, y1 = rasters[name].extent
    axes.set(xlim=(x0, x1), ylim=(y0, y1), xlabel="x (m)", ylabel="y (m)", aspect="equal")


def draw_rasters(run, terrain=None):
    """rasters.png: in 3D the four rasters, on the shaded relief where the path of a terrain is given, whose coordinates are
    those of the mesh; in 2D profiles along x. Returns its path, or None without rasters."""
    if (run.folder / "rasters.csv").exists():
        return draw_along(run)
    paths = {name: run.folder / f"raster_{name}.asc" for name in RASTERS}
    if not all(path.exists() for path in paths.values()):
        return None
    rasters = {name: read_ascii(path) for name, path in paths.items()}
    if terrain is not None:
        terrain = at_site(read_ascii(terrain), run.numbers("raster_origin", [0, 0, 0]))
    x0, x1, y0, y1 = rasters["max_depth"].extent
    figure, all_axes = plt.subplots(2, 2, figsize=(12, 11 * (y1 - y0) / (x1 - x0) + 0.6), layout="compressed")
    for axes, name in zip(all_axes.flat, RASTERS):
        draw_map(axes, run, name, rasters, terrain)
    return save(figure, run.folder / "rasters.png", bbox_inches="tight")
