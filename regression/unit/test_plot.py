#!/usr/bin/env python3
"""What scripts/results.py computes and scripts/plot draws, on a made-up footing. Needs numpy, h5py and matplotlib."""

import importlib.machinery
import importlib.util
import json
import pathlib
import sys
import tempfile
import unittest

import h5py
import numpy as np

sys.dont_write_bytecode = True
SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import results  # noqa: E402

loader = importlib.machinery.SourceFileLoader("plot", str(SCRIPTS / "plot"))
plot = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot", loader))
loader.exec_module(plot)

OPTIONS = {"dim": "2", "mesh_lower": "0,0", "mesh_upper": "3,4.5", "mesh_spacing": "0.05", "mesh_xmin": "roller",
           "materials": "clay", "clay_model": "von_mises", "clay_su": "3000", "bodies": "soil", "rigids": "plate",
           "plate_shape": "box", "plate_lower": "0,4", "plate_upper": "0.5,4.05", "plate_motion": "prescribed",
           "plate_velocity": "0,-0.1", "plate_friction": "none"}


def write_run(folder, nc, **changes):
    """A run whose footing meets a constant Nc down to 0.2 B."""
    (folder / "frames").mkdir()
    (folder / "options.json").write_text(json.dumps({"version": "0", "options": {**OPTIONS, **changes}}))
    w = np.linspace(0, 0.2, 501)
    rows = [f"{k},{-depth},{nc * 3000 * 0.5}" for k, depth in enumerate(w)]
    (folder / "history.csv").write_text("\n".join(["step,plate_y,plate_force_y"] + rows) + "\n")
    with h5py.File(folder / "frames" / "frame_00000.h5", "w") as file:
        file.attrs["time"] = 2.0
        for name, count in (("soil", 50), ("plate", 4)):
            file[f"{name}/position"] = np.random.default_rng(1).random((count, 3))
            file[f"{name}/velocity"] = np.ones((count, 3))
        file["soil/volume"] = np.full(50, 0.02)
        file["soil/plastic_strain"] = np.linspace(0, 1, 50)


class Plot(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def test_half_model_doubles_width_and_force(self):
        write_run(self.folder, nc=5.5)
        run = results.Run(self.folder)
        width, unit_force = results.footing(run, "plate")
        self.assertAlmostEqual(width, 1.0)
        self.assertAlmostEqual(unit_force, 1500.0)
        w, nc, weight = results.bearing_curve(run, "plate")
        self.assertAlmostEqual(results.mean_over(w, nc, weight), 5.5)
        centres, means = results.window_means(w, nc, weight)
        self.assertEqual(len(centres), 20)
        np.testing.assert_allclose(means, 5.5)

    def test_a_plate_off_the_symmetry_plane_is_whole(self):
        write_run(self.folder, nc=5.5, plate_lower="1,4", plate_upper="1.5,4.05")
        self.assertAlmostEqual(results.footing(results.Run(self.folder), "plate")[0], 0.5)

    def test_a_sideways_or_free_rigid_is_no_footing(self):
        write_run(self.folder, nc=5.5, plate_velocity="0.1,-0.1")
        self.assertIsNone(results.footing(results.Run(self.folder), "plate"))

    def test_reference_curves(self):
        known = ((0.1, False, 6.97), (0.05, False, 6.10), (0.025, False, 5.72), (0.025, True, 5.66))
        for spacing, fillet, mean in known:
            w, nc = results.reference_curve(spacing, fillet)
            self.assertLess(abs(results.mean_over(w, nc, np.ones(len(w))) - mean), 0.01)
        self.assertIsNone(results.reference_curve(0.07, False))

    def test_pictures(self):
        write_run(self.folder, nc=5.5)
        run = results.Run(self.folder)
        for path in (plot.draw_curves(run, []), plot.draw_field(run)):
            self.assertGreater(path.stat().st_size, 10000)

    def test_an_empty_folder_gives_no_picture(self):
        run = results.Run(self.folder)
        self.assertIsNone(plot.draw_curves(run, []))
        self.assertIsNone(plot.draw_field(run))


if __name__ == "__main__":
    unittest.main()
