"""Cylinder and sphere in mud that sink, or rest

A body in mud of the shear strength $\\tau$ sinks by its own weight where its density is more than that of the mud by
$c\\, \\tau / (g D)$: $c$ = 15.20 for a rough and 11.64 for a smooth long cylinder (the limit loads 11.94 and 9.14 $\\tau D$ of Randolph & Houlsby
1984), and 20.98 for a rough sphere (Beris et al. 1985). $D$ = 0.3 m, $\\tau$ = 200 Pa. *Pushed*: the body goes down at 0.05 m/s; the force on it less
the weight of the mud that it displaces gives the excess at which it would sink. *Without weight*: the rough cylinder is pushed through mud under an even
pressure. *Moves*, *rests*: the body is let go; a force takes off its excess of weight at first, and none of it from 0.2 s on. It must sink by
more than 0.05 $D$ with 1.05 of the exact excess, and come to rest with 0.7 of it, which is less than the pushed bodies carry.
"""

import numpy as np

from mpm_regression.row import Row

G, D, DENSITY, STRENGTH = 9.81, 0.3, 1000.0, 200.0  # m/s2, m, kg/m3, Pa
CYLINDERS = "Randolph & Houlsby (1984)"
EXCESS = {"rough": (15.20, CYLINDERS), "smooth": (11.64, CYLINDERS), "sphere": (20.98, "Beris et al. (1985)")}  # over tau / (g D)
BODIES = {"rough": "-body_shear_fraction 1", "smooth": "-body_shear_fraction 0", "sphere": "-body_shear_fraction 1 -geometry axisymmetric"}
VOLUMES = {"rough": np.pi * D**2 / 8, "smooth": np.pi * D**2 / 8, "sphere": np.pi * D**3 / 6}  # m3 in the mesh; of half a cylinder, a metre of it
SHARES = {"moves": 1.05, "rests": 0.7}
END = {"moves": 0.6, "rests": 1.4}  # s
CELLS = (8, 16)
PRESSURES = {12: 0, 37: 0.15}  # over tau; bound of a shortfall
LONG = True


def critical(body):
    """Excess of the density that sinks the body, kg/m3."""
    return EXCESS[body][0] * STRENGTH / (G * D)


def let_go(body, share, end):
    excess = share * critical(body)
    held = excess * G * VOLUMES[body]
    return f"{BODIES[body]} -body_density {DENSITY + excess:.4f} -body_force 0,{held:.5f} -body_force_table 0:1,0.2:0,9:0 -time_end {end:g}"


PUSH = "-body_motion prescribed -body_velocity 0,-0.05 -time_end 0.8"
RUNS = {f"{body}_{name}": let_go(body, share, END[name]) for body in BODIES for name, share in SHARES.items()}
RUNS |= {f"{body}_pushed_{cells}": f"{BODIES[body]} {PUSH} -mesh_spacing {D / cells:g}" for body in BODIES for cells in CELLS}
NO_WEIGHT = "-gravity 0,0 -mesh_upper 0.6,0.75 -mesh_ymax roller -bed_stress {0},{0},{0},0"
RUNS |= {f"no_weight_{pressure}": f"{BODIES['rough']} {PUSH} {NO_WEIGHT.format(-pressure * STRENGTH)}" for pressure in PRESSURES}


def carried(run, body):
    """Displacements over D, and the excess of density that the force on the pushed body carries over the exact one."""
    way = -run.history["body_y"] / D
    excess = run.history["body_force_y"][1:] / (G * VOLUMES[body]) - DENSITY
    return (way[1:] + way[:-1]) / 2, excess / critical(body)


def force(run):
    """Force on the cylinder that is pushed through mud without weight, over the exact one."""
    way = -run.history["body_y"] / D
    late = (way > 0.06) & (way < 0.13)
    return run.history["body_force_y"][late].mean() / (EXCESS["rough"][0] * STRENGTH / D * VOLUMES["rough"])


def sunk(run, begin, end):
    """How far the body sinks between two times, over D."""
    return np.interp(begin, run.history["time"], run.history["body_y"] / D) - np.interp(end, run.history["time"], run.history["body_y"] / D)


def pushed(run, body):
    way, share = carried(run, body)
    return share[(way > 0.06) & (way < 0.13)].mean()


PRESSED = "The coarser the cells and the higher the pressure of the mud over its strength, the less it carries (docs/bodies.md)."


def check(runs):
    for body, (_, source) in EXCESS.items():
        yield Row(f"{body}, 1.05 of the exact excess: way sunk from 0.2 s to 0.6 s over D", sunk(runs[f"{body}_moves"], 0.2, 0.6), 0.05, 0, source,
                  at_least=True)
        yield Row(f"{body}, {SHARES['rests']:g} of it: way sunk from 1.1 s to 1.4 s over D", sunk(runs[f"{body}_rests"], 1.1, 1.4), 0, 0.005, source)
        shares = {cells: pushed(runs[f"{body}_pushed_{cells}"], body) for cells in CELLS}
        for cells, bound in zip(CELLS, (0.6, 0.25)):
            yield Row(f"{body}, pushed: excess that it carries over the exact one, D/{cells}", shares[cells], 1, 0.05, source, shortfall=PRESSED,
                      bound=bound)
    for pressure, bound in PRESSURES.items():
        yield Row(f"rough, pushed without weight, under a pressure of {pressure} tau: force over the exact one, D/16",
                  force(runs[f"no_weight_{pressure}"]), 1, 0.05, CYLINDERS, shortfall=PRESSED if bound else "", bound=bound)


def draw(axes, runs):
    for body, colour in zip(EXCESS, ("C0", "C1", "C2")):
        for name, style in (("moves", "-"), ("rests", "--")):
            run = runs[f"{body}_{name}"]
            axes.plot(run.history["time"], -run.history["body_y"] / D, colour + style, lw=1, label=f"{body}, {SHARES[name]:g} of the excess")
    axes.set(xlabel="time (s)", ylabel="settlement over D", xlim=(0, 1.4), ylim=(0, 0.4))
    axes.legend(fontsize=8)
