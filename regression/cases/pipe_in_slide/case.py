"""Pipe in a slide of mud

A pipe across a deep slide takes a force per length $F = N_p\\, s_u D + C_d\\, \\rho v^2 D / 2$ with $N_p$ = 11.9 and $C_d$ = 0.4 (Randolph & White 2012, for a rough pipe; the first
part is the limit load of Randolph & Houlsby 1984). Here the pipe moves through mud at rest with $s_u$ = 1 kPa, $\\rho$ = 1600 kg/m³ and $D$ = 1 m, and the mean from 2.5 to 4.5 $D$ of its way
is compared. The pipe has 32 cells over its diameter. Their formula is a fit to computed flows of mud without stiffness.
"""

import numpy as np

from mpm_regression.row import Row

STRENGTH, DENSITY, WAY = 1000.0, 1600.0, 4.6  # Pa, kg/m3, m
SPEEDS = (0.5, 1.6, 2.5, 4.3, 7.9)  # m/s
RUNS = {f"v{speed:g}": f"-pipe_velocity {speed},0 -time_end {WAY / speed:.6g} -history_interval {WAY / speed / 230:.6g}" for speed in SPEEDS}
LONG = True
FAST = "Stiffness, cells and velocity update change the force of fast mud; which of them is wrong was not separated. Shear waves of the mud have 7.9 m/s."


def published(speed):
    return 11.9 + 0.2 * DENSITY * speed**2 / STRENGTH


def force(run):
    """Force on the whole pipe over su D, and the way over D."""
    return run.history["pipe_x"], -2 * run.history["pipe_force_x"] / STRENGTH


def mean(run):
    way, f = force(run)
    return f[(way > 2.5) & (way < 4.5)].mean()


def check(runs):
    for speed, run in zip(SPEEDS, runs.values()):
        yield Row(f"force over su D at {speed:g} m/s", mean(run), published(speed), 0.1, "Randolph & White (2012)", relative=True, shortfall=FAST if speed > 2 else "", bound=0.3)


def draw(axes, runs):
    ratio = DENSITY * np.array(SPEEDS) ** 2 / STRENGTH
    line = np.linspace(0, ratio[-1])
    axes.plot(line, 11.9 + 0.2 * line, "k--", lw=0.8, label="Randolph & White (2012)")
    axes.plot(ratio, [mean(run) for run in runs.values()], "o", label="computed")
    axes.set(xlabel="$\\rho v^2 / s_u$", ylabel="$F / (s_u D)$", ylim=(0, None))
    axes.legend(fontsize=8)
