#!/usr/bin/env python3
"""soil_mpm.results, factor and runout, and the pictures of scripts/plot, on a made-up footing, pipe and slide.
Needs numpy, h5py and matplotlib."""

import json
import pathlib
import sys
import tempfile
import unittest

import h5py
import numpy as np

sys.dont_write_bytecode = True

from soil_mpm import factor, results, runout  # noqa: E402
from soil_mpm.plot import curves as plot_curves, fields as plot_fields  # noqa: E402

OPTIONS = {"dim": "2", "mesh_lower": "0,0", "mesh_upper": "3,4.5", "mesh_spacing": "0.05", "mesh_xmin": "roller",
           "materials": "clay", "clay_model": "von_mises", "clay_su": "3000", "clay_young": "1.5e6", "clay_poisson": "0.49",
           "bodies": "soil", "soil_material": "clay", "soil_shape": "box", "soil_lower": "0,0", "soil_upper": "3,4", "rigid_bodies": "plate",
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


SLIDE = {"dim": "2", "mesh_spacing": "0.25", "gravity": "0.8549978,-9.7726699", "materials": "clay", "clay_su": "2500",
         "clay_density": "600", "bodies": "slide", "slide_shape": "polygon", "rigid_bodies": "base", "base_shear_limit": "2500",
         "slide_polygon": "0,0,48.66025403784439,0,40,5,8.660254037844386,5"}


def write_slide(folder, **changes):
    """A body that moves as 2 t over its whole height H = 1 but faster above; most energy at 3 s; frames each second."""
    (folder / "frames").mkdir()
    (folder / "options.json").write_text(json.dumps({"version": "0", "options": {**SLIDE, **changes}}))
    rows = [f"{t},{48 + 2 * t},{47 + 2 * t},{9 - (t - 3) ** 2}" for t in np.linspace(0, 5, 51)]
    (folder / "history.csv").write_text("\n".join(["time,slide_xmax,slide_xq999,slide_kinetic_energy"] + rows) + "\n")
    for time in range(6):
        with h5py.File(folder / "frames" / f"frame_{time:05d}.h5", "w") as file:
            file.attrs["time"] = float(time)
            x, y = np.meshgrid(np.arange(0.125, 48, 0.25), np.arange(0.125, 1, 0.25))
            file["slide/position"] = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
            file["slide/grid_velocity"] = np.column_stack([2 + y.ravel(), 0 * x.ravel(), 0 * x.ravel()])
            file["slide/velocity"] = np.random.default_rng(time).normal(0, 9, (x.size, 3))
            file["slide/volume"] = np.full(x.size, 0.0625)
            file["slide/plastic_strain"] = np.zeros(x.size)
            file["base/position"] = np.column_stack([x[0], 0 * x[0] - 0.1, 0 * x[0]])
            file["base/velocity"] = np.zeros((len(x[0]), 3))


class Slide(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def test_the_front_advances_and_the_curve_ends_with_the_run(self):
        write_slide(self.folder)
        run = results.Run(self.folder)
        self.assertEqual(runout.slides(run), ["slide"])
        for column in ("xmax", "xq999"):
            way = runout.run_out(run, "slide", column)
            self.assertAlmostEqual(runout.at_time(run, way, 3.03), 6.06)
            self.assertTrue(np.isnan(runout.at_time(run, way, 5.2)))

    def test_a_moving_rigid_makes_it_no_slide(self):
        write_slide(self.folder, base_motion="prescribed")
        self.assertEqual(runout.slides(results.Run(self.folder)), [])

    def test_the_profile_is_the_nodes(self):
        write_slide(self.folder)
        run = results.Run(self.folder)
        self.assertEqual(run.frame_near(runout.time_of_frame(run)).name, "frame_00003.h5")
        self.assertEqual(run.frame_near(0.4).name, "frame_00000.h5")
        _, groups = results.read_frame(run.frame)
        height, velocity = runout.profile(groups["slide"], 24, 1, 1, 0.25)
        np.testing.assert_allclose(height, [0.125, 0.375, 0.625, 0.875])
        np.testing.assert_allclose(velocity, 2 + height)
        self.assertEqual(len(runout.profile(groups["slide"], 99, 1, 1, 0.25)[0]), 0)

    def test_stored_curves_belong_to_their_problem(self):
        write_slide(self.folder)
        run = results.Run(self.folder)
        curves = runout.reference_runout(run)
        self.assertAlmostEqual(np.interp(15, curves["gradient"]["time"], curves["gradient"]["toe"]), 23.864)
        self.assertAlmostEqual(np.interp(15, curves["flat"]["time"], curves["flat"]["toe"]), 22.363)
        run.options["mesh_spacing"] = "0.1"
        self.assertAlmostEqual(np.interp(4, *(runout.reference_runout(run)["gradient"][k] for k in ("time", "toe"))), 11.92)
        for name, other in (("clay_su", "2400"), ("gravity", "none"), ("slide_polygon", "0,0,48,0,40,5,8,5")):
            changed = results.Run(self.folder)
            changed.options[name] = other
            self.assertEqual(runout.reference_runout(changed), {})

    def test_pictures(self):
        write_slide(self.folder)
        run = results.Run(self.folder)
        self.assertIsNone(plot_curves.draw_curves(run, []))
        for path in (plot_curves.draw_runout(run, [run], 1.0), plot_fields.draw_velocity(run), plot_fields.draw_velocity(run, 1.0),
                     plot_fields.draw_field(run)):
            self.assertGreater(path.stat().st_size, 10000)


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

    def test_extent_of_a_turned_plate_and_of_a_half_plane(self):
        write_run(self.folder, nc=5.5, plate_lower="1,2", plate_upper="3,3", plate_angle_deg="90")
        run = results.Run(self.folder)
        np.testing.assert_allclose(results.extent(run, "plate"), (0, 1), atol=1e-12)
        run.options.update(plate_angle_deg="30")
        np.testing.assert_allclose(results.extent(run, "plate"), (0.5, 1 + np.sqrt(3)))
        run.options.update(plate_shape="half_plane")
        np.testing.assert_allclose(results.extent(run, "plate"), (0, 3))

    def test_a_sideways_or_free_rigid_is_no_footing(self):
        write_run(self.folder, nc=5.5, plate_velocity="0.1,-0.1")
        self.assertIsNone(results.footing(results.Run(self.folder), "plate"))

    def legend_with(self, rows):
        """Texts of the legend of the footing's force with so many rows of the history over 0.2 B."""
        write_run(self.folder, nc=5.5)
        run = results.Run(self.folder)
        run.history = {name: values[::500 // rows] for name, values in run.history.items()}
        axes = plot_curves.plt.figure().add_subplot()
        plot_curves.draw_pushed(axes, run, "plate", [])
        return [text for text in axes.get_legend_handles_labels()[1] if "this run" in text or "each row" in text]

    def test_a_mean_is_reported_where_a_window_holds_rows(self):
        self.assertEqual(self.legend_with(500), ["each row of the history", "this run, mean over 0.01 m of penetration (0.01 B)"])

    def test_rows_that_are_further_apart_than_a_window_have_no_mean(self):
        self.assertEqual(self.legend_with(20), ["this run, each row of the history"])

    def test_reference_curves(self):
        known = ((0.1, False, 6.97), (0.05, False, 6.10), (0.025, False, 5.72), (0.025, True, 5.66))
        for spacing, fillet, mean in known:
            w, nc = results.reference_curve(spacing, fillet)
            self.assertLess(abs(results.mean_over(w, nc, np.ones(len(w))) - mean), 0.01)
        self.assertIsNone(results.reference_curve(0.07, False))

    def test_pictures(self):
        write_run(self.folder, nc=5.5)
        run = results.Run(self.folder)
        for path in (plot_curves.draw_curves(run, [run], time=1.0), plot_fields.draw_field(run)):
            self.assertGreater(path.stat().st_size, 10000)

    def factor_with(self, **changes):
        """Factor of the plate where some options are others, and whether it is drawn without being asked for."""
        run = results.Run(self.folder)
        run.options.update(changes)
        found = factor.factor(run, "plate")
        return found, plot_curves.has_factor(run, "plate", False)

    def test_only_a_footing_on_clay_of_one_strength_has_a_factor_unasked(self):
        write_run(self.folder, nc=5.5)
        found, drawn = self.factor_with()
        self.assertTrue(drawn and found.footing and found.half)
        self.assertAlmostEqual(found.unit_force, 1500)
        self.assertAlmostEqual(found.width, 1)
        other = {"bodies": "soil,sand", "sand_shape": "box", "sand_lower": "0,0", "sand_upper": "3,1", "materials": "clay,stiff"}
        for changes in ({"clay_su_gradient": "1000"}, {"plate_shape": "disc", "plate_centre": "1,4.5", "plate_radius": "0.5"},
                        {"plate_lower": "0,3", "plate_upper": "0.5,3.05"}, {"plate_velocity": "0.1,0"},
                        {"plate_angle_deg": "10"}, {"soil_shape": "polygon", "soil_polygon": "0,0,3,0,3,2,0,4"},
                        {"clay_model": "linear_elastic"}, {"geometry": "axisymmetric"}, {"plate_motion": "fixed"},
                        {**other, "sand_material": "stiff", "stiff_model": "von_mises", "stiff_su": "9000"},
                        {**other, "sand_material": "stiff", "stiff_model": "linear_elastic"}):
            self.assertFalse(self.factor_with(**changes)[1], changes)
        self.assertTrue(self.factor_with(**other, sand_material="clay")[1])

    def test_a_factor_that_is_asked_for(self):
        write_run(self.folder, nc=5.5)
        pipe = {"plate_shape": "disc", "plate_centre": "1,4.5", "plate_radius": "0.5", "clay_su_datum": "4",
                "clay_su_gradient": "1000"}
        self.assertAlmostEqual(self.factor_with(**pipe)[0].unit_force, 3000 * 1)  # its underside is at the datum
        sideways = {**pipe, "plate_centre": "1,3", "plate_velocity": "0.1,0"}
        self.assertAlmostEqual(self.factor_with(**sideways)[0].unit_force, 4000 * 1)  # its middle is 1 m below
        self.assertIsNone(self.factor_with(**pipe, plate_velocity="0.1,-0.1")[0])
        three = {"dim": "3", "plate_velocity": "0,0,-0.1"}
        box = {**three, "plate_lower": "0,0,4", "plate_upper": "0.5,0.25,4.1"}
        self.assertAlmostEqual(self.factor_with(**box)[0].unit_force, 3000 * 0.5 * 0.25)
        ball = {**three, "plate_shape": "ball", "plate_centre": "1,1,4.5", "plate_radius": "0.5"}
        self.assertAlmostEqual(self.factor_with(**ball)[0].unit_force, 3000 * np.pi / 4)
        cut = {**ball, "mesh_lower": "1,1,0", "mesh_upper": "3,3,6"}
        self.assertAlmostEqual(self.factor_with(**cut)[0].unit_force, 3000 * np.pi / 16)  # a quarter of it
        self.assertIsNone(self.factor_with(**{**three, "plate_shape": "polygon", "plate_polygon": "0,4,1,4,0,5"})[0])

    def test_the_force_of_a_pushed_rigid_is_against_its_way(self):
        write_run(self.folder, nc=5.5)
        run = results.Run(self.folder)
        way, force, weight = plot_curves.pushed(run, "plate", factor.factor(run, "plate"))
        np.testing.assert_allclose(force, 5.5 * 1500)
        self.assertAlmostEqual(weight.sum(), 0.2)
        self.assertAlmostEqual(way[0], 0.0002)

    def test_stored_curves_are_for_their_clay(self):
        write_run(self.folder, nc=5.5)
        for changes, has in (({}, True), ({"clay_young": "3e6"}, False), ({"clay_poisson": "0.3"}, False),
                             ({"gravity": "0,-9.81"}, False)):
            run = results.Run(self.folder)
            run.options.update(changes)
            self.assertEqual(plot_curves.stored_curve(run, "plate", factor.factor(run, "plate")) is not None, has, changes)

    def test_the_force_on_a_fixed_rigid_is_drawn_in_kilonewtons_over_time(self):
        write_run(self.folder, nc=5.5, plate_motion="fixed")
        run = results.Run(self.folder)
        run.history["time"] = run.history.pop("step")
        axes = plot_curves.plt.figure().add_subplot()
        plot_curves.draw_force(axes, run, "plate", [])
        x, y = axes.lines[0].get_data()
        np.testing.assert_allclose(x, run.history["time"])
        np.testing.assert_allclose(y, 5.5 * 1.5)
        self.assertEqual(axes.get_ylabel(), "force of the soil (kN/m)")
        self.assertGreater(plot_curves.draw_curves(run, []).stat().st_size, 10000)

    def test_an_empty_folder_gives_no_picture(self):
        run = results.Run(self.folder)
        self.assertIsNone(plot_curves.draw_curves(run, []))
        self.assertIsNone(plot_curves.draw_runout(run, []))
        self.assertIsNone(plot_fields.draw_velocity(run))
        self.assertIsNone(plot_fields.draw_field(run))


if __name__ == "__main__":
    unittest.main()
