"""Bodies cut by planes of symmetry

A side of the mesh, a `roller`, cuts a rigid body to a half, or two sides cut it to a quarter. The force on this part is a
half or a quarter of the force on the whole body: a pipe pushed into clay in plane strain, and in 3D a ball, and a pile with
a conical tip of 60 degrees that is driven from the depth of its tip. The pipe and the pile are limited in shear, once by a
fraction of the clay's strength, which grows with depth for the pile. The check compares the means of the force over the
second half of the movement; with mirror walls, the force on a half is half of the force on the whole body to round-off.

A plunger that is wider than the mesh, a cylinder cut by all four sides, compresses elastic soil in one dimension: its force
is $M A w / H$, with the constrained modulus $M$, the area $A$ of the mesh and the shortening $w / H$. It is damped, and the
mean over the last tenth is compared.
"""

from mpm_regression.row import Row

SPACE = ("-dim 3 -mesh_spacing 0.125 -mesh_upper 1,1,1 -soil_upper 1,1,0 -pipe_velocity 0,0,-0.4 -time_end 0.1 "
         "-history_interval 0.001 -output_interval 0.1 ")
WHOLE, QUARTER = ("-mesh_lower {0},{0},-1 -soil_lower {0},{0},-1 ".format(x) for x in (-1, 0))
BALL = SPACE + "-pipe_shape ball -pipe_centre 0,0,0.5 -pipe_radius 0.5 "
PILE = SPACE + ("-pipe_shape cylinder -pipe_centre 0,0,-0.5 -pipe_radius 0.25 -pipe_height 1.5 -pipe_tip_angle_deg 60 "
                "-soil_cut_out pipe -clay_su_gradient 3000 -pipe_shear_fraction 0.5 ")
AREA, HEIGHT, YOUNG = 0.25, 1.0, 1e6
RUNS = {
    "pipe": "-pipe_shear_fraction 0.5",
    "half_pipe": "-mesh_lower 0,-1.5 -soil_lower 0,-1.5 -pipe_shear_limit 1500",
    "ball": BALL + WHOLE, "quarter_ball": BALL + QUARTER,
    "pile": PILE + WHOLE, "quarter_pile": PILE + QUARTER,
    "plunger": SPACE + "-mesh_lower 0,0,-1 -mesh_upper 0.5,0.5,0.5 -soil_lower 0,0,-1 -soil_upper 0.5,0.5,0 "
               "-pipe_shape cylinder -pipe_centre 0,0,0 -pipe_radius 2 -pipe_height 0.5 -pipe_velocity 0,0,-0.02 "
               "-time_end 0.5 -clay_poisson 0 -clay_su 1e9 -damping 0.1",
}


def force(run):
    """Mean vertical force over the second half of the run, N."""
    values = run.columns("pipe_force_")[1:, -1]
    return values[len(values) // 2:].mean()


def check(runs):
    for part, whole, share in (("half_pipe", "pipe", 2), ("quarter_ball", "ball", 4), ("quarter_pile", "pile", 4)):
        yield Row(f"force on the {part.replace('_', ' ')} x {share}, over the whole's", share * force(runs[part]) / force(runs[whole]),
                  1, 1e-9, "symmetry", single=1e-3)
    pile = runs["pile"].columns("pipe_force_")
    yield Row("largest force across the pile over that along it", abs(pile[:, :2]).max() / abs(pile[:, 2]).max(), 0, 1e-9, "symmetry",
              single=1e-3)
    run = runs["plunger"]
    last = slice(-len(run.history["time"]) // 10, None)
    exact = YOUNG * AREA * (-run.history["pipe_z"][last] + 0.02 * 0.001 / 2).mean() / HEIGHT
    yield Row("force on the plunger, N", run.history["pipe_force_z"][last].mean(), exact, 0.02, "elasticity", relative=True)


def draw(axes, runs):
    for name, share in (("pipe", 1), ("half_pipe", 2)):
        run = runs[name]
        axes.plot(-run.history["pipe_y"][1:], share * run.history["pipe_force_y"][1:] / 1e3, lw=1, label=f"{name}, x {share}")
    axes.set(xlabel="penetration (m)", ylabel="force (kN/m)")
    axes.legend()
