#!/usr/bin/env python3
"""mpm_regression.differences on made-up runs: the differences that it reports. Needs numpy and h5py."""

import json
import pathlib
import sys
import tempfile
import unittest

import h5py
import numpy as np

sys.dont_write_bytecode = True

from mpm_regression import differences  # noqa: E402
from soil_mpm.results import Run  # noqa: E402

OPTIONS = {"dim": "2", "mesh_spacing": "0.1", "materials": "clay", "clay_density": "100", "clay_young": "1e4",
           "clay_poisson": "0", "bodies": "soil", "soil_material": "clay", "rigid_bodies": "plate"}
FIELDS = {"position": np.full((4, 3), 2.0), "velocity": np.full((4, 3), 0.5), "stress": np.zeros((4, 6)),
          "volume": np.full(4, 0.0025)}
HISTORY = {"step": 100, "time": 0.1, "wall_time": 1, "soil_kinetic_energy": 0.3, "plate_y": -0.1, "plate_force_y": 70}
IMPEDANCE = 1000.0  # Pa s/m: rho c = sqrt(rho E), without Poisson's ratio


class Differences(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder, self.made = pathlib.Path(folder.name), 0

    def run_with(self, history=(), options=(), **fields):
        """A run that wrote FIELDS and HISTORY, but for what is given."""
        self.made += 1
        folder = self.folder / str(self.made)
        (folder / "frames").mkdir(parents=True)
        (folder / "options.json").write_text(json.dumps({"options": {**OPTIONS, **dict(options)}}))
        values = {**HISTORY, **dict(history)}
        (folder / "history.csv").write_text(",".join(values) + "\n" + ",".join(map(repr, values.values())) + "\n")
        with h5py.File(folder / "frames" / "frame_00001.h5", "w") as file:
            file.attrs["time"] = 0.1
            for name, array in {**FIELDS, **fields}.items():
                file[f"soil/{name}"] = array
            file["plate/position"] = np.ones((2, 3))
        return Run(folder)

    def apart(self, **changes):
        return differences.largest(self.run_with(**changes), self.run_with())

    def test_same(self):
        self.assertEqual(self.apart(history={"wall_time": 7}), (0, "nowhere"))
        self.assertEqual(differences.differing(self.run_with(history={"wall_time": 7}), self.run_with()), 0)

    def test_stress_of_free_flight(self):
        """No stress of its own to be held against: that of an impact at the body's speed."""
        share, where = self.apart(stress=np.full((4, 6), 1e-6 * IMPEDANCE * 0.5))
        self.assertAlmostEqual(share, 1e-6)
        self.assertEqual(where, "soil stress")

    def test_without_young(self):
        """Clay whose stiffness is that of its pressure, and a fluid: the scale is finite, and a difference is seen."""
        clay = {"clay_young": "none", "clay_kappa": "0.05", "clay_specific_volume": "2", "clay_poisson": "0.2"}
        fluid = {"clay_young": "none", "clay_bulk_modulus": "1e4", "clay_poisson": "none"}
        stress = np.tile([-2e3, -2e3, -2e3, 0, 0, 0], (4, 1)).astype(float)
        for options, wave in ((clay, 8e4 * 2), (fluid, 1e4)):  # G = 0.75 K
            scale = max(np.sqrt(100 * wave) * 0.5, 2e3)
            runs = (self.run_with(options=options, stress=each) for each in (stress + 1e-6 * scale, stress))
            share, where = differences.largest(*runs)
            self.assertAlmostEqual(share, 1e-6, delta=1e-10)
            self.assertEqual(where, "soil stress")
        with self.assertRaises(ValueError):
            differences.largest(*(self.run_with(options={"clay_young": "none"}) for _ in range(2)))

    def test_largest_value(self):
        self.assertAlmostEqual(self.apart(position=FIELDS["position"] + [0, 0, 2e-9])[0], 1e-9, delta=1e-12)

    def test_history(self):
        """A displacement against a cell, an energy against its own; a force against a stress on the face of a cell."""
        self.assertAlmostEqual(self.apart(history={"plate_y": -0.1 + 1e-7})[0], 1e-6)
        self.assertEqual(self.apart(history={"soil_kinetic_energy": 0.4})[1], "soil_kinetic_energy")
        self.assertAlmostEqual(self.apart(history={"plate_force_y": 71})[0], 1 / 70)

    def test_wrong(self):
        for changes in ({"volume": np.full(5, 0.0025)}, {"velocity": np.full((4, 3), np.nan)}, {"history": {"plate_y": np.inf}}):
            self.assertEqual(self.apart(**changes)[0], np.inf, changes)

    def test_bits(self):
        self.assertEqual(differences.differing(self.run_with(velocity=FIELDS["velocity"] + [0, 2e-16, 0]), self.run_with()), 4)
        self.assertEqual(differences.differing(self.run_with(history={"plate_force_y": np.nextafter(70, 71)}), self.run_with()), 1)


if __name__ == "__main__":
    unittest.main()
