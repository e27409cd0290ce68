"""A quarter of a cylinder in 3D and its section

A cylinder of elastic soil on a fixed base, 1 m in radius $R$ and height, as a quarter in 3D between two planes of symmetry
(`-soil_fill cut`) and as a body of revolution in section (`-geometry axisymmetric`), on meshes of the same spacing $d$. *Weight*: it
stands under its own weight. *Pressure*: 10 kPa on its top; settlements are per load, because the area of the top in 3D is that of
whole faces of particles. *Footing*: a circular plate of radius $a = R/2$ that is bonded to the top goes down by 0.2 mm; its load is that of the base.

The two meshes approach one solution, each with an error of first order. Particles at the curved face reach beyond it by
$d/4$, a half particle, at most, which adds $d/2R$ to the section of the cylinder: the settlement may differ by this share. Contact acts at nodes within half
a cell of the plate, so the radius at which it acts is uncertain by $d/2$, and the load, which is proportional to this radius, by $d/2a$.
The table allows a tenth of the first bound and half of the second, and asks that the differences fall with at least the power 0.7 of $d$.
"""

import numpy as np

from mpm_regression.curves import first_frame, last_frame
from mpm_regression.row import Row

MESHES = {
    "section": " -dim 2 -geometry axisymmetric -mesh_lower 0,0 -mesh_upper 1.2,1.2 -mesh_ymin fixed -mesh_ymax free"
               " -soil_shape box -soil_lower 0,0 -soil_upper 1,1",
    "quarter": " -dim 3 -mesh_lower 0,0,0 -mesh_upper 1.2,1.2,1.2 -mesh_ymin roller -mesh_ymax free -mesh_zmin fixed -mesh_zmax free"
               " -soil_shape cylinder -soil_centre 0,0,0 -soil_radius 1 -soil_height 1 -soil_fill cut",
}
TOP = " -loads top -top_body soil -top_pressure 1e4"
PLATE = (" -rigid_bodies plate -plate_motion prescribed -plate_separation none -plate_shear_limit 1e9"
         " -plate_displacement_table_interpolation smooth -plate_displacement_table ")
LOADS = {
    ("weight", "section"): " -gravity 0,-9.81",
    ("weight", "quarter"): " -gravity 0,0,-9.81",
    ("pressure", "section"): " -gravity 0,0 -top_lower 0,0.9 -top_upper 1.2,1.1 -top_facing 0,1" + TOP,
    ("pressure", "quarter"): " -gravity 0,0,0 -top_lower 0,0,0.9 -top_upper 1.2,1.2,1.1 -top_facing 0,0,1" + TOP,
    ("footing", "section"): " -gravity 0,0 -plate_shape box -plate_lower -0.5,1 -plate_upper 0.5,1.2" + PLATE + "0:0:0,0.04:0:-2e-4,1:0:-2e-4",
    ("footing", "quarter"): " -gravity 0,0,0 -plate_shape cylinder -plate_centre 0,0,1 -plate_radius 0.5 -plate_height 0.2" + PLATE
                            + "0:0:0:0,0.04:0:0:-2e-4,1:0:0:-2e-4",
}
SPACINGS = {"weight": (0.2, 0.1), "pressure": (0.2, 0.1), "footing": (0.2, 0.1, 0.05)}  # m
RUNS = {f"{load}_{mesh}_{d:g}": f"-mesh_spacing {d}" + MESHES[mesh] + options
        for (load, mesh), options in LOADS.items() for d in SPACINGS[load]}
LONG = True


def base_force(run, mesh):
    """Force on the base of the whole cylinder, N."""
    return run.history["wall_ymin_force_y"][-1] if mesh == "section" else 4 * run.history["wall_zmin_force_z"][-1]


def settlement(run, mesh):
    """Mean over the volume, m."""
    start, end = first_frame(run, "soil"), last_frame(run, "soil")
    up = 1 if mesh == "section" else 2
    return np.average((start["position"] - end["position"])[:, up], weights=start["volume"])


def answer(runs, load, mesh, d):
    run = runs[f"{load}_{mesh}_{d:g}"]
    if load == "footing":
        return base_force(run, mesh)
    if load == "weight":
        return settlement(run, mesh)
    return settlement(run, mesh) / -base_force(run, mesh)


def check(runs):
    weight = np.pi * 2000 * 9.81
    for mesh in MESHES:
        yield Row(f"weight, {mesh}, d = 0.1 m: reaction of the base over the weight", -base_force(runs[f"weight_{mesh}_0.1"], mesh) / weight, 1, 1e-4,
                  "equilibrium", single=1e-3)
    names = {"weight": "settlement", "pressure": "settlement per load", "footing": "load"}
    for load, name in names.items():
        differences = {d: answer(runs, load, "quarter", d) / answer(runs, load, "section", d) - 1 for d in SPACINGS[load]}
        for d, difference in differences.items():
            allowed = 0.5 * d / (2 * 0.5) if load == "footing" else 0.1 * d / 2
            yield Row(f"{load}: {name} in 3D over that of the section, d = {d:g} m", 1 + difference, 1, allowed, "the same body")
        first, last = SPACINGS[load][0], SPACINGS[load][-1]
        order = np.log(abs(differences[first] / differences[last])) / np.log(first / last)
        yield Row(f"{load}: order of the difference", order, 0.7, 0, "convergence", at_least=True)


def draw(axes, runs):
    for load, colour in zip(SPACINGS, ("#0072b2", "#d55e00", "#009e73")):
        d = np.array(SPACINGS[load])
        ratio = np.array([answer(runs, load, "quarter", each) / answer(runs, load, "section", each) for each in d])
        axes.loglog(d, np.abs(ratio - 1), "o-", color=colour, label=load)
        axes.loglog(d, d / (2 * 0.5) if load == "footing" else d / 2, ":", color=colour)
    axes.set(xlabel="$d$ (m)", ylabel="difference of 3D and section (dotted: bounds)")
    axes.legend()
