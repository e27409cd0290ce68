"""Undrained loading of laws of effective stress

`oedometer`: elastic soil, $E'$ = 10 MPa, $\\nu'$ = 0.3, pore water of $K_p$ = 200 MPa, between rollers. Water takes the share
$K_p/(K_p + M')$ of the vertical stress, and $B = K_p/(K_p + K')$ of the mean stress (Skempton 1954), in every particle at any
time, however it shakes.

`mohr_coulomb`, `cam_clay`: unconfined compression in plane strain of a sample that begins free of total stress, with a
suction $u_e = -p_0$ and an effective stress $p_0$. Without a change of volume, Mohr-Coulomb with $\\psi = 0$ keeps
$(\\sigma_1 + \\sigma_3)/2$ and yields at a shear stress $p_0 \\sin\\varphi + c\\cos\\varphi$. Normally consolidated Cam-Clay
comes to the critical state $q = M p_0 2^{-\\Lambda}$, where in plane strain $\\sigma_1 - \\sigma_3 = 2q/\\sqrt{3}$.
`total` is the same sample under water of 200 kPa: its strength must be the same.

In 3D (`_3D`) the compression is triaxial. Mohr-Coulomb keeps its mean effective stress $p_0$, so that with $k = (1 +
\\sin\\varphi)/(1 - \\sin\\varphi)$ it yields at $q = (k - 1)(3 p_0 - 2 c\\sqrt k)/(k + 2) + 2 c\\sqrt k$; Cam-Clay comes to
$q = M p_0 2^{-\\Lambda}$.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row
from soil_mpm.results import read_frame

P0, PHI, COHESION = 100e3, 30.0, 5e3  # Pa, deg, Pa
M, LAMBDA, KAPPA = 1.0, 0.2, 0.04
PORE, YOUNG, POISSON = 200e6, 10e6, 0.3
SIZE, SPACING, SPEED = 1.0, 0.25, 0.05  # m, m, m/s
PLATE = f" -plate_lower 0,{SIZE} -plate_upper 3,{SIZE + 1} -plate_velocity 0,-{SPEED}"
SAMPLE = PLATE + " -block_shape particles -block_file {start} -damping 0.1"
ELASTIC = f" -soil_young {YOUNG:g} -soil_poisson {POISSON}"
MC = (f" -soil_model mohr_coulomb{ELASTIC} -soil_cohesion {COHESION:g} -soil_friction_deg {PHI:g} -soil_pore_stiffness 2e9"
      " -time_end 0.6 -output_interval 0.02")
CC = (f" -soil_model cam_clay -soil_critical_state_ratio {M:g} -soil_lambda {LAMBDA:g} -soil_kappa {KAPPA:g}"
      " -soil_specific_volume 2 -soil_ocr 1 -soil_poisson 0.25 -soil_pore_stiffness 1e9 -time_end 2.1 -output_interval 0.06")
SIDES_3D = " -dim 3 -mesh_lower 0,0,0 -mesh_ymin roller -mesh_zmin roller -mesh_zmax free"
PLATE_3D = (f" -plate_lower 0,0,{SIZE} -plate_upper 3,3,{SIZE + 1} -plate_velocity 0,0,-{SPEED}" + SIDES_3D +
            " -mesh_upper 3,3,3 -mesh_ymax free -block_shape particles -block_file {start} -damping 0.1")
RUNS = {"oedometer": f"-mesh_upper {SIZE:g},3 -mesh_xmax roller -block_shape box -block_lower 0,0 -block_upper {SIZE:g},{SIZE:g}"
                     f" -plate_lower 0,{SIZE} -plate_upper {SIZE:g},{SIZE + 1} -plate_velocity 0,-{SPEED} -time_end 0.1"
                     f" -f_bar_fraction 0 -soil_model linear_elastic{ELASTIC} -soil_pore_stiffness {PORE:g}",
        "mohr_coulomb": SAMPLE + MC, "total": SAMPLE + MC + " -gravity 0,-1e-3 -water_level 2e5",
        "cam_clay": SAMPLE + CC, "mohr_coulomb_3D": PLATE_3D + MC, "cam_clay_3D": PLATE_3D + CC,
        "total_3D": PLATE_3D + MC + " -gravity 0,0,-1e-3 -water_level 2e5",
        "oedometer_3D": f"-mesh_xmax roller -mesh_ymax roller -block_shape box -block_lower 0,0,0 -f_bar_fraction 0{SIDES_3D}"
                        f" -mesh_upper {SIZE:g},{SIZE:g},3 -block_upper {SIZE:g},{SIZE:g},{SIZE:g} -plate_lower 0,0,{SIZE} -time_end 0.1"
                        f" -plate_upper {SIZE:g},{SIZE:g},{SIZE + 1} -plate_velocity 0,0,-{SPEED} -soil_model linear_elastic{ELASTIC}"
                        f" -soil_pore_stiffness {PORE:g}"}


def prepare(run, path, options):
    if run.startswith("oedometer"):
        return
    dim = 3 if run.endswith("3D") else 2
    place = particles.lattice([0] * dim, [SIZE] * dim, SPACING)
    stress = np.zeros((len(place), 6))
    stress[:, :3] = -P0
    particles.write(path, "block", place, SPACING, stress=stress, excess_pore_pressure=np.full(len(place), -P0))


def deviator(run, share=0.25):
    """Mean of sigma_1 - sigma_3 in plane strain, of q in 3D [Pa], over the block and over the last frames."""
    def size(s):
        if run.number("dim", 2) == 2:
            return np.hypot(s[:, 0] - s[:, 1], 2 * s[:, 3])
        off = s[:, :3] - s[:, :3].mean(axis=1, keepdims=True)
        return np.sqrt(1.5 * (off**2).sum(axis=1) + 3 * (s[:, 3:] ** 2).sum(axis=1))

    chosen = [read_frame(path)[1]["block"]["stress"] for path in run.frames]
    chosen = chosen[-max(2, round(share * len(chosen))):]
    return np.mean([size(s).mean() for s in chosen])


def check(runs):
    modulus = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
    bulk = YOUNG / (3 * (1 - 2 * POISSON))
    for name, up, words in (("oedometer", 1, ""), ("oedometer_3D", 2, ", 3D")):
        block = last_frame(runs[name], "block")
        stress, excess = block["stress"], block["excess_pore_pressure"]
        yield Row(f"largest error of the share of the water in the vertical stress{words}",
                  np.abs(-excess / stress[:, up] - PORE / (PORE + modulus)).max(), 0, 1e-9, "K_p/(K_p + M')", single=1e-3)
        yield Row(f"largest error of B{words}", np.abs(-3 * excess / stress[:, :3].sum(axis=1) - PORE / (PORE + bulk)).max(), 0, 1e-9,
                  "K_p/(K_p + K')", single=1e-3)
    phi = np.radians(PHI)
    strength = P0 * np.sin(phi) + COHESION * np.cos(phi)
    for name in ("mohr_coulomb", "total"):
        yield Row(f"undrained strength over p0 sin(phi) + c cos(phi), {name}", deviator(runs[name]) / 2 / strength, 1, 0.01,
                  "no change of volume, psi = 0", relative=True)
    critical = 2 / np.sqrt(3) * M * P0 * 0.5 ** (1 - KAPPA / LAMBDA)
    yield Row("strength of normally consolidated Cam-Clay over 2/sqrt(3) M p0 2^-L", deviator(runs["cam_clay"]) / critical, 1, 0.02,
              "critical state at constant volume", relative=True)
    k = (1 + np.sin(phi)) / (1 - np.sin(phi))
    cohesive = 2 * COHESION * np.sqrt(k)
    triaxial = (k - 1) * (3 * P0 - cohesive) / (k + 2) + cohesive
    for name in ("mohr_coulomb_3D", "total_3D"):
        yield Row(f"undrained triaxial strength over that at the mean stress p0, {name}", deviator(runs[name]) / triaxial, 1, 0.01,
                  "no change of volume, psi = 0", relative=True)
    yield Row("triaxial strength of normally consolidated Cam-Clay over M p0 2^-L",
              deviator(runs["cam_clay_3D"]) / (M * P0 * 0.5 ** (1 - KAPPA / LAMBDA)), 1, 0.02, "critical state at constant volume",
              relative=True)
