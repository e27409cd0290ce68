"""Deep pipe pushed through clay

A pipe far below the surface is pushed sideways; the clay flows round it. The limit load per length is $N s_u D$ with

$$N = \\pi + 2\\Delta + 2\\cos\\Delta + 4\\left(\\cos\\tfrac{\\Delta}{2} + \\sin\\tfrac{\\Delta}{2}\\right), \\qquad
\\sin\\Delta = a = \\tau_{max}/s_u ,$$

(Randolph & Houlsby 1984): 9.14 for a smooth pipe to 11.94 for a fully rough one. It is exact at $a = 1$, and a lower bound
within a few percent of the upper one below. No edge and no surface is near, so this is the cleanest test of the shear limit
on a curved interface. The clay is under a pressure of 12 $s_u$ at the start, so that it does not separate from the pipe; the
pressure has no other effect on clay of this strength. The walls are 4.5 D from the pipe, the mechanism reaches about 1.5 D.
The mean over the displacements from 0.04 D to 0.06 D is compared.
"""

import numpy as np

from mpm_regression.row import Row
from mpm_regression.size import Size

STRENGTH = 3000.0
RATIOS = (0, 0.25, 0.5, 0.75, 1)
RUNS = {f"a_{a}": f"-pipe_shear_limit {a * STRENGTH:g}" for a in RATIOS}
LONG = True


def exact(a):
    delta = np.arcsin(a)
    return np.pi + 2 * delta + 2 * np.cos(delta) + 4 * (np.cos(delta / 2) + np.sin(delta / 2))


def curve(run):
    """Displacement over D, and the factor N, of each row."""
    return run.history["pipe_x"], -run.history["pipe_force_x"] / STRENGTH


def factor(run):
    x, n = curve(run)
    return n[x > 0.04].mean()


def check(runs):
    for a in RATIOS:
        yield Row(f"N, tau_max/su = {a}", factor(runs[f"a_{a}"]), exact(a), 0.05, "Randolph & Houlsby (1984)",
                  relative=True)


def draw(axes, runs):
    for a in RATIOS:
        line, = axes.plot(*curve(runs[f"a_{a}"]), lw=1, label=f"a = {a}")
        axes.axhline(exact(a), color=line.get_color(), ls="--", lw=0.8)
    axes.set(xlabel="displacement over D", ylabel="$N$ (dashed: exact)", ylim=(0, 14), xlim=(0, 0.06))
    axes.legend(ncols=2)


class Fine(Size):
    """Deep pipe, finer

    The smooth and the rough pipe of the case `pipe` with 32 cells across the pipe instead of 16: eight times the work, so the case
    runs on a GPU or on all cores, in double precision.
    """

    RUNS = {name: f"{RUNS[name]} -mesh_spacing 0.03125" for name in ("a_0", "a_1")}
    BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)

    def check(runs):
        for a in (0, 1):
            yield Row(f"N, tau_max/su = {a}, d = D/32", factor(runs[f"a_{a}"]), exact(a), 0.03, "Randolph & Houlsby (1984)",
                      relative=True)
