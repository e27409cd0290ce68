"""Spreading of a Bingham fluid and of a viscous one

*Bingham.* Fluid of the yield stress $\\tau_y$ = 50 Pa and the volume $V$ = 0.5 m2 (of one half) spreads slowly over a level
rough floor until the pressure gradient nowhere exceeds the yield stress: $h^2 = 2\\tau_y (x_f - x) / \\rho g$ and $x_f = (9
V^2 \\rho g / 8 \\tau_y)^{1/3}$ = 4.358 m (Liu & Mei 1989). *Viscous.* A Newtonian fluid with $\\nu$ = 0.01 m2/s and $V$ =
0.01 m2 spreads as $x_f = 1.4112\\, (g V^3 / 3\\nu)^{1/5} t^{1/5}$ (Huppert 1982), whatever its shape at the start, here a
box of 0.2 m x 0.05 m. Both solutions hold for layers that are thin against their length.
"""

import numpy as np

import particles
from curves import last_frame
from row import Row

G = 9.81
SYRUP = "-heap_material syrup -mesh_upper 0.6,0.075 -mesh_spacing {:g} -time_end 10 -output_interval 1 -heap_file {{start}}"
RUNS = {"mud": "-heap_file {start}", "syrup": SYRUP.format(0.0025)}
BOX = {"mud": (2.5, 0.2, 1500.0), "syrup": (0.2, 0.05, 1000.0)}  # length, height, m, density
STRENGTH, VISCOSITY = 50.0, 0.01
LONG = True
THIN = ("The front comes to rest where the layer is one or two cells thick, instead of thinning out: cells of 40 mm fall 17 % short, of "
        "20 mm 13 %.")


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


def syrup_end(t):
    return 1.4112 * (G * volume("syrup") ** 3 / (3 * VISCOSITY) * t) ** 0.2


def heights(run, width):
    """Middles, m, and heights, m, of columns of this width, m: volume over width."""
    frame = last_frame(run, "heap")
    column = np.floor(frame["position"][:, 0] / width).astype(int)
    height = np.bincount(column, frame["volume"]) / width
    return (np.arange(len(height)) + 0.5) * width, height


def check(runs):
    x, height = heights(runs["mud"], 0.2)
    yield Row("length of the mud at rest (m)", runs["mud"].history["heap_xmax"][-1], mud_end(), 0.1, "Liu & Mei 1989", relative=True,
              shortfall=THIN, bound=0.15)
    exact = np.sqrt(2 * STRENGTH * mud_end() / (BOX["mud"][2] * G))
    yield Row("height of the mud in the middle (m)", height[0], exact, 0.1, "Liu & Mei 1989", relative=True)
    t, end = runs["syrup"].history["time"], runs["syrup"].history["heap_xmax"]
    for when in (5, 10):
        yield Row(f"length of the syrup at {when} s (m)", np.interp(when, t, end), syrup_end(when), 0.1, "Huppert 1982", relative=True)
    late = t > 2
    yield Row("exponent of its growth from 2 s on", np.polyfit(np.log(t[late]), np.log(end[late]), 1)[0], 0.2, 0.02, "Huppert 1982",
              shortfall="The box at the start is longer than the solution then, and its length comes to the solution from above.", bound=0.05)


def draw(axes, runs):
    x, height = heights(runs["mud"], 0.1)
    axes.plot(x, height, ".", label="Bingham, at the end")
    exact = np.linspace(0, mud_end(), 200)
    axes.plot(exact, np.sqrt(2 * STRENGTH * (mud_end() - exact) / (BOX["mud"][2] * G)), "k--", lw=0.8, label="exact, thin layer")
    axes.set(xlabel="x (m)", ylabel="height (m)", ylim=(0, None))
    axes.legend(loc="lower left")
    inset = axes.inset_axes((0.62, 0.6, 0.36, 0.37))
    t, end = runs["syrup"].history["time"][1:], runs["syrup"].history["heap_xmax"][1:]
    inset.loglog(t, end, label="viscous")
    inset.loglog(t, syrup_end(t), "k--", lw=0.8)
    inset.set(xlabel="time (s)", ylabel="length (m)")
    inset.minorticks_off()
    inset.set(yticks=[0.2, 0.3, 0.4], yticklabels=["0.2", "0.3", "0.4"])
    inset.text(0.04, 0.86, "viscous (dashed: Huppert)", transform=inset.transAxes, fontsize=8)
