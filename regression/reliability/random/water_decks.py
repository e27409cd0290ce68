"""Random decks of level ground under water, at rest or under a plate, and what must hold of submerged soil.

A deck has one to three layers of different laws, drained or undrained, and a level of water anywhere. The particles begin
with the effective stresses that carry the soil above, less the water that it displaces.
"""
import dataclasses
import math

import h5py
import numpy as np

from collapse_decks import Options, order
from mpm_regression import particles

G = 9.81  # m/s2
NAMES = ("lower", "middle", "upper")  # layers from the base up
FREE = 4  # cells of the mesh above the ground
STEPS = {"rest": 150, "plate": 200}
# Bounds by precision. Of speeds over that of the waves, of pressures and stresses over the largest, at rest; of the yield
# condition over the stress; of a run over the same in a row.
STILL = {"double": 1e-11, "single": 1e-5}
PRESSURE = {"double": 1e-12, "single": 1e-6}
EXCESS = {"double": 1e-9, "single": 5e-3}
YIELD = {"double": 1e-8, "single": 1e-3}
SERIAL = {"elastic": 1e-10, "plastic": 1e-6}


# ---------------------------------------------------------------------------------------------- laws


def log_uniform(dice, least, most):
    return float(f"{math.exp(dice.uniform(math.log(least), math.log(most))):.4g}")


def elastic(dice):
    return {"young": log_uniform(dice, 2e6, 5e7), "poisson": round(dice.uniform(0.2, 0.4), 3)}


def draw_law(dice, stress):
    """Options of a material whose soil bears up to `stress` [Pa] from its weight, without the material's name."""
    model = dice.choice(["linear_elastic", "mohr_coulomb", "mohr_coulomb", "drucker_prager", "cam_clay", "tresca", "von_mises"])
    if model == "cam_clay":
        return {"model": model, "critical_state_ratio": round(dice.uniform(0.9, 1.3), 3), "lambda": round(dice.uniform(0.1, 0.25), 4),
                "kappa": round(dice.uniform(0.01, 0.04), 4), "poisson": round(dice.uniform(0.2, 0.3), 3),
                "specific_volume": round(dice.uniform(1.8, 2.5), 3), "ocr": round(dice.uniform(2, 4), 3), "pressure_min": 500}
    law = {"model": model, **elastic(dice)}
    if model in ("mohr_coulomb", "drucker_prager"):
        friction = round(dice.uniform(25, 40), 3)
        law.update(cohesion=log_uniform(dice, 100, 5000), friction_deg=friction,
                   dilation_deg=dice.choice([0, 0, round(friction * dice.uniform(0.1, 0.4), 3)]))
    if model == "drucker_prager":
        law["match"] = dice.choice(["compression", "plane_strain"])
    if model in ("tresca", "von_mises"):
        law["su"] = float(f"{stress * dice.uniform(0.4, 0.8) + 500:.4g}")  # K0 stress needs at most 0.2
    return law


def moduli(law, mean):
    """Bulk and shear modulus [Pa]; of Cam-Clay at a mean stress in compression [Pa]."""
    nu = law["poisson"]
    if law["model"] == "cam_clay":
        bulk = law["specific_volume"] / law["kappa"] * max(mean, law["pressure_min"])
        return bulk, 1.5 * bulk * (1 - 2 * nu) / (1 + nu)
    return law["young"] / (3 * (1 - 2 * nu)), law["young"] / (2 * (1 + nu))


