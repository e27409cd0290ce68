#!/usr/bin/env python3
"""soil_mpm.plot.outlines, units and runout: outlines of rigid bodies against points inside them, units of axes,
and the run-out of slides in any direction. Needs numpy, h5py and matplotlib."""

import json
import pathlib
import sys
import tempfile
import unittest

import h5py
import numpy as np
from matplotlib.path import Path as Polygon

sys.dont_write_bytecode = True

from soil_mpm import results, runout, units  # noqa: E402
from soil_mpm.ground import raster  # noqa: E402
from soil_mpm.plot import fields as plot_fields, outlines  # noqa: E402
from soil_mpm.plot.surfaces import section_of_triangles  # noqa: E402

PLANE = {"dim": "2", "mesh_lower": "0,0", "mesh_upper": "8,6", "mesh_spacing": "0.25", "bodies": "soil", "rigid_bodies": "body"}
SPACE = {**PLANE, "dim": "3", "mesh_lower": "0,0,0", "mesh_upper": "8,5,6"}


class Folder(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def run_of(self, options, history=None, frames=()):
        """A run with options, columns of a history, and frames (time, {group: {dataset: array}})."""
        (self.folder / "frames").mkdir(exist_ok=True)
        (self.folder / "options.json").write_text(json.dumps({"version": "0", "options": options}))
        columns = history or {"time": [0.0, 1.0]}
        rows = [",".join(map(repr, map(float, row))) for row in zip(*columns.values())]
        (self.folder / "history.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
        for k, (time, groups) in enumerate(frames):
            with h5py.File(self.folder / "frames" / f"frame_{k:05d}.h5", "w") as file:
                file.attrs["time"] = time
                for name, fields in groups.items():
                    for key, values in fields.items():
                        file[f"{name}/{key}"] = values
        return results.Run(self.folder)


class Outlines(Folder):
    def check(self, options, inside, plane=(0, 1), at=None):
        """The outline holds just those points of a fine grid that are inside the shape and the mesh."""
        run = self.run_of(options)
        corners = outlines.outline(run, "body", plane, at)
        lower, upper = (np.array(run.numbers(f"mesh_{end}"))[list(plane)] for end in ("lower", "upper"))
        axes = [np.linspace(low - 1, high + 1, 173) + 0.0037 for low, high in zip(lower, upper)]
        points = np.stack(np.meshgrid(*axes), -1).reshape(-1, 2)
        expected = inside(*points.T) & (points > lower).all(axis=1) & (points < upper).all(axis=1)
        found = Polygon(corners).contains_points(points)
        self.assertGreater(expected.sum(), 100)
        self.assertLess(np.count_nonzero(found != expected), 0.004 * expected.sum() + 1, options)

    def test_boxes(self):
        box = {**PLANE, "body_lower": "2,1", "body_upper": "5,2"}
        self.check(box, lambda x, y: (x > 2) & (x < 5) & (y > 1) & (y < 2))
        c, s = np.cos(0.5), np.sin(0.5)
        along, up = (lambda x, y: c * (x - 2) + s * (y - 1)), (lambda x, y: c * (y - 1) - s * (x - 2))
        self.check({**box, "body_angle_deg": repr(float(np.degrees(0.5)))},
                   lambda x, y: (along(x, y) > 0) & (along(x, y) < 3) & (up(x, y) > 0) & (up(x, y) < 1))
        out = lambda x, low, high: np.maximum(np.maximum(low - x, x - high), 0)  # noqa: E731
        self.check({**box, "body_fillet": "0.4"}, lambda x, y: np.hypot(out(x, 2.4, 4.6), out(y, 1.4, 1.6)) < 0.4)

    def test_polygons_discs_and_planes(self):
        self.check({**PLANE, "body_shape": "polygon", "body_polygon": "1,1,7,1,1,5"}, lambda x, y: (x > 1) & (y > 1) & (2 * x + 3 * y < 17))
        disc = {**PLANE, "body_shape": "disc", "body_radius": "1.5"}
        self.check({**disc, "body_centre": "4,3"}, lambda x, y: np.hypot(x - 4, y - 3) < 1.5)
        self.check({**disc, "body_centre": "0,3"}, lambda x, y: np.hypot(x, y - 3) < 1.5)  # cut by a side of the mesh
        self.check({**PLANE, "body_shape": "half_plane", "body_point": "0,1", "body_normal": "-0.5,2"}, lambda x, y: 2 * (y - 1) < 0.5 * x)

    def test_layers(self):
        top = lambda x: np.interp(x, [0, 3, 8], [2, 4, 1])  # noqa: E731
        layer = {**PLANE, "body_shape": "layer", "body_top": "0,2,3,4,8,1", "body_base": "0.5"}
        self.check(layer, lambda x, y: (y < top(x)) & (y > 0.5))
        on_top = {**layer, "bodies": "soil", "soil_shape": "layer", "soil_base": "0,2,3,4,8,1", "soil_top": "5", "body_top": "soil"}
        self.check(on_top, lambda x, y: (y < top(x)) & (y > 0.5))
        grid = raster.Raster(np.zeros((12, 18)), -0.5, -0.5, 0.5)
        x, y = np.meshgrid(*grid.centres())
        grid.values = 1 + 0.25 * x + 0.1 * y
        raster.write_ascii(self.folder / "top.asc", grid)
        terrain = {**SPACE, "body_shape": "layer", "body_top": str(self.folder / "top.asc"), "body_base": "0.2"}
        self.check(terrain, lambda x, z: (z < 1.3 + 0.25 * x) & (z > 0.2), plane=(0, 2), at=3.0)
        self.check(terrain, lambda y, z: (z < 1.5 + 0.1 * y) & (z > 0.2), plane=(1, 2), at=2.0)

    def test_sections_of_bodies(self):
        ball = {**SPACE, "body_shape": "ball", "body_centre": "4,2,3", "body_radius": "1.5"}
        self.check(ball, lambda x, z: (x - 4) ** 2 + (z - 3) ** 2 < 1.5 ** 2 - 0.81, plane=(0, 2), at=2.9)
        pile = {**SPACE, "body_shape": "cylinder", "body_centre": "4,2,1", "body_radius": "1", "body_height": "3", "body_tip_angle_deg": "60"}
        radius = lambda z: np.minimum(np.tan(np.radians(30)) * (z - 1), 1)  # noqa: E731
        for at in (2.0, 2.5):
            self.check(pile, lambda x, z: (z > 1) & (z < 4) & ((x - 4) ** 2 + (at - 2) ** 2 < radius(z) ** 2), plane=(0, 2), at=at)  # noqa: B023
        self.check(pile, lambda x, y: np.hypot(x - 4, y - 2) < radius(2.0), plane=(0, 1), at=2.0)
        cone = {**SPACE, "body_shape": "cone", "body_centre": "4,2,5", "body_radius": "1", "body_height": "2", "body_tip": "up"}
        self.check(cone, lambda x, z: (z > 3) & (z < 5) & (np.abs(x - 4) < (5 - z) / 2), plane=(0, 2), at=2.0)
        plane = {**SPACE, "body_shape": "half_plane", "body_point": "0,0,2", "body_normal": "0.2,0.4,1"}
        self.check(plane, lambda x, z: 0.2 * x + 0.4 * 3 + z < 2, plane=(0, 2), at=3.0)
        box = {**SPACE, "body_lower": "1,1,1", "body_upper": "3,3,3"}
        self.check(box, lambda y, z: (y > 1) & (y < 3) & (z > 1) & (z < 3), plane=(1, 2), at=2.0)
        self.assertIsNone(outlines.outline(self.run_of(box), "body", (1, 2), 3.5))

    def test_what_options_do_not_tell_has_no_outline(self):
        for options in ({**SPACE, "body_shape": "stl", "body_file": "a.stl"}, {**SPACE, "body_shape": "layer", "body_top": "gone.asc", "body_base": "0"},
                        {**PLANE, "body_lower": "1,1", "body_upper": "2,2", "body_cut_out": "soil"}, PLANE):
            self.assertIsNone(outlines.outline(self.run_of(options), "body", (0, 1), 1.0), options)

    def scene(self, history, **options):
        points = np.stack(np.meshgrid(np.arange(2.125, 5, 0.25), np.arange(1.125, 2, 0.25), 0.0), -1).reshape(-1, 3)
        groups = {"soil": {"position": points + [0, 2, 0], "volume": np.full(len(points), 1 / 16)}, "body": {"position": points - [0, 0.75, 0]}}
        run = self.run_of({**PLANE, "body_motion": "prescribed", "body_lower": "2,1", "body_upper": "5,2", **options}, history, [(2.0, groups)])
        return plot_fields.Scene(run, run.frame)

    def test_parts_have_an_outline_each(self):
        points = np.stack(np.meshgrid(np.arange(2.125, 5, 0.25), np.arange(1.125, 2, 0.25), 0.0), -1).reshape(-1, 3)
        options = {**PLANE, "body_motion": "prescribed", "body_parts": "a,b", "a_shape": "box", "a_lower": "2,1", "a_upper": "3,2",
                   "b_shape": "box", "b_lower": "3,1", "b_upper": "5,2"}
        groups = {"soil": {"position": points + [0, 2, 0], "volume": np.full(len(points), 1 / 16)}, "body": {"position": points + [0.5, 0, 0]}}
        run = self.run_of(options, {"time": [0, 2], "body_x": [0, 0.5], "body_y": [0, 0]}, [(2.0, groups)])
        a, b = plot_fields.Scene(run, run.frame).outlines("body")
        np.testing.assert_allclose([a.min(axis=0), b.max(axis=0)], [[2.5, 1], [5.5, 2]])

    def test_sections_of_triangles_are_those_of_the_body(self):
        vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) + [4, 2, 3]
        triangles = np.array([[x, y, z] for x in (0, 1) for y in (2, 3) for z in (4, 5)])
        out = np.cross(vertices[triangles[:, 1]] - vertices[triangles[:, 0]], vertices[triangles[:, 2]] - vertices[triangles[:, 0]])
        inward = np.einsum("ij,ij->i", out, vertices[triangles].mean(axis=1) - [4, 2, 3]) < 0
        triangles[inward] = triangles[inward][:, ::-1]
        for axis, middle in ((0, (2, 3)), (1, (4, 3)), (2, (4, 2))):
            centre = [4, 2, 3][axis]
            for place in (centre - 0.4, centre, centre + 0.25):
                loop, = section_of_triangles(vertices, triangles, axis, place)
                np.testing.assert_allclose(np.abs(loop - middle).sum(axis=1), 1 - abs(place - centre), atol=1e-12)
                self.assertEqual(len(np.unique(loop.round(9), axis=0)), 4)
            self.assertEqual(section_of_triangles(vertices, triangles, axis, centre + 1.5), [])

    def test_an_outline_moves_with_its_body(self):
        moved = {"time": [0, 2], "body_x": [0, 0], "body_y": [0, -0.75]}
        corners = self.scene(moved).outlines("body")[0]
        np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[2, 0.25], [5, 1.25]])

    def test_a_reset_does_not_move_a_body_back(self):
        staged = {"time": [0, 1, 2], "body_x": [0, 0, 0], "body_y": [0, -0.5, -0.25], "stage": [1, 1, 2]}
        np.testing.assert_allclose(self.scene(staged, stages="a,b", a_reset="on").outlines("body")[0].min(axis=0), [2, 0.25])

    def test_where_the_particles_lie_elsewhere_they_are_drawn(self):
        self.assertIsNone(self.scene({"time": [0, 2], "body_x": [0, 1.5], "body_y": [0, -0.75]}).outlines("body"))


