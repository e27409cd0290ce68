"""Collapse of columns of sand

Columns with $a = H_0/L_0$ from 0.5 to 8 fall over a rough floor, in plane strain, with forty cells over $L_0$. The run-out
over $L_0$ must lie between 0.85 of the law of Lube et al. (2005) for sand, $1.2\\,a$ and $1.9\\,a^{2/3}$, and 1.1 of that of
Lajeunesse et al. (2005) for glass beads, $1.8\\,a$ and $2.3\\,a^{2/3}$ (both as cited by Lagrée et al. 2011), and grow with
an exponent of 2/3 over $a$ = 3 to 8. The laws are `mohr_coulomb`, with 31° and no dilation, and `mu_i` with glass beads.
Columns of 59° must stay below 0.85 of Lube's law. The experiments give a band, not an exact answer: the table's "exact"
value is its middle.
"""

import numpy as np

from mpm_regression.checks import collapse
from mpm_regression.row import Row

DECK = "regression/cases/collapse/case.opts"
SPACING = 0.025
RATIOS = (0.5, 1, 2, 3, 5, 8)
LABELS = {"sand": "mohr_coulomb 31 deg", "beads": "mu_i"}
STEEP = (1, 3)
# Why columns run out further than those of the experiments, from which a on, and up to what share of the band's upper end.
FURTHER = {
    "sand": (3, 1.2, "The toe of a tall column is a single row of particles. With cells of L0/20 the column of a = 5 ends 3 % "
                      "beyond the band."),
    "beads": (1, None, "As a continuum of constant density, mu(I) runs out further than beads do: by 2.2 a, and 3.9 a^0.7 from "
                       "a = 7 on (Lagrée, Staron & Popinet 2011), 1.1 of which is the bound here."),
}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def room(a):
    return 1.3 * collapse.lajeunesse(a) + 1


RUNS = {f"{name}_{a}": collapse.options(a, SPACING, name, room(a)) for name in ("sand", "beads") for a in RATIOS}
RUNS |= {f"steep_{a}": collapse.options(a, SPACING, "steep", room(a)) for a in STEEP}


def prepare(run, path, options):
    collapse.write_column(path, float(run.split("_")[1]), SPACING / 2)


def exponent(runs, name):
    """Slope of log(run-out) over log(a) from a = 3 on."""
    large = [a for a in RATIOS if a >= 3]
    return np.polyfit(np.log(large), np.log([collapse.run_out(runs[f"{name}_{a}"]) for a in large]), 1)[0]


def check(runs):
    for name, label in LABELS.items():
        begin, share, reason = FURTHER[name]
        for a in RATIOS:
            most = share * 1.1 * collapse.lajeunesse(a) if share else 1.1 * collapse.lagree(a)
            low = 0.85 * collapse.lube(a)
            known = {"shortfall": reason, "bound": most - (low + 1.1 * collapse.lajeunesse(a)) / 2} if a >= begin else {}
            yield collapse.band_row(f"run-out over L0, {label}, a = {a}", runs[f"{name}_{a}"], a, **known)
        yield Row(f"exponent of the run-out over a = 3 to 8, {label}", exponent(runs, name), 2 / 3, 0.08, "both experiments")
        for a in (1, 5):
            yield collapse.rest_row(f"{label}, a = {a}", runs[f"{name}_{a}"])
    for a in STEEP:
        yield Row(f"run-out over 0.85 of Lube's law, 59 deg, a = {a}", collapse.run_out(runs[f"steep_{a}"]) / (0.85 * collapse.lube(a)),
                  0.5, 0.5, "a control: stays below 1")


def draw(axes, runs):
    a = np.geomspace(0.4, 10, 100)
    low, high = ([law(x) for x in a] for law in (collapse.lube, collapse.lajeunesse))
    axes.fill_between(a, 0.85 * np.array(low), 1.1 * np.array(high), color="0.9", label="accepted")
    axes.plot(a, low, "k--", lw=0.8, label="Lube et al. 2005 (sand)")
    axes.plot(a, high, "k-.", lw=0.8, label="Lajeunesse et al. 2005 (beads)")
    axes.plot(a, [collapse.lagree(x) for x in a], "k:", lw=0.8, label="Lagrée et al. 2011 (mu(I))")
    for name, label, ratios, mark in (*((name, label, RATIOS, mark) for (name, label), mark in zip(LABELS.items(), "os")),
                                      ("steep", "mohr_coulomb 59 deg", STEEP, "v")):
        axes.loglog(ratios, [collapse.run_out(runs[f"{name}_{x}"]) for x in ratios], mark, ms=5, label=label)
    axes.set(xlabel="$a = H_0/L_0$", ylabel="run-out over $L_0$")
    axes.legend(fontsize=8)
