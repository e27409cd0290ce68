"""Shared by the cases of a strip footing on frictional soil: set-up, exact values, and the load that is compared.

Half of the problem, B = 1 m. The footing's edge lies midway between two nodes, because a node on the edge half belongs to a
smooth footing and fully to a rough one. Soil with psi = phi dilates at a fixed ratio to its shear; four particles a cell
lock under that constraint as they do under constant volume, so a cell has one particle. Everything that has the dimension
of a stress follows from the exact load q: E = 3000 q, so that settlements stay below 0.002 B, and 12,000 q where the weight of
the heave counts. The density of weightless soil makes the waves run at 100 m/s.
"""

import numpy as np

FREE = {20: 3, 25: 4, 30: 5, 35: 6, 40: 10}  # width beside the footing over B: beyond the rough mechanism
DEPTH = {20: 2, 25: 2, 30: 2.5, 35: 3, 40: 3.5}
STIFFNESS, POISSON = 3000.0, 0.3  # E over the limit load
SETTLEMENT = 4.8  # B q/E; the soil has failed everywhere at about half of it
ROUGH, SMOOTH = " -plate_friction 10", ""
BASES = {"smooth": SMOOTH, "rough": ROUGH}
COARSE = "Eleven cells under the footing; the error halves with the cells."
COLOURS = {"smooth": "#0072b2", "rough": "#d55e00"}


def surcharge_factor(phi):
    """Nq of weightless soil (Prandtl 1921, Reissner 1924); phi in degrees."""
    t = np.tan(np.radians(phi))
    return np.exp(np.pi * t) * np.tan(np.radians(45 + phi / 2)) ** 2


def cohesion_factor(phi):
    """Nc (Prandtl 1921); phi in degrees."""
    return (surcharge_factor(phi) - 1) / np.tan(np.radians(phi))


def ground(phi, cells):
    """Edge of a cell, m, and width and depth of the ground, m, with an odd number of `cells` under the whole footing: then its
    edge lies midway between two nodes."""
    d = 1 / cells
    return d, round((0.5 + FREE[phi]) / d) * d, round(DEPTH[phi] / d) * d


def set_up(phi, cells, load, density=None, transits=60, height=0.0, stiffness=STIFFNESS):
    """Options of a run with limit load `load` [Pa]. The soil's `density` [kg/m3], else the one with which waves run at 100 m/s.
    The settlement takes `transits` of a wave through the ground's width. The footing reaches up by `height` [m], or two cells."""
    d, width, depth = ground(phi, cells)
    top = depth + (height or 2 * d)
    young = stiffness * load
    modulus = young * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    density = density or modulus / 100**2
    end = transits * width / np.sqrt(modulus / density)
    return (f"-mesh_spacing {d:.15g} -mesh_upper {width:.15g},{depth + (height or 4 * d):.15g} -sand_young {young:.9g}"
            f" -sand_density {density:.9g} -sand_friction_deg {phi} -sand_dilation_deg {phi}"
            f" -plate_lower 0,{depth:.15g} -plate_upper 0.5,{top - (0.02 * d if height else 0):.15g}"
            f" -plate_velocity 0,{-SETTLEMENT / stiffness / end:.9g} -time_end {end:.9g}"
            f" -output_interval {end:.9g} -history_interval {end / 400:.9g}")


def cohesion_options(phi, cells):
    """A run of footing_cohesion."""
    _, width, depth = ground(phi, cells)
    return set_up(phi, cells, 1000 * cohesion_factor(phi)) + f" -soil_upper {width:.15g},{depth:.15g}"


def surcharge_options(phi, cells):
    """A run of footing_surcharge. The cover is 1 m thick; the footing reaches through it to the top of the mesh."""
    d, width, depth = ground(phi, cells)
    cover = round(1 / d) * d
    return (set_up(phi, cells, 1000 * surcharge_factor(phi), height=cover) + f" -soil_upper {width:.15g},{depth:.15g}"
            f" -cover_lower 0.5,{depth:.15g} -cover_upper {width:.15g},{depth + cover:.15g}")


def weight_options(phi, cells, load):
    """A run of footing_weight."""
    return set_up(phi, cells, load, density=2000, transits=120, stiffness=4 * STIFFNESS) + " -soil_file {start}"


def tolerance(phi):
    """Largest relative error of Nc and Nq that is accepted at B/40."""
    return 0.04 if phi <= 30 else 0.08


def curve(run):
    """Settlement w/B and load q [Pa] in the middles of the intervals of the history, without a last one that is too short."""
    w = -run.history["plate_y"]
    full = np.diff(w) > 0.5 * np.median(np.diff(w))
    return ((w[1:] + w[:-1]) / 2)[full], run.history["plate_force_y"][1:][full] / 0.5


def limit(run):
    """Mean load over the second half of the settlement, Pa."""
    w, q = curve(run)
    return q[w > w[-1] / 2].mean()


def drift(run):
    """Share by which the load of the last quarter of the settlement exceeds that of the third."""
    w, q = curve(run)
    late = w > 0.75 * w[-1]
    return q[late].mean() / q[(w > w[-1] / 2) & ~late].mean() - 1


def draw_curves(axes, curves, exact, name):
    """curves: {label: (w/B, factor, colour, style)}; exact: factors."""
    for label, (w, factor, colour, style) in curves.items():
        axes.plot(1e3 * w, factor, style, color=colour, lw=1, label=label)
    for value in exact:
        axes.axhline(value, color="k", lw=0.6)
    axes.set(xlabel="settlement $1000\\, w/B$", ylabel=f"{name} (black: exact)",
             ylim=(0, None), xlim=(0, None))
    axes.legend(ncols=2, fontsize=8, loc="lower right")