class Units(Folder):
    def test_forces_are_in_kilonewtons_unless_these_are_too_many_or_too_few(self):
        for largest, text, size in ((8e3, "kN", 1e3), (9e6, "kN", 1e3), (3e7, "MN", 1e6), (9e10, "GN", 1e9), (20, "N", 1), (0, "kN", 1e3)):
            self.assertEqual(units.scale([-largest, 0, np.nan], "N"), (text, size))
        self.assertEqual(units.scale([5e9], "kg/s"), ("kt/s", 1e6))
        self.assertEqual(units.scale([5e9], "m"), ("m", 1))

    def test_in_plane_strain_they_are_a_metre_of_width(self):
        plane, revolved = self.run_of(PLANE), self.run_of({**PLANE, "geometry": "axisymmetric"})
        self.assertEqual(units.axis_unit(plane, [8e3], "N")[0], "kN/m")
        self.assertEqual(units.axis_unit(plane, [8e3], "Pa")[0], "kPa")
        self.assertEqual(units.axis_unit(revolved, [8e3], "N")[0], "kN")

    def test_columns_of_the_history_have_units(self):
        for column, unit in (("plate_y", "m"), ("plate_force_y", "N"), ("soil_xq999", "m"), ("soil_zmin", "m"), ("plate_velocity_x", "m/s"),
                             ("tip_stress_xx", "Pa"), ("gate_mass_flux", "kg/s"), ("soil_lost_momentum_x", "kg m/s"), ("energy_error", "J"),
                             ("work_gravity", "J"), ("soil_kinetic_energy", "J"), ("a", ""), ("wall_xmin_force_y", "N"), ("gate_momentum_flux_x", "N")):
            self.assertEqual(units.unit_of(column), unit, column)

    def test_fields_tell_their_unit(self):
        known = plot_fields.known_fields({"su": np.array([2e3, 4e3]), "shear_rate": np.array([1.0, 2.0])}, {"su": "Pa", "shear_rate": "1/s"})
        self.assertEqual([known[name].title for name in ("su", "shear_rate")], ["su (kPa)", "shear rate (1/s)"])
        np.testing.assert_allclose(known["su"].of({"su": np.array([2e3, 4e3])}), [2, 4])


