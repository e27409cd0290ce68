"""Fluid between two fixed plates

Fluid between plates at $y = \\pm h$, $h$ = 0.5 m, starts from rest under a body force $G$ of 100 N/m3 along the plates and comes to a
steady flow with the shear stress $\\tau = G |y|$. A Newtonian fluid flows with $u = G (h^2 - y^2) / 2 \\eta$. A fluid that yields at
$\\tau_y$ and then has $\\tau = \\tau_y + k \\dot\\gamma^n$ has a plug of half the width $y_0 = \\tau_y / G$ and the velocity
$\\frac{n}{n+1} (G/k)^{1/n} (h - y_0)^{1 + 1/n}$ in the plug; the rate of flow is $2 u (h - \\frac{n}{2n+1} (h - y_0))$. The mesh has no
periodic sides: the fluid is a strip of 10 m with free ends, and its middle metre is measured. The velocity is that of the nodes.
"""

import numpy as np

from mpm_regression.curves import last_frame, trapezoid
from mpm_regression.row import Row

G, H, K = 100.0, 0.5, 10.0
LONG = True
YIELDS = "-fluid_model yield_stress_fluid -fluid_shear_modulus 2e4 -fluid_yield_stress 20 -fluid_consistency 10 -fluid_tension on"
LAWS = {"newtonian": (0.0, 1.0, 0.02), "Bingham": (20.0, 1.0, 0.03), "Herschel-Bulkley": (20.0, 0.5, 0.03)}  # yield stress, n, tolerance
RUNS = {"newtonian": "-fluid_model newtonian -fluid_viscosity 10 -time_end 0.5", "Bingham": YIELDS + " -time_end 0.8",
        "Herschel-Bulkley": YIELDS + " -fluid_exponent 0.5 -time_end 1.2"}


def profile(run):
    """Heights from the middle of the channel, m, velocity along it, m/s, and shear stress, Pa: means over the middle metre."""
    frame = last_frame(run, "strip")
    x, y = frame["position"][:, 0], frame["position"][:, 1] - H
    middle = np.abs(x - np.median(x)) < 0.5
    rows = np.floor((y + H) / (run.number("mesh_spacing") / 2)).astype(int)
    inside = [middle & (rows == row) for row in np.unique(rows[middle])]
    return (np.array([field[row].mean() for row in inside]) for field in (y, frame["grid_velocity"][:, 0], frame["stress"][:, 3]))


def exact(law):
    """Half the width of the plug, velocity there, rate of flow."""
    strength, n, _ = LAWS[law]
    plug = strength / G
    velocity = n / (n + 1) * (G / K) ** (1 / n) * (H - plug) ** (1 + 1 / n)
    return plug, velocity, 2 * velocity * (H - n / (2 * n + 1) * (H - plug))


def plug_of(y, stress, strength):
    """Half the distance between the heights at which the shear stress passes the yield stress on both sides."""
    return (np.interp(strength, -stress, y) - np.interp(-strength, -stress, y)) / 2


def check(runs):
    for law, (strength, _, tolerance) in LAWS.items():
        y, velocity, stress = profile(runs[law])
        plug, fastest, flow = exact(law)
        yield Row(f"largest velocity, {law} (m/s)", velocity.max(), fastest, tolerance, "steady flow", relative=True)
        through = np.trapezoid(np.r_[0, velocity, 0], np.r_[-H, y, H]) if hasattr(np, "trapezoid") else \
            trapezoid(np.r_[0, velocity, 0], np.r_[-H, y, H])
        yield Row(f"rate of flow, {law} (m2/s)", through, flow, tolerance, "steady flow", relative=True)
        if strength > 0:
            yield Row(f"half the width of the plug, {law} (m)", plug_of(y, stress, strength), plug, tolerance, "equilibrium",
                      relative=True)


def draw(axes, runs):
    heights = np.linspace(0, H, 101)
    for law, (_, n, _) in LAWS.items():
        y, velocity, _ = profile(runs[law])
        axes.plot(velocity, y, ".", ms=4, label=law)
        plug, fastest, _ = exact(law)
        right = fastest * (1 - (np.maximum(heights - plug, 0) / (H - plug)) ** (1 + 1 / n))
        axes.plot(np.r_[right[::-1], right], np.r_[-heights[::-1], heights], "k--", lw=0.8)
    axes.set(xlabel="velocity (m/s; dashed: exact)", ylabel="height from the middle (m)")
    axes.legend()
