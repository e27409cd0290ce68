"""Probes and rasters of a block of known motion

A block, 1 m long and $H$ = 0.5 m high, moves with $v$ = 2 m/s, and nothing acts on it. Through a section the mass flux is
$\\rho H v$ while the block passes, and the mass that has passed at the end is that of the block. A gauge has $H$ and $v$ while the block
is there. A point in it has its velocity. The particle that is followed moves by $v t$. The rasters have $H$ as the greatest depth where the
block has been and none elsewhere, and as the time of arrival the time at which the front has filled a fifth of a cell, to the 0.01 s between two
looks. In 3D the block is 0.6 m wide. Fluxes are means over a strip of one cell.
"""

import csv

import numpy as np

from mpm_regression.curves import trapezoid
from mpm_regression.row import Row

SPEED, HEIGHT, LENGTH, DENSITY = 2.0, 0.5, 1.0, 2000.0
IN_3D = (" -dim 3 -mesh_lower -1,1,2 -mesh_upper 5,2.2,3 -block_lower 0,1.3,2 -block_upper 1,1.9,2.5 -block_velocity 2,0,0 -mesh_ymin free"
         " -mesh_ymax free -mesh_zmin roller -mesh_zmax free -crest_at 2.513,1.62 -middle_at 2.5,1.57,2.21 -front_at 0.93,1.41,2.42"
         " -raster_origin 700000,4000000,0 -raster_spacing 0.2")
RUNS = {"2D": "", "3D": IN_3D, "stretch": "-particle_domain stretch", "apic": "-velocity_update apic -crest_width 0.17"}


def rasters_of(run):
    """{name: values along x, in the middle of the block} and x in the coordinates of the mesh."""
    if (run.folder / "rasters.csv").exists():
        with open(run.folder / "rasters.csv", newline="") as file:
            header, *rows = csv.reader(file)
        table = dict(zip(header, np.array(rows, dtype=float).T))
        return table.pop("x") - 700000, table
    values, x = {}, None
    for name in ("max_depth", "max_speed", "arrival_time", "final_depth"):
        lines = (run.folder / f"raster_{name}.asc").read_text().splitlines()
        head = dict(line.split() for line in lines[:6])
        assert float(head["yllcorner"]) == 4000001, "the origin along y is not that of the site"
        grid = np.array([line.split() for line in lines[6:]], dtype=float)[::-1]
        grid[grid == -9999] = np.nan
        values[name] = grid[3]  # y from 1.6 to 1.8
        x = float(head["xllcorner"]) - 700000 + (np.arange(grid.shape[1]) + 0.5) * float(head["cellsize"])
        assert np.nan_to_num(grid[[0, -1]]).max() == 0, "soil beside the block"
    return x, values


def check(runs):
    for name, run in runs.items():
        history, t = run.history, run.history["time"]
        width = 0.6 if name == "3D" else 1.0
        mass, flux = DENSITY * HEIGHT * LENGTH * width, DENSITY * HEIGHT * width * SPEED
        inside = (t > 1.03 / SPEED + 0.03) & (t < 2.03 / SPEED - 0.03)
        source = "motion of the block"
        yield Row(f"{name}: mass through the section (kg)", history["wall_mass"][-1], mass, 1e-9, source, relative=True, single=1e-4)
        yield Row(f"{name}: volume through it (m3)", history["wall_volume"][-1], mass / DENSITY, 1e-9, source, relative=True, single=1e-4)
        for key, exact in (("mass_flux", flux), ("volume_flux", flux / DENSITY), ("momentum_flux_x", flux * SPEED)):
            off = np.abs(history[f"wall_{key}"][inside] / exact - 1).max()
            yield Row(f"{name}: largest error of its {key.replace('_', ' ')} as the block passes", off, 0, 1e-9, source, single=1e-3)
        summed = trapezoid(history["wall_mass_flux"], t)
        yield Row(f"{name}: sum of the flux (kg)", summed, mass, 0.02, "to a row of the history", relative=True)
        over = (t > 0.81) & (t < 1.2)
        for key, exact in (("depth", HEIGHT), ("speed", SPEED), ("mean_velocity_x", SPEED)):
            off = np.abs(history[f"crest_{key}"][over] / exact - 1).max()
            yield Row(f"{name}: largest error of the gauge's {key.replace('_', ' ')}", off, 0, 1e-9, source, single=1e-4)
        yield Row(f"{name}: surface at the gauge (m)", history["crest_surface"][over].max(), 2.5, 1e-9, source, single=1e-5)
        after = (t < 0.73 - 0.06) | (t > 1.27 + 0.06)
        yield Row(f"{name}: depth at the gauge before and after (m)", history["crest_depth"][after].max(), 0, 1e-12, source)
        yield Row(f"{name}: velocity at the point (m/s)", np.nanmax(np.abs(history["middle_velocity_x"] - SPEED)), 0, 1e-9, source, single=1e-4)
        yield Row(f"{name}: movement of the particle (m)", history["front_displacement_x"][-1], SPEED * t[-1], 1e-9, source, single=1e-4)
        x, raster = rasters_of(run)
        cell = x[1] - x[0]
        way = (x > cell) & (x < 3.5)
        share = 0.1 / HEIGHT  # of a cell, by the threshold
        exact = (x + (share - 0.5) * cell - LENGTH) / SPEED
        late = (raster["arrival_time"] - exact)[way & (x > LENGTH + cell)]
        yield Row(f"{name}: greatest depth along the way, largest error (m)", np.abs(raster["max_depth"][way] - HEIGHT).max(), 0, 1e-9, source, single=1e-4)
        yield Row(f"{name}: greatest speed along the way, largest error (m/s)", np.abs(raster["max_speed"][way] - SPEED).max(), 0, 1e-9, source, single=1e-3)
        yield Row(f"{name}: latest arrival after the exact time (s)", late.max(), 0.005, 0.0051, "within 0.01 s after it")
        yield Row(f"{name}: earliest arrival after the exact time (s)", late.min(), 0.005, 0.0051, "within 0.01 s after it")
        yield Row(f"{name}: mass of the deposit (kg)", raster["final_depth"].sum() * cell * width * DENSITY, mass, 1e-9, source, relative=True, single=1e-4)


def draw(axes, runs):
    history = runs["2D"].history
    axes.plot(history["time"], history["wall_mass"], label="mass through the section (kg)")
    axes.plot(history["time"], 1000 * history["crest_depth"], label="1000 x depth at the gauge (m)")
    axes.set(xlabel="time (s)")
    axes.legend()