class RunOut(Folder):
    def slide(self, way, frames=True, **options):
        """Two thousand particles in 3D that move as `way` [m] in 2 s, of which one moves twice as far."""
        time, points = np.linspace(0, 2, 5), np.random.default_rng(2).uniform(0, 1, (2000, 3))
        points[0] = 0.5
        history = {"time": time, "slide_mass": np.ones(5)}
        for k, axis in enumerate("xy"):
            where = points[:, k] + np.outer(time / 2, np.where(np.arange(2000) == 0, 2, 1)) * way[k]
            history |= {f"slide_centre_{axis}": where.mean(axis=1), f"slide_{axis}min": where.min(axis=1), f"slide_{axis}max": where.max(axis=1)}
        ahead = np.append(way, 0) * np.where(np.arange(2000) == 0, 2, 1)[:, None]
        made = [(t, {"slide": {"position": points + t / 2 * ahead}}) for t in (0.0, 1.0, 2.0)] if frames else []
        return self.run_of({**SPACE, "bodies": "slide", **options}, history, made), points

    def test_along_an_axis_the_history_tells_it(self):
        run, points = self.slide((0.0, 3.0))
        direction, (toe, *_) = runout.toes(run, "slide")
        self.assertEqual(runout.direction_text(direction), "y")
        self.assertEqual(len(toe.time), 5)
        self.assertAlmostEqual(toe.way[-1], 6.5 - points[:, 1].max())

    def test_backwards_too(self):
        run, points = self.slide((-3.0, 0.0))
        direction, (toe,) = runout.toes(run, "slide")
        self.assertEqual(runout.direction_text(direction), "-x")
        self.assertAlmostEqual(toe.way[-1], 5.5 + points[:, 0].min())

    def test_across_the_mesh_frames_tell_it_along_the_motion(self):
        run, points = self.slide((3.0, 4.0))
        direction, (toe, percentile) = runout.toes(run, "slide")
        np.testing.assert_allclose(direction, [0.6, 0.8], atol=1e-3)
        start = (points[:, :2] @ direction).max()
        self.assertAlmostEqual(toe.way[-1], points[0, :2] @ direction + 10 - start, places=3)
        self.assertAlmostEqual(percentile.way[-1], 5, delta=0.05)  # one particle in two thousand does not count

    def test_without_frames_the_axis_that_is_nearest_tells_it(self):
        run, _ = self.slide((3.0, 4.0), frames=False)
        direction, _ = runout.toes(run, "slide")
        self.assertEqual(runout.direction_text(direction), "y")

    def test_a_body_that_a_stage_places_runs_out_from_there(self):
        columns = {"time": [0, 1, 2], "slide_mass": [0, 5, 5], "slide_xmax": [0, 30, 34], "slide_centre_x": [0, 20, 23]}
        run = self.run_of({**PLANE, "bodies": "slide"}, columns)
        _, (toe,) = runout.toes(run, "slide")
        np.testing.assert_allclose(toe.way, [0, 4])


if __name__ == "__main__":
    unittest.main()
