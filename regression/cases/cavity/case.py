"""A cylindrical cavity expanded to twice its radius

A ring widens a hole of radius $a_0$ = 1 m in soil under the pressure $p_0$ (`-geometry axisymmetric`, one row of cells, ten cells over
$a_0$), at 0.001 of the speed of shear waves and without damping, which would add its share to the force. In incompressible soil of
`tresca` the pressure at $a = 2 a_0$ is $p_0 + s_u (1 + \\ln(G/s_u) - \\ln(4/3))$; here $\\nu$ = 0.49. For `mohr_coulomb` the pressures are
those of the self-similar solution in large strain (Yu & Houlsby 1991). The outer side, at 60 $a_0$, is `absorbing` with springs of
the length $b\\,M/(2G)$, with which it yields as the elastic medium beyond it would. The mean over 4 % of $a_0$ on both sides is compared.
"""

import numpy as np

from mpm_regression.row import Row

SPACING, OUTER = 0.1, 60.0
WINDOW = 0.04  # m, on both sides of a radius
SOILS = {  # options; kPa at a / a0
    "tresca": ("-soil_model tresca -soil_su 10e3 -soil_young 2.98e6 -soil_poisson 0.49 -ground_stress -50e3,-50e3,-50e3,0", 0.49, {2: 103.17}),
    "sand": ("-soil_model mohr_coulomb -soil_young 20e6 -soil_poisson 0.3 -soil_cohesion 0 -soil_friction_deg 30 -soil_dilation_deg 0"
             " -ground_stress -100e3,-100e3,-100e3,0", 0.3, {1.5: 599.8, 2: 661.2}),
    "c_phi": ("-soil_model mohr_coulomb -soil_young 20e6 -soil_poisson 0.3 -soil_cohesion 5e3 -soil_friction_deg 25 -soil_dilation_deg 5"
              " -ground_stress -50e3,-50e3,-50e3,0", 0.3, {1.5: 386.1, 2: 427.7}),
}
SPEED = {"tresca": 0.02, "sand": 0.06, "c_phi": 0.06}  # m/s
LABELS = {"tresca": "tresca, su 10 kPa", "sand": "c 0, phi 30, psi 0", "c_phi": "c 5 kPa, phi 25, psi 5"}
LONG = True


def options(name):
    soil, poisson, _ = SOILS[name]
    end = 1.04 / SPEED[name]
    spring = OUTER * (1 - poisson) / (1 - 2 * poisson)
    return (f"{soil} -ring_velocity {SPEED[name]},0 -mesh_xmax_spring_length {spring:g} -time_end {end:g} -history_interval {end / 208:g}"
            f" -output_interval {end:g}")


RUNS = {name: options(name) for name in SOILS}


def pressure(run):
    """Radius of the cavity [m] and the pressure on its wall [kPa], between the rows of the history."""
    radius = 1 + run.history["ring_x"]
    radius = (radius[1:] + radius[:-1]) / 2
    return radius, -run.history["ring_force_x"][1:] / (2 * np.pi * radius * SPACING) / 1000


def check(runs):
    for name, (_, _, exact) in SOILS.items():
        radius, p = pressure(runs[name])
        source = "incompressible, large strain" if name == "tresca" else "Yu & Houlsby (1991)"
        for a, value in exact.items():
            yield Row(f"pressure (kPa), {LABELS[name]}, a = {a} a0", p[abs(radius - a) < WINDOW].mean(), value, 0.04, source, relative=True)


def draw(axes, runs):
    for (name, run), colour in zip(runs.items(), ("C0", "C1", "C2")):
        axes.plot(*pressure(run), colour, lw=1, label=LABELS[name])
        axes.plot(*zip(*SOILS[name][2].items()), "o", color=colour)
    axes.set(xlabel="radius of the cavity over that at the start", ylabel="pressure (kPa; points: exact)", ylim=(0, None))
    axes.legend()
