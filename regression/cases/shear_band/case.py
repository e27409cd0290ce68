"""Shear band in softening clay, on three meshes

A slab is pulled over a weak layer of softening clay, in which a band forms that is as wide as a few cells. The work that is
dissipated, that of the pull less the kinetic energy, is measured per metre of the band, until the slab has slipped by 0.15
m. It must not depend on the cells. With a constant $\\xi_{95}$ it does: a band of half the cell takes half of the slip to
soften. With `xi95_cell` the slip over which the band softens, $\\xi_{95}$ times the cell, is the same on every mesh. The
check takes the work beyond that of remoulded clay, $\\delta s_u$ times the slip. In a band as wide as one cell that slips by
$s$ it is $\\tfrac13 (1 - \\delta) s_u w (1 - e^{-3 s / w})$ with the slip $w = \\xi_{95} d$ = 0.1 m of cells of 50 mm: 264
J/m2.
"""

import numpy as np

from mpm_regression.row import Row

CELLS = (0.1, 0.05, 0.025)  # m
LENGTH, STRENGTH, REMOULDED, PULL, DENSITY = 3.0, 1e4, 0.2, 22.0, 1000.0
SLAB = DENSITY * LENGTH * 0.4  # kg/m
SLIP = 0.15  # m
RUNS = {f"{name}_{1000 * d:g}": f"-mesh_spacing {d}{more}" for name, more in (("constant", ""), ("scaled", " -weak_xi95_cell 0.05"))
        for d in CELLS}
PRECISIONS = ("double",)
LONG = True


def curve(run):
    """Slip of the slab, m, and dissipated work, J per metre of the band and of depth, at each row of the history."""
    bodies = ("base", "layer", "slab")
    moved = {body: run.history[f"{body}_centre_x"] - run.history[f"{body}_centre_x"][0] for body in bodies}
    masses = dict(zip(bodies, (SLAB / 4, SLAB / 4, SLAB)))
    work = PULL * sum(masses[body] * moved[body] for body in bodies) - sum(run.history[f"{body}_kinetic_energy"] for body in bodies)
    return moved["slab"], work / LENGTH


def softening_work(run):
    """Dissipated work beyond that of remoulded clay at the slip SLIP, J/m2."""
    slip, work = curve(run)
    return np.interp(SLIP, slip, work) - REMOULDED * STRENGTH * SLIP if slip[-1] >= SLIP else np.nan


def works(runs, name):
    return np.array([softening_work(runs[f"{name}_{1000 * d:g}"]) for d in CELLS])


def check(runs):
    scaled, constant = works(runs, "scaled"), works(runs, "constant")
    slip = 2 * 0.05  # m, xi95 times the cell
    exact = (1 - REMOULDED) * STRENGTH * slip / 3 * (1 - np.exp(-3 * SLIP / slip))
    for k in range(3):
        yield Row(f"work per metre of band, cells of {CELLS[k]} m, xi95_cell (J/m2)", scaled[k], exact, 0.1, "a band of one cell",
                  relative=True)
    for k in (0, 1):
        yield Row(f"cells of {CELLS[k]} m over {CELLS[2]} m", scaled[k] / scaled[2], 1, 0.1,
                  "the same clay on another mesh")
    yield Row("the same without xi95_cell, cells of 0.1 m", constant[0] / constant[2], 1.5, 0, "a control: depends on the mesh",
              at_least=True)


def draw(axes, runs):
    axes.set_axis_off()
    left, right = axes.inset_axes((0.0, 0.0, 0.5, 1.0)), axes.inset_axes((0.64, 0.0, 0.36, 1.0))
    for d, colour in zip(CELLS, ("C0", "C1", "C2")):
        for name, style in (("constant", ":"), ("scaled", "-")):
            slip, work = curve(runs[f"{name}_{1000 * d:g}"])
            left.plot(1000 * slip, work - REMOULDED * STRENGTH * slip, style, color=colour, lw=1.2,
                      label=f"{1000 * d:g} mm" if name == "scaled" else None)
    left.set(xlabel="slip (mm; dotted: constant $\\xi_{95}$)", ylabel="work beyond remoulded clay's (J/m2)", ylim=(0, None),
             xlim=(0, 1000 * SLIP))
    left.legend(title="cells")
    for name, mark, label in (("constant", "o:", "constant $\\xi_{95}$"), ("scaled", "s-", "xi95_cell")):
        right.semilogx(1000 * np.array(CELLS), works(runs, name), mark, color="k", label=label)
    right.set(xlabel="cell (mm)", ylim=(0, None), xticks=[25, 50, 100], xticklabels=["25", "50", "100"])
    right.minorticks_off()
    right.legend()
