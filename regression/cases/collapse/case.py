"""Collapse of a column of sand, coarse

A column of sand as high as it is long ($a = H_0/L_0 = 1$) falls over a rough floor, in plane strain: half of a symmetric
one. In channels sand runs out by $1.2\\,a\\,L_0$ (Lube et al. 2005), glass beads by $1.8\\,a\\,L_0$ (Lajeunesse et al.
2005); from 0.85 of the former to 1.1 of the latter is accepted. The laws are `mohr_coulomb`, with 31° and no dilation, and
`mu_i` with glass beads. A column of 59° must not reach the band. Ten cells over the height; `collapse_fine` has more, and
more heights.
"""

from mpm_regression.checks import collapse
from mpm_regression.row import Row

SPACING = 0.1
RUNS = {name: collapse.options(1, SPACING, name, 3) for name in ("sand", "beads", "steep")}


def prepare(run, path, options):
    collapse.write_column(path, 1, SPACING / 2)


def check(runs):
    yield collapse.band_row("run-out over L0, mohr_coulomb 31 deg", runs["sand"], 1)
    yield collapse.band_row("run-out over L0, mu_i", runs["beads"], 1)
    yield Row("run-out over 0.85 of Lube's law, 59 deg", collapse.run_out(runs["steep"]) / (0.85 * collapse.lube(1)), 0.5, 0.5,
              "a control: stays below 1")
    for name in ("sand", "beads"):
        yield collapse.rest_row(name, runs[name])


def draw(axes, runs):
    for name, label in (("sand", "mohr_coulomb, 31°"), ("beads", "mu_i"), ("steep", "mohr_coulomb, 59°")):
        axes.step(*collapse.surface(runs[name]), where="mid", label=label)
    axes.plot([0, 1, 1], [1, 1, 0], "k:", lw=0.8, label="start")
    axes.set(xlabel="x over $L_0$", ylabel="height over $L_0$", aspect="equal", xlim=(0, 3.2), ylim=(0, 1.05))
    axes.legend()
