"""Oblique waves at an absorbing side

A packet of plane waves comes obliquely to an absorbing side and is reflected as pressure and shear waves. Dashpots do not absorb an oblique
wave completely; how much energy they return follows from the balance of tractions on the side (Lysmer & Kuhlemeyer 1969), with
$\\sigma_{yy} = a \\rho c_p v_y$ and $\\sigma_{xy} = a \\rho c_s v_x$. The packet is a sum of waves of one wave number along the side, so that the exact
answer is the mean of those of its waves. The angle is that between the direction of the middle wave and the normal of the side.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import first_frame, last_frame
from mpm_regression.row import Row

LONG = True
HEIGHT = 64.0  # m
DENSITY, POISSON, FAST = 2000.0, 0.25, 100.0  # kg/m3, -, m/s
SLOW = FAST * np.sqrt((1 - 2 * POISSON) / (2 - 2 * POISSON))
SHEAR = DENSITY * SLOW**2
LAME = DENSITY * FAST**2 - 2 * SHEAR
SPREAD, MIDDLE, PEAK = 7.0, 28.0, 0.01  # standard deviation and height of the packet (m), its largest velocity (m/s)
# Kind, angle, factor of the dashpots, width of the mesh (one wave length along x) and cell (m).
WAVES = {"P_30": ("P", 30, 1.0, 12.0, 0.25), "P_60": ("P", 60, 1.0, 6.0, 0.25), "S_20": ("S", 20, 1.0, 12.0, 0.25),
         "S_20_fine": ("S", 20, 1.0, 12.0, 0.125), "P_45": ("P", 45, 1.0, 12.0, 0.25), "S_45": ("S", 45, 1.0, 12.0, 0.25),
         "P_45_half": ("P", 45, 0.5, 12.0, 0.25)}


def speed_of(kind):
    return FAST if kind == "P" else SLOW


def options(kind, degrees, factor, width, cell):
    end = 2 * MIDDLE / (speed_of(kind) * np.cos(np.radians(degrees)))
    return f"-soil_file {{start}} -mesh_upper {width},{HEIGHT} -mesh_spacing {cell} -mesh_ymin_dashpot_factor {factor} -time_end {end:.6g} -output_interval {end:.6g} -history_interval {end / 50:.6g}"


RUNS = {name: options(*wave) for name, wave in WAVES.items()}


def polarization(kind, kx, ky):
    """Unit vectors [..., 2] of the displacement of waves."""
    along = np.stack(np.broadcast_arrays(kx, ky), axis=-1) / np.sqrt(kx**2 + ky**2)[..., None]
    return along if kind == "P" else np.stack([along[..., 1], -along[..., 0]], axis=-1)


def stresses(kx, ky, p):
    """xx, yy and xy [3, ...] of waves of displacement p exp(i k x), over i."""
    spread = LAME * (kx * p[..., 0] + ky * p[..., 1])
    return np.stack([spread + 2 * SHEAR * kx * p[..., 0], spread + 2 * SHEAR * ky * p[..., 1], SHEAR * (kx * p[..., 1] + ky * p[..., 0])])


def packet(kind, degrees, width):
    """Wave numbers along (one) and across the side, angular frequencies and amplitudes of the waves of a packet."""
    kx = 2 * np.pi / width
    middle = -kx / np.tan(np.radians(degrees))
    ky = middle + np.arange(-80, 81) * 2 * np.pi / (4 * HEIGHT)
    ky = ky[(abs(ky - middle) < 5 / SPREAD) & (ky < 0)]
    amplitude = np.exp(-((ky - middle) * SPREAD) ** 2 / 2)
    return kx, ky, speed_of(kind) * np.hypot(kx, ky), amplitude


def returned(kind, degrees, factor, width):
    """Share of the energy of a packet that the side returns."""
    kx, ky, omega, amplitude = packet(kind, degrees, width)

    def traction(of, across):
        """Tractions of a wave of unit displacement and its dashpots, which must vanish in the sum: normal and tangential."""
        p = polarization(of, kx + 0 * across, across)
        stress = stresses(kx, across, p)
        return np.array([stress[1] + omega * factor * DENSITY * FAST * p[..., 1], stress[2] + omega * factor * DENSITY * SLOW * p[..., 0]])

    energy = np.zeros(len(ky))
    across = {of: np.sqrt((omega / speed_of(of)) ** 2 - kx**2 + 0j) for of in "PS"}
    system = np.stack([traction("P", across["P"]), traction("S", across["S"])], axis=1)  # [equation, wave, member]
    answer = np.linalg.solve(np.moveaxis(system, -1, 0), -traction(kind, ky + 0j).T[..., None])[..., 0]
    for n, of in enumerate("PS"):
        energy += abs(answer[:, n]) ** 2 * speed_of(of) ** 2 * across[of].real / (speed_of(kind) ** 2 * abs(ky))
    weight = (amplitude * omega) ** 2
    return (weight * energy).sum() / weight.sum()


def prepare(run, path, options):
    kind, degrees, _, width, cell = WAVES[run]
    kx, ky, omega, amplitude = packet(kind, degrees, width)
    position = particles.lattice((0, 0), (width, HEIGHT), cell / 2)
    p = polarization(kind, kx + 0 * ky, ky)
    heights, of_particle = np.unique(position[:, 1], return_inverse=True)
    phases = np.exp(1j * np.outer(heights - MIDDLE, ky)) * amplitude
    along = np.exp(1j * kx * position[:, 0])

    def field(values):
        return (along * (phases @ values)[of_particle]).real

    velocity = np.stack([field(-1j * omega * p[:, d]) for d in range(2)], axis=1)
    scale = PEAK / abs(velocity).max()
    xx, yy, xy = (scale * field(1j * values) for values in stresses(kx, ky, p))
    stress = np.stack([xx, yy, POISSON * (xx + yy), xy, 0 * xx, 0 * xx], axis=1)
    particles.write(path, "soil", position, cell / 2, velocity=scale * velocity, stress=stress)


def energy_of(frame):
    """Kinetic and elastic energy of the soil, J/m."""
    stress = frame["stress"]
    young = SHEAR * 2 * (1 + POISSON)
    normal, shear = stress[:, :3], stress[:, 3]
    elastic = ((1 + POISSON) * (normal**2).sum(1) - POISSON * normal.sum(1) ** 2) / (2 * young) + shear**2 / (2 * SHEAR)
    return (frame["volume"] * (DENSITY * (frame["velocity"] ** 2).sum(1) / 2 + elastic)).sum()


def check(runs):
    errors = {}
    for name, (kind, degrees, factor, width, cell) in WAVES.items():
        share = energy_of(last_frame(runs[name], "soil")) / energy_of(first_frame(runs[name], "soil"))
        row = Row(f"energy returned, {kind} wave at {degrees} degrees, a = {factor:g}, d = {cell:g} m", share, returned(kind, degrees, factor, width), 0.005,
                  "balance of tractions")
        if name == "S_20":
            row.shortfall, row.bound = "The wave has 16 cells over its length.", 0.007
        errors[name] = row.error()
        yield row
    yield Row("order of the error with the cell", np.log2(errors["S_20"] / errors["S_20_fine"]), 2, 0.3, "consistency of GIMP", at_least=True)


def draw(axes, runs):
    angles = np.linspace(5, 80, 300)
    for kind in "PS":
        axes.plot(angles, [returned(kind, angle, 1.0, 1.0) for angle in angles], label=f"one {kind} wave, exact")
    packets = [wave for wave in WAVES.values() if wave[2] == 1]
    axes.plot([wave[1] for wave in packets], [returned(*wave[:4]) for wave in packets], "ko", mfc="none", label="packet, exact")
    labels = {0.25: "packet, computed", 0.125: "packet, computed, half the cell"}
    for name, (_, degrees, factor, _, cell) in WAVES.items():
        if factor == 1:
            share = energy_of(last_frame(runs[name], "soil")) / energy_of(first_frame(runs[name], "soil"))
            axes.plot(degrees, share, "kx" if cell == 0.25 else "k+", label=labels.pop(cell, None))
    axes.set(xlabel="angle to the normal of the side (degrees)", ylabel="energy returned", yscale="log")
    axes.legend()
