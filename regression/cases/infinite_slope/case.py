"""Infinite slope

A slab of thickness $z$ (vertical) on a base that slopes by $\\beta$ slides if the strength is divided by more than
$F_s = c / (\\gamma z \\sin\\beta \\cos\\beta) + \\tan\\phi / \\tan\\beta$. Runs divide $c$ and $\\tan\\phi$ by $F$. The slab
starts at rest in equilibrium, with the stress along it for which the plane of the slope is the weakest:
$\\sigma_x = \\sigma_n + 2 \\tau^2 / \\sigma_n$, with $c \\cot\\phi$ added to the compressive stresses. For $F$ 3 % below $F_s$ it
stays at rest. For $F$ 3 % above it slides on the base with

```math
a = \\frac{g \\sin\\beta - (c / \\rho h + g \\cos\\beta \\tan\\phi) / F}{1 + \\tan^2\\phi / F^2}, \\qquad h = z \\cos\\beta ,
```

where the denominator is due to the dilation, which lifts the slab and adds to the normal stress ($\\psi = \\phi$). The
safety factor is the $F$ without acceleration, on the line through 3 % and 6 %; $a$ itself is a small difference, which
an error of $F_s$ of 1 % changes by a third.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import mesh_options
from mpm_regression.row import Row
from soil_mpm.results import read_frame

G, DENSITY, DEPTH = 10.0, 1800.0, 3.0  # m/s2, kg/m3, m
CELLS = 20  # over the thickness
SLOPES = {"sand": (0.0, 30, 25), "soil": (5e3, 25, 30)}  # c in Pa, phi and beta in degrees
SHARES = {"below": 0.97, "above": 1.03, "far": 1.06}


def safety(c, phi, beta):
    p, b = np.radians((phi, beta))
    return c / (DENSITY * G * DEPTH * np.sin(b) * np.cos(b)) + np.tan(p) / np.tan(b)


def geometry(beta):
    """Thickness across the slope, m, and the cell's edge, m."""
    h = DEPTH * np.cos(np.radians(beta))
    return h, h / CELLS


def set_up(name, share):
    c, phi, beta = SLOPES[name]
    h, d = geometry(beta)
    f, b = share * safety(c, phi, beta), np.radians(beta)
    angle = np.degrees(np.arctan(np.tan(np.radians(phi)) / f))
    return (mesh_options(2, d, (0, 0), (20 * h, h + 4 * d)) + f" -gravity {G * np.sin(b):.12g},{-G * np.cos(b):.12g}"
            f" -sand_cohesion {c / f:.9g} -sand_friction_deg {angle:.9g} -sand_dilation_deg {angle:.9g}" + " -soil_file {start}")


RUNS = {f"{name}_{where}": set_up(name, share) for name in SLOPES for where, share in SHARES.items()}


def prepare(run, path, options):
    c, phi, beta = SLOPES[run.split("_")[0]]
    h, d = geometry(beta)
    b = np.radians(beta)
    place = particles.lattice((0, 0), (20 * h, h), d)
    load = DENSITY * G * (h - place[:, 1])
    normal, shear, apex = load * np.cos(b), load * np.sin(b), c / np.tan(np.radians(phi))
    along = normal + 2 * shear**2 / (normal + apex)
    stress = np.zeros((len(place), 6))
    stress[:, 0], stress[:, 1], stress[:, 2], stress[:, 3] = -along, -normal, -(along + normal) / 2, shear
    particles.write(path, "soil", place, d, stress=stress)


def speeds(run):
    """Times, s, and mean speed down the slope of the middle third, m/s, of the frames."""
    result = []
    for path in run.frames:
        time, groups = read_frame(path)
        x = groups["soil"]["position"][:, 0]
        length = run.numbers("mesh_upper")[0]
        result.append((time, groups["soil"]["velocity"][(x > length / 3) & (x < 2 * length / 3), 0].mean()))
    return np.array(result).T


def acceleration(run):
    """Over the second half of the run, m/s2."""
    t, v = speeds(run)
    return (v[-1] - v[-2]) / (t[-1] - t[-2])


def exact(name, share):
    c, phi, beta = SLOPES[name]
    f, (p, b) = share * safety(c, phi, beta), np.radians((phi, beta))
    drive = G * np.sin(b) - (c / (DENSITY * geometry(beta)[0]) + G * np.cos(b) * np.tan(p)) / f
    return drive / (1 + (np.tan(p) / f) ** 2)


def check(runs):
    for name, (c, phi, beta) in SLOPES.items():
        what = f"c = {c / 1e3:g} kPa, phi = {phi}, beta = {beta}"
        near, far = (acceleration(runs[f"{name}_{where}"]) for where in ("above", "far"))
        # the acceleration times its denominator is linear in 1/F
        f = np.array([SHARES["above"], SHARES["far"]]) * safety(c, phi, beta)
        drive = np.array([near, far]) * (1 + (np.tan(np.radians(phi)) / f) ** 2)
        slope, value = np.polyfit(1 / f, drive, 1)
        yield Row(f"safety factor, {what}", -slope / value, safety(c, phi, beta), 0.01,
                  "limit equilibrium, exact here", relative=True)
        yield Row(f"{what}: acceleration for F 3 % above (m/s2)", near, exact(name, SHARES["above"]) / 2, 0,
                  "half of Newton's second law: it slides", at_least=True)
        yield Row(f"{what}: speed for F 3 % below (m/s)", speeds(runs[f"{name}_below"])[1][-1], 0, 1e-4, "it stays")


def draw(axes, runs):
    for name, colour in (("sand", "#0072b2"), ("soil", "#d55e00")):
        for where, style in (("below", ":"), ("above", "--"), ("far", "-")):
            t, v = speeds(runs[f"{name}_{where}"])
            axes.plot(t, 1e3 * v, "o" + style, color=colour, ms=3, label=f"{name}, F = {SHARES[where]:g} $F_s$")
            axes.plot(t, 1e3 * max(0, exact(name, SHARES[where])) * t, color=colour, lw=0.6)
    axes.set(xlabel="time (s)", ylabel="speed of the middle third (mm/s; thin: exact)")
    axes.legend(fontsize=8)
