"""Circular and square footing on clay

Weightless clay of strength $s_u$ (Tresca) carries a circular footing up to $q / s_u$ = 5.689 with a smooth base (Shield
1955) and 6.048 with a rough one (Eason & Shield 1960). A square has no exact answer; limit analysis with finite
elements bounds it by 5.52 and 6.22 with a rough base (Salgado et al. 2004). The clay is stiff, and the mean over the
second half of a settlement of 0.006 $B$ is compared. Sides and bottom are 1.25 $B$ from the footing. With `von_mises`
($\\sqrt{J_2} = s_u$) the clay is weaker outside of plane strain, down to 0.866 of the Tresca strength, so by the limit
theorems the load is between 0.866 and 1 times as large.
"""

import numpy as np

from mpm_regression.row import Row

CIRCLE = " -plate_shape cylinder -plate_centre 0,0,1.25 -plate_radius 0.5 -plate_height 0.15"
SQUARE = " -plate_shape box -plate_lower 0,0,1.25 -plate_upper 0.5,0.5,1.4"
ROUGH = " -plate_shear_limit 3000"
RUNS = {"circle_smooth": CIRCLE, "circle_rough": CIRCLE + ROUGH, "square_rough": SQUARE + ROUGH,
        "circle_von_mises": CIRCLE + ROUGH + " -clay_model von_mises"}
RUNS = {name: "-mesh_spacing 0.05" + more for name, more in RUNS.items()}
AREAS = {"circle": np.pi / 16, "square": 0.25}  # m2, of a quarter
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def curve(runs, name):
    """Settlement w/B and q/su in the middles of the intervals of the history."""
    history = runs[name].history
    w = -history["plate_z"]
    return (w[1:] + w[:-1]) / 2, history["plate_force_z"][1:] / (3000 * AREAS[name.split("_")[0]])


def factor(runs, name):
    w, q = curve(runs, name)
    return q[w > w[-1] / 2].mean()


def check(runs):
    n = {name: factor(runs, name) for name in runs}
    yield Row("q/su, smooth circle, d = B/20", n["circle_smooth"], 5.689, 0.06, "Shield (1955)", relative=True)
    yield Row("q/su, rough circle, d = B/20", n["circle_rough"], 6.048, 0.06, "Eason & Shield (1960)", relative=True)
    yield Row("q/su, rough square, d = B/20 (exact: middle of the bounds)", n["square_rough"], 5.87, 0.06,
              "bounds 5.52 and 6.22 of Salgado et al. (2004)", relative=True)
    yield Row("von Mises over Tresca, rough circle", n["circle_von_mises"] / n["circle_rough"], 0.933, 0.067, "limit theorems")


def draw(axes, runs):
    for name, colour in zip(runs, ("#0072b2", "#d55e00", "#009e73", "0.5")):
        axes.plot(*curve(runs, name), color=colour, lw=1, label=name.replace("_", ", ", 1).replace("_", " "))
    for value in (5.689, 6.048):
        axes.axhline(value, color="k", lw=0.6)
    axes.axhspan(5.52, 6.22, color="0.9", label="bounds of the square")
    axes.set(xlabel="settlement $w/B$", ylabel="$q / s_u$ (black: exact circles)", ylim=(0, 8))
    axes.legend(fontsize=8)