def principal(stress):
    """Principal stresses [N, 3], the smallest first, of xx, yy, zz, xy, yz, zx."""
    full = np.zeros((len(stress), 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        full[:, i, j] = full[:, j, i] = stress[:, k]
    return np.linalg.eigvalsh(full)


def beyond_yield(law, effective, state):
    """How far effective stresses lie beyond the yield condition of a law, over a stress [N]; None where it has none, or one
    that differs from particle to particle. state: the fields of the body's frame."""
    if "su_gradient" in law:
        return None
    model, mean = law["model"], effective[:, :3].mean(axis=1)
    s = principal(effective)
    j2 = ((s - mean[:, None]) ** 2).sum(axis=1) / 2
    size = np.abs(s).max(axis=1)
    if model == "mohr_coulomb":
        sine, cosine = math.sin(math.radians(law["friction_deg"])), math.cos(math.radians(law["friction_deg"]))
        strength = 2 * law["cohesion"] * cosine
        return (s[:, 2] * (1 + sine) - s[:, 0] * (1 - sine) - strength) / (size + strength)
    if model == "drucker_prager":
        phi, psi = math.radians(law["friction_deg"]), math.radians(law["dilation_deg"])
        if law["match"] == "plane_strain":
            flow = math.sin(psi) / math.sqrt(1 + math.sin(psi) ** 2 / 3)
            divisor = math.sqrt(1 - flow**2 / 3) + math.sin(phi) * flow / 3
            slope, over = math.sin(phi) / divisor, math.cos(phi) / divisor
        else:
            divisor = math.sqrt(3) * (3 + (-1 if law["match"] == "compression" else 1) * math.sin(phi)) / 6
            slope, over = math.sin(phi) / divisor, math.cos(phi) / divisor
        return (np.sqrt(j2) + slope * mean - over * law["cohesion"]) / (size + law["cohesion"])
    if model == "cam_clay":
        pc = state["preconsolidation"].astype(float)
        return (3 * j2 / law["critical_state_ratio"] ** 2 - mean * (-mean - pc)) / pc**2
    if model == "tresca":
        return (s[:, 2] - s[:, 0] - 2 * law["su"]) / (size + law["su"])
    if model == "von_mises":
        return (np.sqrt(j2) - law["su"]) / (size + law["su"])
    return None


# ---------------------------------------------------------------------------------------------- decks


@dataclasses.dataclass
class Layer:
    name: str
    base: int  # cells above the mesh's floor
    top: int
    law: dict  # of the material, with density and pore_stiffness
    k0: float


class Ground:
    """Parts of a ground deck."""

    def __init__(self, dice, dims):
        self.dice, self.dim = dice, dice.choice(dims)
        self.kind = dice.choice(["rest", "plate", "plate"])
        self.cell = log_uniform(dice, 0.1, 1)
        self.wide = dice.randint(6, 14) if self.dim == 2 else dice.randint(4, 6)
        self.deep, self.across = (dice.randint(5, 12), 1) if self.dim == 2 else (dice.randint(4, 7), dice.randint(3, 5))
        self.per_cell = dice.choice([1, 2, 2, 3]) if self.dim == 2 else dice.choice([1, 2])
        self.level = self.height * dice.choice([dice.uniform(0, 1), dice.uniform(1, 3), round(dice.uniform(0, 1), 1)])
        self.water = dice.choice([1000.0, 1025.0])
        self.covered = dice.random() < 0.25  # soil of one density, and water above all of the mesh
        if self.covered:
            self.level = (self.deep + FREE + 1 + dice.uniform(0, 20)) * self.cell
        self.layers = self.draw_layers()
        self.time_step()

    @property
    def height(self):
        return self.deep * self.cell

    @property
    def spacing(self):
        return self.cell / self.per_cell

    def draw_layers(self):
        dice = self.dice
        count = dice.randint(1, min(3, self.deep // 2))
        cuts, common = sorted(dice.sample(range(1, self.deep), count - 1)), round(dice.uniform(1500, 2200), 1)
        layers = []
        for name, base, top in zip(NAMES, [0, *cuts], [*cuts, self.deep]):
            law = draw_law(dice, self.height * 2200 * G)
            law["density"] = common if self.covered else round(dice.uniform(1500, 2200), 1)
            if dice.random() < 0.5:
                bulk, _ = moduli(law, self.height * 1000 * G)
                law["pore_stiffness"] = float(f"{bulk * dice.uniform(3, 50):.4g}")
            layers.append(Layer(name, base, top, law, round(dice.uniform(0.6, 0.9), 3)))
        return layers

    def time_step(self):
        """The speed of the fastest wave [m/s], and how long the steps are about [s]."""
        self.wave = 0.0
        for layer in self.layers:
            bulk, shear = moduli(layer.law, self.height * 2200 * G)
            stiffness = bulk + 4 / 3 * shear + layer.law.get("pore_stiffness", 0)
            self.wave = max(self.wave, math.sqrt(stiffness / layer.law["density"]))
        self.dt = 0.4 * self.cell / self.wave

    def rows(self):
        """Heights of the rows of particles from the top down [m], their layer, and effective vertical stress [Pa]."""
        y = self.height - self.spacing * (np.arange(self.deep * self.per_cell) + 0.5)
        layer = [next(each for each in self.layers if each.base * self.cell < at < each.top * self.cell) for at in y]
        share = np.clip((self.level - y) / self.spacing + 0.5, 0, 1)
        weight = (np.array([each.law["density"] for each in layer]) - self.water * share) * G * self.spacing
        return y, layer, -(np.cumsum(weight) - weight / 2), weight.sum()

    def write(self, path):
        _, _, vertical, _ = self.rows()
        extent = [self.wide * self.cell, self.across * self.cell][:self.dim - 1]
        with h5py.File(path, "w") as file:
            for each in self.layers:
                place = particles.lattice((*[0.0] * (self.dim - 1), each.base * self.cell), (*extent, each.top * self.cell),
                                          self.spacing)
                row = np.round((self.height - place[:, -1]) / self.spacing - 0.5).astype(int)
                stress = np.zeros((len(place), 6))
                stress[:, :3] = each.k0 * vertical[row, None]
                stress[:, self.dim - 1] = vertical[row]
                group = file.create_group(each.name)
                group["position"], group["stress"] = particles.with_zeros(place), stress
                group["volume"] = np.full(len(place), self.spacing**self.dim)

    def vector(self, x, across, up):
        return (x, up) if self.dim == 2 else (x, across, up)

    def options(self):
        d, dice, axis = self.cell, self.dice, "xyz"[self.dim - 1]
        o = {"dim": self.dim, "mesh_lower": self.vector(0, 0, 0), "mesh_spacing": d,
             "mesh_upper": self.vector(self.wide * d, self.across * d, (self.deep + FREE) * d),
             f"mesh_{axis}max": "free", f"mesh_{axis}min": dice.choice(["roller", "fixed"]), "gravity": self.vector(0, 0, -G),
             "time_end": float(f"{STEPS[self.kind] * self.dt:.4g}"), "water_level": (self.level,), "water_density": self.water,
             "materials": ",".join(f"{each.name}_soil" for each in self.layers), "bodies": ",".join(each.name for each in self.layers)}
        for each in self.layers:
            o.update({f"{each.name}_soil_{key}": value for key, value in each.law.items()})
            o.update({f"{each.name}_material": f"{each.name}_soil", f"{each.name}_shape": "particles", f"{each.name}_file": "start.h5",
                      f"{each.name}_particles_per_cell": self.per_cell})
        if self.kind == "plate":
            half = dice.randint(1, max(1, self.wide // 2))
            o.update(rigid_bodies="plate", plate_shape="box", plate_lower=self.vector(0, 0, self.height), plate_motion="prescribed",
                     plate_upper=self.vector(half * d, self.across * d, self.height + 2 * d))
            speed = dice.uniform(0.02, 0.2) * d / o["time_end"]
            o["plate_velocity"] = self.vector(0, 0, -float(f"{speed:.4g}"))
            o.update(dice.choice([{}, {"plate_friction": 0.3}, {"plate_shear_limit": 1000}]))
        o.update(output_interval=o["time_end"], history_interval=o["time_end"] / 10)
        return o


def draw_method(o, dice):
    update = dice.choice(["flip", "flip", "flip", "xpic", "apic"])
    if update != "flip":
        o["velocity_update"] = update
    if dice.random() < 0.4:
        o["f_bar_fraction"] = dice.choice([0, 0.5, 0.98])
    if dice.random() < 0.3:
        o["damping"] = round(dice.uniform(0.02, 0.3), 3)


def ground_options(dice, dims):
    ground = Ground(dice, dims)
    o = ground.options()
    draw_method(o, dice)
    laws = ", ".join(f"{each.law['model']} {'undrained' if 'pore_stiffness' in each.law else 'drained'}" for each in ground.layers)
    name = f"ground, {ground.kind}, {laws}, water to {ground.level / ground.height:.2f}{' over all' if ground.covered else ''}"
    return Options(name, order(o), loaded=ground.kind == "plate", ground=ground)
