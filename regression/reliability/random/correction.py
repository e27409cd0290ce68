"""Soil that flows, whose positions are corrected.

Columns and heaps of fluid, mud, clay and sand, with random updates and domains, fall apart between smooth sides, some against a
rigid block. At every row the momentum of the soil must be what gravity and the forces on the sides have made of it, so that the
correction keeps it to round-off; no particle is in the block; mass stays. A short run on two ranks must be the same to round-off.
Elastic soil that is thrown must move as without the correction, to the bit.
"""
import dataclasses

import h5py
import numpy as np

from deck import Deck, vector
from mpm_regression.folders import frames, history, rows
from sides import check_side_forces

END = 0.3  # s
LAWS = {"fluid": "newtonian -soil_bulk_modulus 2e5 -soil_viscosity 0.1",
        "mud": "yield_stress_fluid -soil_bulk_modulus 2e5 -soil_shear_modulus 2e4 -soil_yield_stress 50 -soil_consistency 5",
        "clay": "von_mises -soil_su 300 -soil_young 3e5 -soil_poisson 0.3",
        "sand": "mohr_coulomb -soil_cohesion 0 -soil_friction_deg 30 -soil_young 3e5 -soil_poisson 0.3",
        "elastic": "linear_elastic -soil_young 3e5 -soil_poisson 0.3"}


class Correction(Deck):
    strategies = ("tile", "gather", "sequential")
    restarts, several, others = 0.5, 0.0, 0.0  # round-off grows in flows: ranks and strategies agree for a short time

    def make(self):
        draw, dim = self.draw, self.dim
        self.law = draw.choice(["fluid", *LAWS])
        elastic = self.law == "elastic"
        across = [2.0, 1.5] if dim == 2 else [2.0, 0.5, 1.5]
        filled = [draw.choice([0.6, 1.0]), *([0.5] if dim == 3 else []), draw.choice([0.7, 1.0, 1.13])]
        self.gravity = np.array([0.0 if elastic else draw.uniform(-2, 2), *([0.0] * (dim - 2)), -9.81])
        self.plain = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(across)} -mesh_spacing 0.125 -materials soil "
                      f"-soil_model {LAWS[self.law]} -soil_density 1500 -bodies heap -heap_material soil -heap_shape box "
                      f"-heap_lower {vector([0] * dim)} -heap_upper {vector(filled)} -gravity {vector(self.gravity)} -mesh_{self.up}max free "
                      f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -particle_domain {draw.choice(['fixed', 'stretch', 'split'])} "
                      f"-history_interval 0.01 -output_interval 0.1 -time_end {END}").split()
        for axis in self.axes:
            for side in ("min", "max")[:1 if axis == self.up else 2]:
                self.plain += [f"-mesh_{axis}{side}", "friction", f"-mesh_{axis}{side}_friction", "0"]
        self.block = not elastic and draw.random() < 0.3
        if self.block:
            lower, upper = [1.25, *([0.0] if dim == 3 else []), 0.0], [1.5, *([0.5] if dim == 3 else []), 0.25]
            self.plain += (f"-rigid_bodies block -block_shape box -block_lower {vector(lower)} -block_upper {vector(upper)} "
                           "-block_motion fixed").split()
        self.options = [*self.plain, "-position_correction", "delta", "-position_correction_rate", draw.choice(["5", "20", "60"])]

    def check(self, folder):
        values = history(folder)
        kept, lost = values["heap_mass"], values["heap_lost_mass"]
        assert np.abs(kept + lost - kept[0]).max() < 1e-5 * kept[0], "mass is missing"
        if self.block:
            self.check_block(folder)
        else:
            check_side_forces(folder, self.gravity, "heap", self.bound(1e-10, 1e-4))

    def check_block(self, folder):
        """The block's corners count as rounded, and nodes stop soil a part of a cell late."""
        for path in frames(folder):
            with h5py.File(path) as file:
                place = file["heap/position"][()]
            deep = (place[:, 0] > 1.25 + 0.06) & (place[:, 0] < 1.5 - 0.06) & (place[:, self.dim - 1] < 0.25 - 0.06)
            assert not deep.any(), f"{deep.sum()} particles are in the block in {path.name}"

    def compare(self, whole):
        if self.law == "elastic":
            self.check_elastic(whole)
        if self.draw.random() < 0.3:
            self.check_ranks()

    def check_ranks(self):
        """A few rebuilds, before round-off grows: the history of two ranks and of one."""
        pair = dataclasses.replace(self.machine, ranks=2)
        a, b = (history(self.go(name, "-time_end", "0.1", machine=machine)) for name, machine in (("one", self.machine), ("two", pair)))
        assert len(a["time"]) == len(b["time"]), "other rows on two ranks"
        for name in ("heap_centre_x", "heap_kinetic_energy", "heap_corrected_energy"):
            scale = np.abs(a["heap_kinetic_energy"]).max() if "energy" in name else 1.0
            error = np.abs(a[name] - b[name]).max() / scale
            assert error < self.bound(1e-8, 2e-3), f"{name} differs by {error:.3g} on two ranks"

    def check_elastic(self, whole):
        """Soil that the correction leaves alone goes on to the same bits."""
        none = self.go("none", "-rebuild_margin", "0.45", options=self.plain)
        lines, plain = rows(whole), rows(none)
        kept = [k for k, name in enumerate(lines[0]) if name in plain[0]]
        assert [[line[k] for k in kept] for line in lines] == plain, "elastic soil moves otherwise than without the correction"
