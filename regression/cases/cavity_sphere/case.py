"""A spherical cavity expanded to twice its radius

A pressure on the wall of a hole of radius $a_0$ = 1 m, which follows the wall, widens the hole in soil under the pressure $p_0$
(`-geometry axisymmetric`, ten cells over $a_0$). The radius $a$ of the hole is that of the sphere with its volume, by nine particles at
its wall. In incompressible soil of `tresca` the pressure at $a = 2 a_0$ is
$p_0 + \\frac{4}{3} s_u (1 + \\ln(G/s_u) - \\ln(8/7))$; here $\\nu$ = 0.49. For `mohr_coulomb` the pressures are those of the self-similar
solution in large strain (Yu & Houlsby 1991). The outer sides, at 20 $a_0$, are `absorbing` with springs.
The soil at the wall is stretched to twice its length along the wall, so it has many small particles.
"""

import numpy as np

from mpm_regression.row import Row

OUTER, NEAR = 20.0, 2.0  # m, edges of the bodies
ARC = np.radians(np.linspace(0, 90, 65))
PROBES = np.radians(np.arange(5, 90, 10))
SOILS = {  # options; Poisson's ratio, p0 and {a / a0: pressure} in kPa, the last pressure over the last of these, s, particles a cell's edge, Courant number
    "tresca": ("-soil_model tresca -soil_su 10e3 -soil_young 2.98e6", 0.49, 50, {2: 122.96}, 1.018, 12, 6, 0.35),
    "sand": ("-soil_model mohr_coulomb -soil_young 20e6 -soil_cohesion 0 -soil_friction_deg 30 -soil_dilation_deg 0",
             0.3, 100, {1.5: 1116.3}, 1.06, 3, 10, 0.25),
    "dilatant": ("-soil_model mohr_coulomb -soil_young 20e6 -soil_cohesion 0 -soil_friction_deg 30 -soil_dilation_deg 30",
                 0.3, 100, {1.5: 2558.1, 2: 3198.7}, 1.03, 3, 12, 0.21),
    "c_phi": ("-soil_model mohr_coulomb -soil_young 20e6 -soil_cohesion 5e3 -soil_friction_deg 25 -soil_dilation_deg 5",
              0.3, 50, {1.5: 779.3, 2: 865.4}, 1.03, 3, 10, 0.25),
}
LABELS = {"tresca": "tresca, su 10 kPa", "sand": "c 0, phi 30, psi 0", "dilatant": "c 0, phi 30, psi 30", "c_phi": "c 5 kPa, phi 25, psi 5"}
LONG = True


def numbers(values):
    return ",".join(f"{x:.10g}" for x in np.ravel(values))


def applied(name, u):
    """The pressure [kPa] at shares u of the time. It grows ever slower, as the hole widens ever faster."""
    _, _, p0, exact, over, *_ = SOILS[name]
    return p0 + (over * max(exact.values()) - p0) * u * (7 - 3 * u) / 4


def options(name):
    soil, poisson, p0, _, _, end, particles, courant = SOILS[name]
    wall = np.column_stack([np.sin(ARC), np.cos(ARC)])
    near = numbers(np.vstack([[(NEAR, 0), (NEAR, NEAR), (0, NEAR)], wall]))
    spring = OUTER * (1 - poisson) / (1 - 2 * poisson)
    u = np.linspace(0, 1, 41)
    table = ",".join(f"{end * x:g}:{1000 * y:.8g}" for x, y in zip(u, applied(name, u)))
    probes = " ".join(f"-w{n}_kind particle -w{n}_at {1.005 * np.cos(angle):.6g},{1.005 * np.sin(angle):.6g}" for n, angle in enumerate(PROBES))
    stress = f"-{p0}e3,-{p0}e3,-{p0}e3,0"
    return (f" {soil} -soil_poisson {poisson} -near_stress {stress} -far_stress {stress} -near_polygon {near} -near_particles_per_cell {particles}"
            f" -time_courant {courant} -wall_pressure_table {table} -probes {','.join(f'w{n}' for n in range(len(PROBES)))} {probes}"
            f" -mesh_xmax_spring_length {spring:g} -mesh_ymax_spring_length {spring:g}"
            f" -time_end {end} -history_interval {end / 400:g} -output_interval {end}")


RUNS = {name: options(name) for name in SOILS}


def pressure(run, name):
    """Radius of the cavity [m] and the pressure on its wall [kPa]."""
    cubes = np.column_stack([np.hypot(run.history[f"w{n}_x"], run.history[f"w{n}_y"]) ** 3 for n in range(len(PROBES))])
    grown = np.average(cubes - cubes[0], axis=1, weights=np.cos(PROBES))
    return np.cbrt(1 + grown), applied(name, run.history["time"] / SOILS[name][5])


def check(runs):
    for name, (_, _, _, exact, *_) in SOILS.items():
        radius, p = pressure(runs[name], name)
        source = "incompressible, large strain" if name == "tresca" else "Yu & Houlsby (1991)"
        for a, value in exact.items():
            answer = np.interp(a, np.maximum.accumulate(radius), p, right=np.nan)
            yield Row(f"pressure (kPa), {LABELS[name]}, a = {a} a0", answer, value, 0.02 if name == "tresca" else 0.06, source, relative=True)


def draw(axes, runs):
    for colour, (name, run) in zip(("C0", "C1", "C2", "C3"), runs.items()):
        axes.plot(*pressure(run, name), colour, lw=1, label=LABELS[name])
        axes.plot(*zip(*SOILS[name][3].items()), "o", color=colour)
    axes.set(xlabel="radius of the cavity over that at the start", ylabel="pressure (kPa; points: exact)", xlim=(1, 2.3), ylim=(0, None))
    axes.legend()
