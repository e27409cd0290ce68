"""T-bar in clay that softens and that strengthens with the rate

A rough T-bar far below the surface moves by half a diameter through clay. Without softening and rate it carries $N s_u D$
with $N$ = 11.94 (Randolph & Houlsby 1984). No exact value is known with them, but bounds are. With softening to $\\delta
s_u$ and no rate the factor is between $\\delta N$ and $N$; it falls as the bar moves. With the rate and no softening it is
between $N$ and $N R$, where $R = 1 + \\mu \\log_{10} (\\dot\\gamma / \\dot\\gamma_{ref})$ of the largest rate. A bar that is
four times as fast strengthens all the clay that is faster than $\\dot\\gamma_{ref}$ by $\\mu s_u \\log_{10} 4$, and
therefore carries about $N \\mu \\log_{10} 4$ more. The walls are 3 D from the bar; the mechanism reaches about 1.5 D.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import read_frame

STRENGTH, EXACT = 3000.0, 4 * np.sqrt(2) + 2 * np.pi
REMOULDED, FACTOR, REFERENCE = 0.3, 0.1, 0.01
RATE = f"-clay_rate_factor {FACTOR} -clay_rate_reference {REFERENCE} -clay_rate_time 0.005"
SLOW = " -bar_velocity 0.125,0 -time_end 1.6 -history_interval 0.008"
RUNS = {"ideal": "-time_end 0.4", "soft": f"-clay_remoulded_ratio {REMOULDED} -clay_xi95 2",
        "fast": f"{RATE} -time_end 0.4", "slow": RATE + SLOW}
BACKENDS, PRECISIONS = ("openmp", "cuda"), ("double",)
LONG = True


def curve(run):
    """Displacement over D, and the factor of the whole bar, in the middle of each interval of the history."""
    x = run.history["bar_x"]
    return (x[1:] + x[:-1]) / 2, -2 * run.history["bar_force_x"][1:] / STRENGTH


def factor(run, begin=0.1, end=0.2):
    x, n = curve(run)
    return n[(x > begin) & (x < end)].mean()


def largest_rate(run):
    """Largest smoothed rate of shear in the clay, 1/s, of all frames; the first moments, when waves run, are left out."""
    return max(read_frame(path)[1]["soil"]["shear_rate"].max() for path in run.frames[1:])


def check(runs):
    ideal, fast, slow = (factor(runs[name]) for name in ("ideal", "fast", "slow"))
    yield Row("N without softening and rate", ideal, EXACT, 0.05, "Randolph & Houlsby (1984)", relative=True)
    end = factor(runs["soft"], 0.4, 0.5)
    yield Row("softening: N at 0.4 to 0.5 D over N without", end / ideal, (1 + REMOULDED) / 2, (1 - REMOULDED) / 2, "bounds: delta to 1")
    yield Row("softening: N at 0.1 to 0.2 D over N at 0.4 to 0.5 D", factor(runs["soft"]) / end, 1, 0, "it softens", at_least=True)
    for name, value in (("0.5", fast), ("0.125", slow)):
        run = runs["fast" if name == "0.5" else "slow"]
        most = 1 + FACTOR * np.log10(largest_rate(run) / REFERENCE)
        yield Row(f"rate, {name} D/s: N over N without", value / ideal, (1 + most) / 2, (most - 1) / 2, "bounds: 1 to R of the largest rate")
    yield Row("growth of N from 0.125 to 0.5 D/s over N mu log 4", (fast - slow) / (ideal * FACTOR * np.log10(4)), 1, 0.2,
              "the same growth of su everywhere")


def draw(axes, runs):
    for name, label in (("ideal", "no softening, no rate"), ("soft", "softening"), ("fast", "rate, 0.5 D/s"), ("slow", "rate, 0.125 D/s")):
        x, n = curve(runs[name])
        axes.plot(*(np.convolve(each, np.ones(15) / 15, "valid") for each in (x, n)), lw=1, label=label)
    axes.axhline(EXACT, color="k", ls="--", lw=0.8, label="exact without")
    axes.set(xlabel="displacement over D", ylabel="$N$, mean of 15 rows", xlim=(0, 0.5), ylim=(0, 20))
    axes.legend(ncols=2)
