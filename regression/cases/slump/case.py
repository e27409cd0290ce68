"""Spreading of a Bingham fluid and of a viscous one

*Bingham.* Fluid of the yield stress $\\tau_y$ = 50 Pa, the viscosity $\\eta$ = 25 Pa s and the volume $V$ = 0.5 m2 (of one half)
spreads over a level rough floor. In a thin layer the flux is $q = -\\rho g h_x Y^2 (3h - Y) / 6\\eta$, with the depth that is sheared
$Y = h - \\tau_y / \\rho g |h_x|$, and $h_t + q_x = 0$ (Liu & Mei 1989); the case solves it with finite volumes. The layer comes to
rest at $x_f = (9 V^2 \\rho g / 8 \\tau_y)^{1/3}$ = 4.358 m, but slowly: 99.9 % of it lie within 4.01 m at 40 s, when the run ends,
4.13 m at 80 s and 4.29 m at 640 s. *Viscous.* A Newtonian fluid with $\\nu$ = 0.01 m2/s and $V$ = 0.01 m2 spreads as
$x_f = 1.4112\\, (g V^3 / 3\\nu)^{1/5} t^{1/5}$ (Huppert 1982), whatever its shape at the start, here a box of 0.2 m x 0.05 m. Both
solutions hold for layers that are thin against their length, which the mud is not in the first seconds.

Fluid that flows has an even surface: the depth of a column of cells may differ from the mean of both neighbours by 2 % of the mean depth
(standard deviation; columns of two cells or more). From second to second that varies by a tenth, so the mean of ten frames counts.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.flow import depths, unevenness
from soil_mpm.results import read_frame

G = 9.81
SYRUP = "-heap_material syrup -mesh_upper 0.6,0.075 -mesh_spacing {:g} -time_end 10 -output_interval 1 -heap_file {{start}}"
EVEN = "-heap_file {start} -particle_domain split -velocity_update apic -position_correction delta"
RUNS = {"mud": "-heap_file {start}", "mud_even": EVEN, "syrup": SYRUP.format(0.0025)}
BOX = {"mud": (2.5, 0.2, 1500.0), "mud_even": (2.5, 0.2, 1500.0), "syrup": (0.2, 0.05, 1000.0)}  # length, height, m, density
WHAT = {"mud": "fixed domains, FLIP", "mud_even": "split, APIC, corrected"}
STRENGTH, CONSISTENCY, VISCOSITY = 50.0, 25.0, 0.01
LENGTH, SPACING = 6.0, 0.02  # m, of the mesh of the mud
LONG = True
FIXED = "Particles of a fixed size gather at the front, where the layer is one or two cells thick."


def prepare(run, path, options):
    length, height, density = BOX[run]
    spacing = float(options[options.index("-mesh_spacing") + 1]) if "-mesh_spacing" in options else 0.02
    place = particles.lattice((0, 0), (length, height), spacing / 2)
    stress = np.zeros((len(place), 6))
    stress[:, :3] = (-density * G * (height - place[:, 1]))[:, None]
    particles.write(path, "heap", place, spacing / 2, stress=stress)


def volume(run):
    return BOX[run][0] * BOX[run][1]


def mud_end():
    """Length of the mud at rest, m."""
    return (9 * volume("mud") ** 2 * BOX["mud"][2] * G / (8 * STRENGTH)) ** (1 / 3)


def thin_layer(times, width=0.04):
    """Middles [m] of cells and the exact depth [m] of the mud in them at each of the times [s], of a thin layer."""
    length, height, density = BOX["mud"]
    edges = width * np.arange(round(LENGTH / width) + 1)
    h = height * np.clip((length - edges[:-1]) / width, 0, 1)
    weight, found = density * G, []
    flux = np.zeros(len(edges))  # none through the middle
    t, step = 0.0, 0.4 * width**2 * 3 * CONSISTENCY / (weight * height**3)
    for end in times:
        steps = int(np.ceil((end - t) / step))
        for _ in range(steps):
            drive = weight * (h[:-1] - h[1:]) / width  # Pa/m
            mean = (h[:-1] + h[1:]) / 2
            sheared = np.maximum(0, mean - STRENGTH / np.maximum(np.abs(drive), 1e-9))
            flux[1:-1] = drive * sheared**2 * (3 * mean - sheared) / (6 * CONSISTENCY)
            h = h - (end - t) / steps * np.diff(flux) / width
        t = end
        found.append(h)
    return (edges[:-1] + edges[1:]) / 2, found


def percentile(x, h):
    """Length [m] that holds 99.9 % of the layer."""
    return np.interp(0.999, np.cumsum(h) / h.sum(), x + (x[1] - x[0]) / 2)


def syrup_end(t):
    return 1.4112 * (G * volume("syrup") ** 3 / (3 * VISCOSITY) * t) ** 0.2


def heights(run, width):
    """Middles, m, and heights, m, of columns of this width, m: volume over width."""
    frame = last_frame(run, "heap")
    column = np.floor(frame["position"][:, 0] / width).astype(int)
    height = np.bincount(column, frame["volume"]) / width
    return (np.arange(len(height)) + 0.5) * width, height


def even(run, time):
    """Mean over the frames of ten seconds up to `time` of even_at()."""
    return np.mean([even_at(run, time - back) for back in range(10)])


def even_at(run, time):
    """Standard deviation of the depth of a column from the mean of its neighbours, over the mean depth."""
    frame = read_frame(run.frame_near(time))[1]["heap"]
    half = frame.get("half_length_x", np.full(len(frame["position"]), SPACING / 4))
    return unevenness(depths(frame["position"], frame["volume"], half, (0, 0), SPACING, round(LENGTH / SPACING)))


def check_mud(run, what, exact, fixed):
    x, layers = exact
    for when, layer in zip((20, 40), layers):
        front = np.interp(when, run.history["time"], run.history["heap_xq999"])
        yield Row(f"length of 99.9 % of the mud at {when} s, {what} (m)", front, percentile(x, layer), 0.02, "Liu & Mei 1989",
                  relative=True, shortfall=FIXED if fixed else "", bound=0.08)
    height = heights(run, 0.2)[1][0]
    yield Row(f"height of the mud in the middle at 40 s, {what} (m)", height, layers[-1][x < 0.2].mean(), 0.03, "Liu & Mei 1989",
              relative=True, shortfall=FIXED if fixed else "", bound=0.05)
    for when in (20, 40):
        yield Row(f"standard deviation of the depth up to {when} s, {what}", even(run, when), 0, 0.02, "an even flow",
                  shortfall=FIXED if fixed else "", bound=0.08)


def check(runs):
    exact = thin_layer((20.0, 40.0))
    for name, what in WHAT.items():
        yield from check_mud(runs[name], what, exact, name == "mud")
    t, end = runs["syrup"].history["time"], runs["syrup"].history["heap_xmax"]
    for when in (5, 10):
        yield Row(f"length of the syrup at {when} s (m)", np.interp(when, t, end), syrup_end(when), 0.1, "Huppert 1982", relative=True)
    late = t > 2
    yield Row("exponent of its growth from 2 s on", np.polyfit(np.log(t[late]), np.log(end[late]), 1)[0], 0.2, 0.02, "Huppert 1982",
              shortfall="The box at the start is longer than the solution then, and its length comes to the solution from above.", bound=0.05)


def draw(axes, runs):
    for name, what in WHAT.items():
        x, height = heights(runs[name], 0.1)
        axes.plot(x, height, ".", label=f"Bingham, 40 s, {what}")
    x, (layer,) = thin_layer((40.0,))
    axes.plot(x[layer > 1e-3], layer[layer > 1e-3], "k-", lw=0.8, label="thin layer, 40 s")
    rest = np.linspace(0, mud_end(), 200)
    still = np.sqrt(2 * STRENGTH * (mud_end() - rest) / (BOX["mud"][2] * G))
    axes.plot(rest, still, "k--", lw=0.8, label="thin layer, at rest")
    axes.set(xlabel="x (m)", ylabel="height (m)", ylim=(0, None))
    axes.legend(loc="lower left", fontsize=7)
    inset = axes.inset_axes((0.62, 0.6, 0.36, 0.37))
    t, end = runs["syrup"].history["time"][1:], runs["syrup"].history["heap_xmax"][1:]
    inset.loglog(t, end, label="viscous")
    inset.loglog(t, syrup_end(t), "k--", lw=0.8)
    inset.set(xlabel="time (s)", ylabel="length (m)")
    inset.minorticks_off()
    inset.set(yticks=[0.2, 0.3, 0.4], yticklabels=["0.2", "0.3", "0.4"])
    inset.text(0.04, 0.86, "viscous (dashed: Huppert)", transform=inset.transAxes, fontsize=8)
