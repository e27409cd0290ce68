"""Infinite slope between periodic sides

A layer of thickness $z$ (vertical) on a fixed base that slopes by $\\beta$ slides if its strength is divided by more than
$F_s = c / (\\gamma z \\sin\\beta \\cos\\beta) + \\tan\\phi / \\tan\\beta$. The model is one column of 8 cells between periodic
sides, so that it has no ends.

*Stress.* The layer starts without stress; gravity grows over a second, and damping brings it to rest at 80 % of $F_s$. At rest
the normal stress on planes along the slope is $\\rho g (h - y) \\cos\\beta$, and the shear stress $\\rho g (h - y) \\sin\\beta$,
$h = z \\cos\\beta$.

*Safety factor.* The layer starts in equilibrium, with the stress along the slope for which the plane of the slope is the
weakest (as in `infinite_slope`). Runs divide $c$ and $\\tan\\phi$ by $F$. 1 % below $F_s$ the layer stays at rest; 1 % and 2 % above it
slides with

```math
a = \\frac{g \\sin\\beta - (c / \\rho h + g \\cos\\beta \\tan\\phi) / F}{1 + \\tan^2\\phi / F^2},
```

where the denominator is due to the dilation ($\\psi = \\phi$). The safety factor is the $F$ without acceleration, on the line through both. Soil with cohesion fails in its lowest row of
particles, which is half a cell above the base, so that its safety factor is that of this depth: 0.5 % more with 20 cells over the thickness.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame, mesh_options, slope
from mpm_regression.row import Row

G, DENSITY, DEPTH = 10.0, 1800.0, 3.0  # m/s2, kg/m3, m
CELLS, ALONG = 20, 8  # over the thickness, along the slope
SLOPES = {"sand": (0.0, 30, 25), "soil": (5e3, 25, 30)}  # c in Pa, phi and beta in degrees
SHARES = {"rest": 0.8, "below": 0.99, "above": 1.01, "far": 1.02}
END = 0.5  # s


def safety(c, phi, beta, share=1):
    """Factor of safety of a plane at this share of the depth."""
    p, b = np.radians((phi, beta))
    return c / (DENSITY * G * share * DEPTH * np.sin(b) * np.cos(b)) + np.tan(p) / np.tan(b)


def geometry(beta):
    """Thickness across the slope, m, and the cell's edge, m."""
    h = DEPTH * np.cos(np.radians(beta))
    return h, h / CELLS


def set_up(name, where):
    c, phi, beta = SLOPES[name]
    h, d = geometry(beta)
    f, b = SHARES[where] * safety(c, phi, beta), np.radians(beta)
    angle = np.degrees(np.arctan(np.tan(np.radians(phi)) / f))
    g = (G * np.sin(b), -G * np.cos(b))
    options = (mesh_options(2, d, (0, 0), (ALONG * d, h + 4 * d)) + f" -gravity {g[0]:.12g},{g[1]:.12g}"
               f" -sand_cohesion {c / f:.9g} -sand_friction_deg {angle:.9g} -sand_dilation_deg {angle:.9g}")
    if where == "rest":
        return (options + f" -gravity_table 0:0,1:1,2:1 -damping 0.5 -time_end 2 -output_interval 2"
                f" -soil_shape box -soil_lower 0,0 -soil_upper {ALONG * d:.12g},{h:.12g}")
    return options + f" -soil_shape particles -soil_file {{start}} -time_end {END} -output_interval {END} -history_interval 0.005"


RUNS = {f"{name}_{where}": set_up(name, where) for name in SLOPES for where in SHARES}


def prepare(run, path, options):
    name, where = run.split("_")
    if where == "rest":
        return
    c, phi, beta = SLOPES[name]
    h, d = geometry(beta)
    b = np.radians(beta)
    place = particles.lattice((0, 0), (ALONG * d, h), d)
    load = DENSITY * G * (h - place[:, 1])
    normal, shear, apex = load * np.cos(b), load * np.sin(b), c / np.tan(np.radians(phi))
    along = normal + 2 * shear**2 / (normal + apex)
    stress = np.zeros((len(place), 6))
    stress[:, 0], stress[:, 1], stress[:, 2], stress[:, 3] = -along, -normal, -(along + normal) / 2, shear
    particles.write(path, "soil", place, d, stress=stress)


def acceleration(run):
    """Acceleration of the centre of mass down the slope over the second half of the run, m/s2."""
    return slope(run.history["time"], run.history["soil_momentum_x"] / run.history["soil_mass"], END / 2)


def exact(name, where):
    c, phi, beta = SLOPES[name]
    f, (p, b) = SHARES[where] * safety(c, phi, beta), np.radians((phi, beta))
    drive = G * np.sin(b) - (c / (DENSITY * geometry(beta)[0]) + G * np.cos(b) * np.tan(p)) / f
    return drive / (1 + (np.tan(p) / f) ** 2)


def profile(run, beta):
    """Depth below the surface over the thickness, and both stresses over their exact values at the base."""
    frame, h, b = last_frame(run, "soil"), geometry(beta)[0], np.radians(beta)
    base = DENSITY * G * h
    return 1 - frame["position"][:, 1] / h, -frame["stress"][:, 1] / (base * np.cos(b)), frame["stress"][:, 3] / (base * np.sin(b))


def check(runs):
    for name, (c, phi, beta) in SLOPES.items():
        what = f"c = {c / 1e3:g} kPa, phi = {phi}, beta = {beta}"
        depth, normal, shear = profile(runs[f"{name}_rest"], beta)
        for stress, values in (("normal", normal), ("shear", shear)):
            yield Row(f"{what}: largest error of the {stress} stress (of that at the base)", abs(values - depth).max(), 0, 0.01,
                      "equilibrium", single=0.02)
        near, far = (acceleration(runs[f"{name}_{where}"]) for where in ("above", "far"))
        f = np.array([SHARES["above"], SHARES["far"]]) * safety(c, phi, beta)
        drive = np.array([near, far]) * (1 + (np.tan(np.radians(phi)) / f) ** 2)  # is linear in 1/F
        gradient, value = np.polyfit(1 / f, drive, 1)
        yield Row(f"safety factor, {what}", -gradient / value, safety(c, phi, beta), 0.007, "limit equilibrium, exact here",
                  relative=True)
        yield Row(f"safety factor at the depth of the lowest particles, {what}", -gradient / value,
                  safety(c, phi, beta, 1 - 0.5 / CELLS), 0.002, "limit equilibrium", relative=True)
        yield Row(f"{what}: acceleration for F 1 % above (m/s2)", near, exact(name, "above") / 4, 0,
                  "a quarter of Newton's second law: it slides", at_least=True)
        yield Row(f"{what}: speed for F 1 % below (m/s)", abs(runs[f"{name}_below"].history["soil_grid_velocity"][-1]), 0, 1e-4, "it stays")


def draw(axes, runs):
    for name, colour in (("sand", "#0072b2"), ("soil", "#d55e00")):
        for where, style in (("below", ":"), ("above", "--"), ("far", "-")):
            run = runs[f"{name}_{where}"].history
            t, v = run["time"], run["soil_momentum_x"] / run["soil_mass"]
            axes.plot(t, 1e3 * v, style, color=colour, label=f"{name}, F = {SHARES[where]:g} $F_s$")
            axes.plot(t, 1e3 * max(0, exact(name, where)) * t, color=colour, lw=0.6)
    axes.set(xlabel="time (s)", ylabel="speed (mm/s; thin: exact)")
    axes.legend(fontsize=8)
