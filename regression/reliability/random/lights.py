"""Rigid bodies much lighter than the soil that they hit, roll over or stir: decks of turning.py with a hundredth to half of a layer of cells.

Beside what turning.py checks, contact must never give energy, and no body may be faster than what it came with, gravity, its moment and
the soil together can make it.
"""
import numpy as np

from deck import rounded
from mpm_regression.folders import history
from turning import SPIN, Turning

AT_WALLS = 0.1  # of the energy of the soil, whose waves at walls count as contact too


class Lights(Turning):
    def make(self):
        super().make()
        self.options += ["-output_energy", "on"]

    def body(self, name, x):
        body = {"driven": True}
        while body["driven"]:
            body = super().body(name, x)
        words, layer = body["words"], 1700 * 0.125 * 0.3 ** (self.dim - 1)  # kg, at the smallest face of a body of turning.py
        body["mass"] = round(layer * 10 ** self.draw.uniform(-2, -0.3), 6)
        unit = 0.015 * body["mass"]  # kg m2
        body["inertia"] = [unit] if self.dim == 2 else [unit, 0.9 * unit, 0.8 * unit, *(self.draw.uniform(-0.1, 0.1) * unit for _ in range(3))]
        body["moment"] = [0.01 * m / 200 * body["mass"] for m in body["moment"]]
        for option, value in (("mass", f"{body['mass']:.6f}"), ("inertia", rounded(body["inertia"])), ("moment", rounded(body["moment"]))):
            if f"-{name}_{option}" in words:
                words[words.index(f"-{name}_{option}") + 1] = value
        return body

    def check(self, folder):
        super().check(folder)
        values = history(folder)
        work, energy = values["work_contact"], values["energy_kinetic"].max()
        gained = np.diff(work).max() / (np.abs(work).max() + AT_WALLS * energy)
        self.note("energy that contact gave in an interval", gained)
        assert gained < 0.02, f"contact gives {gained:.3g} of the energy that it takes"
        for name, body in self.bodies.items():
            speed = sum(values[f"{name}_velocity_{axis}"] ** 2 for axis in self.axes) ** 0.5
            turn = sum(values[f"{name}_angular_velocity{end}"] ** 2 for end in SPIN[self.dim]) ** 0.5
            fastest = speed.max() / (speed[0] + 0.3 * turn[0] + 2)
            self.note("largest speed of a body over what it may have", fastest)
            assert fastest < 1, f"{name} reaches {speed.max():.3g} m/s"
