"""Sides of the free field

*Level ground*: two elastic layers between sides of the free field, under a shear wave and a pressure wave that come in
through the base together, must move as between periodic sides, where they are a column without ends. With the weight of the ground the static
force of the sides does not follow the soil, which moves by 0.2 % of a cell. *Transfer function*: the motion of the surface over that of the outcrop, for a layer of height $H$ on stiffer
ground that absorbs, is $1 / |\\cos kH + i \\alpha \\sin kH|$ with the ratio $\\alpha$ of the impedances. *Bar*: a pulse that runs along a bar to a
side of the free field, which is at rest, comes back with $R = (1 - a)/(1 + a)$ as from an absorbing side. *Slope*: an elastic slope with 4 m at its left side and 8 m at its right one
has come to rest between rollers; it must stay at rest when its sides become those of the free field, and be back in its place after a wave has passed. Until waves from the slope
arrive, the soil at each side must move as a column of its height between periodic sides.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import first_frame, trapezoid
from mpm_regression.row import Row
from soil_mpm.results import read_frame

PERIODIC, FREE = " -mesh_xmin periodic -mesh_xmax periodic", " -mesh_xmin free_field -mesh_xmax free_field"


def wave(x, y):
    """Velocity of the outcrop: a cycle of 5 Hz with these amplitudes, m/s."""
    points = [(0, 0), (0.05, 1), (0.15, -1), (0.2, 0), (9, 0)]
    return "-mesh_ymin_velocity_table " + ",".join(f"{t}:{x * v:.9g}:{y * v:.9g}" for t, v in points)


BOTH = wave(2e-4, 1e-4)
LEVEL = {"flip": "", "apic": " -velocity_update apic", "xpic": " -velocity_update xpic -flip_fraction 0.9",
         "rigid_base": " -mesh_ymin fixed -flip_fraction 0.99 -f_bar_fraction 0"}
WEIGHT = wave(2e-3, 1e-3) + " -gravity 0,-9.81 -top_stress k0 -low_stress k0"

# A layer on stiff ground, both of 2000 kg/m3, with waves of 100 and 200 m/s.
H, SOFT, STIFF, END = 8.0, 100.0, 200.0, 3.0
LAYER = ("-mesh_upper 4,12 -mesh_spacing 0.25 -time_end 3 -soft_density 2000 -soft_young 5e7 -soft_poisson 0.25 -stiff_young 2e8 -top_lower 0,3 -top_upper 4,11 -low_upper 4,3"
         " -probes surface -surface_kind particle -surface_at 2,10.95 -history_interval 0.0025"
         " -mesh_ymin_velocity_table 0:0:0,0.02:1e-5:0,0.06:-1e-5:0,0.08:0:0,9:0:0 -mesh_ymin_velocity_table_interpolation smooth" + FREE)

CELLS, EDGE, SPEED, PEAK = 60, 0.25, 100.0, 0.01
FACTORS = ("0.5", "1", "2")


def bar(factor):
    return (f"-bodies bar -bar_material stiff -bar_shape particles -bar_particles_per_cell 2 -bar_file {{start}} -materials stiff -stiff_young 2e7 -stiff_poisson 0 -mesh_upper 15,0.25 -mesh_spacing 0.25 -mesh_ymin roller"
            f" -mesh_ymax roller -mesh_xmin free -mesh_xmax free_field -mesh_xmax_dashpot_factor {factor} -time_end 0.125 -time_courant 0.2 -history_interval 0.0025")


SLOPE = ("-mesh_upper 40,10 -bodies hill -hill_material stiff -hill_shape polygon -hill_polygon 0,0,40,0,40,8.25,24,8.25,16,4.25,0,4.25 -materials stiff -gravity 0,-9.81 -stages rest,shake -rest_end equilibrium -rest_damping 0.7"
         " -rest_unbalanced_ratio 1e-6 -rest_time_end 6 -rest_mesh_ymin fixed -rest_reset on -probes left,right -left_kind particle -left_at 0.9,4 -right_kind particle -right_at 39.1,8 -history_interval 0.0025"
         " -shake_mesh_ymin absorbing -shake_mesh_xmin free_field -shake_mesh_xmax free_field -shake_time_end 3 -output_interval 0.5 ")


def beside(height):
    """A column of the ground at a side of the slope."""
    return (f"-bodies low -low_upper 4,{height} -materials stiff -time_end 0.2 -probes side -side_kind particle -side_at 0.9,{height - 0.25} -history_interval 0.0025 "
            + wave(2e-3, 0) + PERIODIC)


LONG = True
RUNS = ({f"{name}_{kind}": BOTH + more + sides for name, more in LEVEL.items() for kind, sides in (("column", PERIODIC), ("free", FREE))}
        | {"weight_column": WEIGHT + PERIODIC, "weight_free": WEIGHT + FREE, "layer": LAYER}
        | {f"bar_{factor}": bar(factor) for factor in FACTORS}
        | {"still": SLOPE, "slope": SLOPE + wave(2e-3, 0).replace("-mesh", "-shake_mesh"), "left": beside(4.25), "right": beside(8.25)})


def prepare(run, path, options):
    if not run.startswith("bar"):
        return
    position = particles.lattice((0, 0), (CELLS * EDGE, EDGE), EDGE / 2)
    x = (position[:, 0] / EDGE - 35) / 20
    pulse = np.where(abs(x) < 0.5, np.cos(np.pi * x) ** 2, 0.0)
    velocity, stress = np.zeros_like(position), np.zeros((len(position), 6))
    velocity[:, 0] = PEAK * pulse
    stress[:, 0] = -2000 * SPEED * PEAK * pulse
    particles.write(path, "bar", position, EDGE / 2, velocity=velocity, stress=stress)


def apart(run, reference):
    """The largest difference of displacements over the largest displacement, of all frames."""
    worst = largest = 0.0
    for body in ("top", "low"):
        start = first_frame(reference, body)["position"]
        for path in sorted(reference.folder.glob("frames/frame_*.h5")):
            exact = read_frame(path)[1][body]["position"]
            worst = max(worst, np.abs(read_frame(run.folder / "frames" / path.name)[1][body]["position"] - exact).max())
            largest = max(largest, np.abs(exact - start).max())
    return worst / largest


def transfer(run, frequency):
    """Amplitude of the surface over that of the outcrop."""
    t, v = run["time"], run["surface_velocity_x"]
    table = [(0, 0), (0.02, 1e-5), (0.06, -1e-5), (0.08, 0)]
    fine = np.linspace(0, 0.08, 8001)
    outcrop = np.zeros_like(fine)
    for (t0, v0), (t1, v1) in zip(table, table[1:]):
        x = np.clip((fine - t0) / (t1 - t0), 0, 1)
        inside = (fine >= t0) & (fine <= t1)
        outcrop[inside] = (v0 + (v1 - v0) * x * x * (3 - 2 * x))[inside]
    share = lambda t, v: abs(trapezoid(v * np.exp(-2j * np.pi * frequency * t), t))  # noqa: E731
    return share(t, v) / share(fine, outcrop)


def check(runs):
    for name in LEVEL:
        yield Row(f"level ground, {name}: displacements off the column", apart(runs[f"{name}_free"], runs[f"{name}_column"]), 0, 2e-5, "run between periodic sides", single=0.02)
    yield Row("the same with its weight", apart(runs["weight_free"], runs["weight_column"]), 0, 0.02, "run between periodic sides", single=0.03)
    for share in (0.5, 1, 1.5, 2, 3):
        frequency = share * SOFT / (4 * H)
        exact = 1 / abs(np.cos(share * np.pi / 2) + 1j * SOFT / STIFF * np.sin(share * np.pi / 2))
        yield Row(f"surface over outcrop at {share} of the first frequency", transfer(runs["layer"].history, frequency), exact, 0.02, "Kramer 1996", relative=True)
    for factor in FACTORS:
        momentum = runs[f"bar_{factor}"].history["bar_momentum_x"]
        exact = (1 - float(factor)) / (1 + float(factor))
        yield Row(f"bar: R by the momentum, a = {factor}", momentum[-1] / momentum[0], exact, 0.01, "linear wave equation")
    for name in ("still", "slope"):
        run = runs[name].history
        late = run["stage"] == 2
        moved = np.hypot(run["hill_centre_x"][late] - run["hill_centre_x"][late][0], run["hill_centre_y"][late] - run["hill_centre_y"][late][0])
        if name == "still":
            yield Row("slope at rest: movement of the centre in 3 s (m)", moved.max(), 0, 2e-6, "at rest")
        else:
            yield Row("slope: centre behind the wave, over its way", moved[-1] / moved.max(), 0, 0.05, "elastic")
    run = runs["slope"].history
    shaken = run["stage"] == 2
    for side in ("left", "right"):
        column = runs[side].history
        t = run["time"][shaken] - run["time"][~shaken][-1]
        exact = np.interp(t[t <= 0.1], column["time"], column["side_velocity_x"])
        got = run[f"{side}_velocity_x"][shaken][t <= 0.1]
        yield Row(f"slope: velocity at the {side} off its column", np.abs(got - exact).max() / np.abs(exact).max(), 0, 0.01, "run between periodic sides")


def draw(axes, runs):
    frequency = np.linspace(0.2, 14, 140)
    kh = 2 * np.pi * frequency * H / SOFT
    axes.plot(frequency, 1 / abs(np.cos(kh) + 1j * SOFT / STIFF * np.sin(kh)), "k--", label="exact")
    axes.plot(frequency, [transfer(runs["layer"].history, f) for f in frequency], label="free field")
    axes.set(xlabel="frequency (Hz)", ylabel="surface over outcrop")
    axes.legend()
