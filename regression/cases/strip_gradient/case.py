"""Strip footing on clay whose strength grows with depth

$s_u = s_{u0} + k z$. The limit load per width $q$ depends on $k B / s_{u0}$ and on the base, which is smooth or rough
(shear limit $s_{u0}$, the strength of the clay that touches it). The exact values are those of the problem of Davis &
Booker (1973), from slip lines that were converged to four digits. The clay is stiff (E = 5000 $s_{u0}$), and the
penetration 0.01 $B$, over which $q$ is a straight line: its value at zero penetration, by least squares over
0.004-0.010 $B$, is compared. `tresca` has the strength of `von_mises` in plane strain, and must give the same.
"""

import numpy as np

from mpm_regression.row import Row
from soil_mpm.results import bearing_curve

EXACT = {("smooth", 2): 6.661, ("smooth", 6): 8.839, ("smooth", 20): 14.678,
         ("rough", 2): 7.597, ("rough", 6): 10.421, ("rough", 20): 17.402}
RUNS = {f"{base}_{growth}": f"-clay_su_gradient {3000 * growth}" + (" -plate_shear_limit 3000" if base == "rough" else "")
        for base, growth in EXACT}
TRESCA = 6
RUNS |= {f"{base}_tresca": RUNS[f"{base}_{TRESCA}"] + " -clay_model tresca" for base in ("smooth", "rough")}
LONG = True


def line(run):
    """Slope and value at zero penetration of q/su0 over w/B."""
    w, q, _ = bearing_curve(run, "plate")
    inside = (w > 0.004) & (w < 0.01)
    return np.polyfit(w[inside], q[inside], 1)


def check(runs):
    for (base, growth), exact in EXACT.items():
        yield Row(f"q/su0, {base}, k B/su0 = {growth}", line(runs[f"{base}_{growth}"])[1], exact, 0.03,
                  "slip lines; problem of Davis & Booker (1973)", relative=True)
    for base in ("smooth", "rough"):
        yield Row(f"q/su0, {base}, k B/su0 = {TRESCA}, Tresca", line(runs[f"{base}_tresca"])[1], EXACT[base, TRESCA], 0.03,
                  "slip lines; problem of Davis & Booker (1973)", relative=True)


def draw(axes, runs):
    for base, colour in (("smooth", "#0072b2"), ("rough", "#d55e00")):
        for growth, style in ((2, "-"), (6, "--"), (20, ":")):
            w, q, _ = bearing_curve(runs[f"{base}_{growth}"], "plate")
            axes.plot(w, q, style, color=colour, lw=1, label=f"{base}, k B/su0 = {growth}")
            axes.plot([0.004, 0.01], [EXACT[base, growth]] * 2, "k-", lw=0.8)
    axes.set(xlabel="penetration $w/B$", ylabel="$q / s_{u0}$ (black: exact)", ylim=(0, 22), xlim=(0, 0.01))
    axes.legend(ncols=2, fontsize=8)
