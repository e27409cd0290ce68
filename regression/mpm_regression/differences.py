"""How far two runs of one problem are apart: the largest difference of each field of the last frame and of each column of
the history, over a scale of the field. Needs numpy and h5py.

The scale is the largest value of the field in the reference, but not less than what round-off of the others makes of it.
With the impedance Z = rho c of the stiffest body, the stress S = max(|sigma|, Z |v|) and the speed S / Z belong together:
a field that should be zero (the stress of a body that flies freely, the velocity of one at rest) differs by round-off of
these. An energy has at least the scale M (S / Z)^2 / 2, a force on a rigid S on the face of a cell, the area of a load that
face, a place (such as a centre of mass that symmetry puts at the origin) or displacement a cell.
"""

import numpy as np

from soil_mpm.results import read_frame


def stiffness(run, material, pressure, own_young=0):
    """Modulus of compression waves, and Young's or, without one, the bulk modulus of a material under a mean pressure, Pa. own_young: the
    largest of its particles, where they have their own."""
    def value(key):
        return run.number(f"{material}_{key}")

    porosity = value("porosity")
    water = run.number("water_bulk_modulus", 2.2e9) / porosity if porosity else value("pore_stiffness")
    nu, young = value("poisson"), own_young or value("young") or value("rigidity") * value("su")
    if young:
        return young * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) + water, young
    bulk = value("bulk_modulus")
    if value("kappa"):  # cam_clay
        bulk = value("specific_volume") / value("kappa") * max(pressure, 1e3)  # pressure_min is at most 1 kPa by default
    shear = value("shear_modulus") or (1.5 * bulk * (1 - 2 * nu) / (1 + nu) if run.text(f"{material}_poisson") else 0)
    wave = value("wave_modulus") or bulk + 4 / 3 * shear  # the first is a umat's
    if not wave > 0:
        raise ValueError(f"{material}: its stiffness is not known here, and without one there is no scale of stress and speed")
    return wave + water, bulk or wave


def density(run, material):
    """Density of a material, kg/m3."""
    given = run.number(f"{material}_density", 0)
    porosity, water = run.number(f"{material}_porosity", 0), run.number("water_density", 1000)
    return given or (1 - porosity) * run.number(f"{material}_grain_density") + porosity * water


def mass(run, groups):
    """Mass of all bodies, kg."""
    return sum(groups[body]["volume"].sum() * density(run, run.text(f"{body}_material"))
               for body in run.words("bodies"))


class Scales:
    """Scales of the fields of a problem, from its reference run; differences are relative to them."""

    def __init__(self, run, groups):
        fields = [groups[body] for body in run.words("bodies") if len(groups[body]["volume"]) > 0]  # a stage may place others
        pressure = max(0.0, *(float(-each["stress"][:, :3].mean(axis=1).min()) for each in fields))
        materials = {run.text(f"{body}_material") for body in run.words("bodies")}
        own = {name: max((groups[body]["young"].max() for body in run.words("bodies") if "young" in groups[body]
                          and run.text(f"{body}_material") == name), default=0) for name in materials}
        known = {name: stiffness(run, name, pressure, own[name]) for name in materials}
        z = max(np.sqrt(density(run, name) * wave) for name, (wave, _) in known.items())  # Pa s/m
        speed = max(np.abs(each["velocity"]).max() for each in fields)
        self.stress = max(z * speed, *(np.abs(each["stress"]).max() for each in fields))
        self.velocity = self.stress / z
        self.spacing = run.number("mesh_spacing")
        self.strain = self.stress / min(modulus for _, modulus in known.values())
        self.momentum = mass(run, groups) * self.velocity
        self.face = self.spacing ** (run.number("dim", 2) - 1)
        self.force = self.stress * self.face

    def of_field(self, name):
        if name.startswith("load_area"):
            return self.face
        return {"velocity": self.velocity, "grid_velocity": self.velocity, "darcy_flux": self.velocity, "stress": self.stress,
                "pore_pressure": self.stress, "excess_pore_pressure": self.stress, "plastic_strain": self.strain}.get(name, 0)

    def of_column(self, name):
        if name.endswith("kinetic_energy") or name.startswith(("energy_", "work_")):
            return self.momentum * self.velocity / 2
        if "momentum" in name:
            return self.momentum
        if "velocity" in name:
            return self.velocity
        if "force" in name:
            return self.force
        return 0 if name in ("step", "time", "dt") else self.spacing  # a body's place, a rigid's displacement


def relative(values, reference, scale):
    """Largest difference over the scale; infinite where the two do not match, or are not finite."""
    if values.shape != reference.shape:
        return np.inf
    difference = np.abs(values.astype(float) - reference).max(initial=0)
    if difference == 0:
        return 0.0
    share = difference / max(np.abs(reference).max(), scale)
    return share if np.isfinite(share) else np.inf


def columns_of(run):
    return {name: values for name, values in run.history.items() if name != "wall_time"}


def largest(run, reference):
    """The largest relative difference of a run from its reference, and where it is. Nodes of contact come and go by round-off:
    the history has what they sum to."""
    groups, wanted = read_frame(run.frame)[1], read_frame(reference.frame)[1]
    scales = Scales(reference, wanted)
    found = [(relative(groups[name][key], values, scales.of_field(key)), f"{name} {key}")
             for name, fields in wanted.items() if "contact_area" not in fields for key, values in fields.items()]
    found += [(relative(run.history[name], values, scales.of_column(name)), name)
              for name, values in columns_of(reference).items()]
    return max([(0.0, "nowhere"), *found], key=lambda each: each[0])


def differing(run, other):
    """Number of values of the last frames and of the histories whose bits differ between two runs."""
    groups, again = read_frame(run.frame)[1], read_frame(other.frame)[1]
    pairs = [(again[name][key], values) for name, fields in groups.items() for key, values in fields.items()]
    pairs += [(other.history[name], values) for name, values in columns_of(run).items()]
    return sum(int(np.sum(a != b)) if a.shape == b.shape else b.size for a, b in pairs)
