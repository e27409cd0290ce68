"""Smooth retaining wall

A smooth wall of height $H$ holds dry sand, $\\phi = \\psi$ = 30°, with a level surface. Pushed into the sand, it
carries $P = K_p \\gamma H^2 / 2 + 2 c \\sqrt{K_p} H$; moved away, $P = K_a \\gamma H^2 / 2 - 2 c \\sqrt{K_a} H$, with
$K_p = 3 = 1 / K_a$ (Rankine 1857). The sand starts with $K_0$ = 0.5 and the stress of its weight. A cohesion of
$c = 10^{-3} \\gamma H$ keeps the surface together. The wall moves by 0.004 $H$ away or by 0.01 $H$ into the sand, and the
mean over the second half is compared. The base is smooth. On a rough base the wedge must leave the wall above the first
row of nodes, which cannot move, and the answers depend on the cells: with 20 over the height 3.13 and 0.25.
"""

from mpm_regression import ground
from mpm_regression.row import Row
from mpm_regression.size import Size

HEIGHT, LENGTH, WEIGHT, COHESION = 1.0, 3.0, 20e3, 20.0  # m, m, N/m3, Pa
KP = 3.0
MOVES = {"active": "-wall_velocity -0.008,0", "passive": "-wall_velocity 0.02,0"}
FORCE = WEIGHT * HEIGHT**2 / 2  # N/m at K = 1
EXACT = {"active": (1 / KP - 2 * COHESION * HEIGHT / KP**0.5 / FORCE, 0.02),
         "passive": (KP + 2 * COHESION * HEIGHT * KP**0.5 / FORCE, 0.04)}  # with the tolerance
RUNS = {name: options + " -soil_file {start}" for name, options in MOVES.items()}


def prepare(run, path, options):
    spacing = float(options[options.index("-mesh_spacing") + 1]) if "-mesh_spacing" in options else 0.1
    ground.write_level(path, "soil", (0, 0), (LENGTH, HEIGHT), spacing / 2, WEIGHT, 0.5)


def pressure(run):
    """Mean force on the wall over the second half of its movement, over that at K = 1."""
    t, force = run.history["time"], run.history["wall_force_x"]
    return -force[t > t[-1] / 2].mean() / FORCE


def check(runs):
    for name, (exact, tolerance) in EXACT.items():
        cells = HEIGHT / runs[name].number("mesh_spacing")
        yield Row(f"{name}: force over the unit weight x H^2/2, d = H/{cells:.0f}", pressure(runs[name]), exact, tolerance,
                  "Rankine (1857)", relative=True)


def draw(axes, runs):
    for name, colour in (("active", "#0072b2"), ("passive", "#d55e00")):
        run = runs[name]
        axes.plot(abs(run.history["wall_x"][1:]) / HEIGHT, -run.history["wall_force_x"][1:] / FORCE, color=colour, lw=1, label=name)
        axes.axhline(EXACT[name][0], color="k", lw=0.6)
    axes.set(xlabel="movement of the wall over its height", ylabel="$P / (\\gamma H^2 / 2)$ (black: exact)", yscale="log")
    axes.set_yticks([1 / KP, 1, KP], ["1/3", "1", "3"])
    axes.minorticks_off()
    axes.legend()


class Fine(Size):
    """Smooth retaining wall, finer

    The case `retaining_wall` with 40 cells over the height instead of 10.
    """

    RUNS = {name: f"{options} -mesh_spacing 0.025" for name, options in RUNS.items()}
    BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
    LONG = True
    draw = draw
