#!/usr/bin/env python3
"""Pictures of scripts/plot of probes, rasters and lines, on made-up results. Needs numpy, h5py, scipy and matplotlib."""

import json
import pathlib
import sys
import tempfile
import unittest
import unittest.mock

import h5py
import numpy as np

sys.dont_write_bytecode = True

from soil_mpm import results  # noqa: E402
from soil_mpm.ground import raster  # noqa: E402
from soil_mpm.plot import fields as plot_fields, probes as plot_probes, profiles as plot_profiles  # noqa: E402

OPTIONS = {"dim": "2", "mesh_lower": "0,0", "mesh_upper": "4,2", "mesh_spacing": "0.25", "bodies": "soil", "probes": "toe,gate",
           "toe_kind": "gauge", "gate_kind": "section"}


class Probes(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)
        self.addCleanup(self.place.cleanup)

    def write(self, dim=2, **changes):
        """A run with two probes and a frame whose stress and velocity are linear."""
        (self.folder / "options.json").write_text(json.dumps({"version": "0", "options": {**OPTIONS, "dim": str(dim), **changes}}))
        names = ["time", "toe_depth", "toe_speed", "toe_mean_velocity_x", "toe_mean_velocity_y", "gate_mass_flux", "gate_mass"]
        rows = [",".join(f"{t * (k + 1):.6g}" for k in range(len(names))) for t in np.linspace(0, 1, 11)]
        (self.folder / "history.csv").write_text("\n".join([",".join(names)] + rows) + "\n")
        (self.folder / "frames").mkdir()
        with h5py.File(self.folder / "frames" / "frame_00000.h5", "w") as file:
            file.attrs["time"] = 0.5
            axis = np.arange(0.0625, 2, 0.125)
            x = np.stack(np.meshgrid(*[axis] * dim), axis=-1).reshape(-1, dim)
            position = np.zeros((len(x), 3))
            position[:, :dim] = x
            file["soil/position"] = position
            file["soil/velocity"] = file["soil/grid_velocity"] = np.column_stack([3 + 2 * x[:, 0], 0 * x[:, 0], 0 * x[:, 0]])
            file["soil/volume"] = np.full(len(x), 0.125 ** dim)
            file["soil/stress"] = np.outer(-1e3 * (1 + x[:, 0] - 0.5 * x[:, 1]), [1, 1, 1, 0, 0, 0])
            file["soil/plastic_strain"] = np.zeros(len(x))
        return results.Run(self.folder)

    def test_probes_are_drawn_with_their_columns(self):
        run = self.write()
        self.assertEqual(plot_probes.columns_of(run, "toe", ["speed", "mean_velocity_{axis}"]),
                         ["speed", "mean_velocity_x", "mean_velocity_y"])
        axes = plot_probes.plt.figure().add_subplot()
        plot_probes.draw_probe(axes, run, [], "toe", plot_probes.PANELS["gauge"][0], None)
        np.testing.assert_allclose(axes.lines[0].get_ydata(), 2 * np.linspace(0, 1, 11))
        self.assertGreater(plot_probes.draw_probes(run, [run], 0.5).stat().st_size, 10000)

    def test_a_run_without_probes_or_rasters_has_no_picture(self):
        run = self.write(probes="none")
        self.assertIsNone(plot_probes.draw_probes(run, []))
        self.assertIsNone(plot_probes.draw_rasters(run))

    def test_rasters_along_x(self):
        run = self.write()
        (self.folder / "rasters.csv").write_text("x,max_depth,max_speed,arrival_time,final_depth\n0.5,1,2,0.1,0.5\n1.5,0,0,nan,0\n")
        self.assertTrue(np.isnan(plot_probes.read_profile(self.folder / "rasters.csv")["arrival_time"][1]))
        self.assertGreater(plot_probes.draw_rasters(run).stat().st_size, 10000)

    def test_maps_on_a_terrain(self):
        run = self.write(dim=3, raster_threshold_depth="0.5", raster_origin="700,90,0")
        values = np.zeros((4, 5))
        values[1, 2] = 2
        for name in plot_probes.RASTERS:
            raster.write_ascii(self.folder / f"raster_{name}.asc", raster.Raster(values, 700, 90, 0.5))
        raster.write_ascii(self.folder / "top.asc", raster.Raster(np.add.outer(np.arange(6.0), np.arange(7.0)), -0.5, -0.5, 0.5))
        rasters = {name: raster.read_ascii(self.folder / f"raster_{name}.asc") for name in plot_probes.RASTERS}
        self.assertEqual(plot_probes.seen_part("max_speed", rasters, 0.5).count(), 1)
        plain = plot_probes.draw_rasters(run).stat().st_size
        shaded = plot_probes.draw_rasters(run, self.folder / "top.asc").stat().st_size
        self.assertGreater(plain, 10000)
        self.assertNotEqual(plain, shaded)

    def test_contours_have_the_heights_of_the_site(self):
        run = self.write(dim=3, raster_origin="700,90,380")
        for name in plot_probes.RASTERS:
            raster.write_ascii(self.folder / f"raster_{name}.asc", raster.Raster(np.ones((4, 5)), 700, 90, 0.5))
        raster.write_ascii(self.folder / "top.asc", raster.Raster(np.add.outer(np.arange(6.0), np.arange(7.0)), -0.5, -0.5, 0.5))
        with unittest.mock.patch.object(plot_probes, "shade") as shade:
            plot_probes.draw_rasters(run, self.folder / "top.asc")
        terrain = shade.call_args.args[1]
        self.assertEqual((terrain.x, terrain.y), (699.5, 89.5))
        self.assertEqual((terrain.values.min(), terrain.values.max()), (380, 391))

    def test_contours_are_those_of_the_window(self):
        hill = raster.Raster(np.add.outer(np.zeros(40), 10.0 * np.arange(40)), 0, 0, 10)  # 0 to 390 m over 400 m
        axes = plot_probes.plt.figure().add_subplot()
        plot_probes.shade(axes, hill, (100, 200, 50, 250))
        seen = plot_probes.cut_to(hill, (100, 200, 50, 250))
        self.assertEqual(seen.extent, (90, 210, 40, 260))
        self.assertEqual((seen.values.min(), seen.values.max()), (90, 200))
        labels = [text for text in axes.texts if text.get_visible()]
        self.assertGreater(len(labels), 3)
        for label in labels:
            x, y = label.get_position()
            self.assertTrue(100 < x < 200 and 50 < y < 250)
            self.assertAlmostEqual(float(label.get_text().removesuffix(" m")), x - 5, delta=1)
        self.assertIs(plot_probes.cut_to(hill, (900, 950, 0, 50)), hill)

    def test_linear_fields_are_exact_along_a_line(self):
        for dim in (2, 3):
            with self.subTest(dim=dim):
                self.setUp()
                run = self.write(dim=dim)
                ends = [[0.3, 0.4, 0.6][:dim], [3.5, 1.1, 0.9][:dim]]
                line = plot_profiles.parse_line(":".join(",".join(map(str, end)) for end in ends))
                _, profiles = plot_profiles.along_line(run, run.frames[0], line, ["grid_velocity", "pressure"])
                points = line[0] + np.linspace(0, 1, plot_profiles.POINTS)[:, None] * (line[1] - line[0])
                speed, pressure = profiles["grid_velocity"][1], profiles["pressure"][1]
                inside = points[:, 0] < 2
                np.testing.assert_allclose(speed[inside], 3 + 2 * points[inside, 0], rtol=1e-9)
                np.testing.assert_allclose(pressure[inside], 1 + points[inside, 0] - 0.5 * points[inside, 1], rtol=1e-9)
                self.assertTrue(np.isnan(speed[points[:, 0] > 2.2]).all())
                paths = plot_profiles.draw_line(run, line)
                self.assertEqual([path.name for path in paths], ["profiles.png", "profiles.csv"])

    def test_a_line_that_is_none_is_refused(self):
        for text in ("1,2", "1,2:1,2", "1:2", "1,2:3,4,5", "a,b:c,d"):
            self.assertRaises(ValueError, plot_profiles.parse_line, text)
        run = self.write()
        self.assertRaises(plot_fields.NothingToDraw, plot_profiles.draw_line, run, plot_profiles.parse_line("0,0:1,1"), ["heat"])
        self.assertRaises(plot_fields.NothingToDraw, plot_profiles.draw_line, run, plot_profiles.parse_line("0,0,0:1,1,1"))


if __name__ == "__main__":
    unittest.main()
