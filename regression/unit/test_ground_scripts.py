#!/usr/bin/env python3
"""scripts/terrain and scripts/random_field: rasters before and after, and fields against what was asked. Needs numpy, scipy,
h5py and matplotlib; the tests of GeoTIFF need rasterio and are left out without it."""

import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

sys.dont_write_bytecode = True

from soil_mpm.ensemble import Ensemble  # noqa: E402
from soil_mpm.ground import fields, raster  # noqa: E402
from soil_mpm.plot.ensembles import draw_curves  # noqa: E402

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"

HAS_RASTERIO = importlib.util.find_spec("rasterio") is not None


def load(script):
    """A script as a module."""
    spec = importlib.util.spec_from_loader(script, importlib.machinery.SourceFileLoader(script, str(SCRIPTS / script)))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(script, *words):
    return subprocess.run([sys.executable, str(SCRIPTS / script), *map(str, words)], capture_output=True, text=True)


class Folder(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def refused(self, done, *parts):
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)


class Terrain(Folder):
    def plane(self, rows=20, columns=30, cell=2.0, x=1000.0, y=500.0):
        grid = raster.Raster(np.zeros((rows, columns)), x, y, cell)
        u, v = np.meshgrid(*grid.centres())
        grid.values = 100 + 0.1 * (u - x) + 0.2 * (v - y)
        return grid

    def write(self, grid, name="in.asc"):
        raster.write_ascii(self.folder / name, grid)
        return self.folder / name

    def convert(self, source, *words):
        out = self.folder / "out.asc"
        done = run("terrain", source, out, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return raster.read_ascii(out), json.loads((self.folder / "out.json").read_text())

    def test_a_raster_keeps_its_values_and_takes_a_local_origin(self):
        grid = self.plane()
        grid.values[3, 4] = np.nan
        got, site = self.convert(self.write(grid), "--lower", 50)
        self.assertEqual((got.x, got.y, got.cell), (0, 0, 2))
        self.assertEqual(site["origin"], [1000, 500, 50])
        np.testing.assert_allclose(got.values, grid.values - 50, atol=1e-6)
        got, _ = self.convert(self.write(grid), "--origin", "keep")
        self.assertEqual((got.x, got.y), (1000, 500))
        got, _ = self.convert(self.write(grid), "--origin", "990,505")
        self.assertEqual((got.x, got.y), (10, -5))

    def test_clipping_keeps_the_cells_in_the_box(self):
        got, site = self.convert(self.write(self.plane()), "--clip", "1009.9,504,1030,521")
        self.assertEqual(got.values.shape, (9, 10))
        self.assertEqual(site["origin"][:2], [1010, 504])
        self.assertAlmostEqual(got.values[0, 0], 100 + 0.1 * 11 + 0.2 * 5)
        self.refused(run("terrain", self.folder / "in.asc", self.folder / "x.asc", "--clip", "0,0,1,1"),
                     "--clip: takes a box that holds cells of the raster")

    def test_other_cells_keep_a_plane_and_the_mean(self):
        grid = self.plane()
        for cell in (0.5, 1.3, 4, 5):
            got, _ = self.convert(self.write(grid), "--cell", cell)
            u, v = np.meshgrid(*got.centres())
            inner = (slice(1, -1), slice(1, -1)) if cell >= 2 else (slice(4, -4), slice(4, -4))
            np.testing.assert_allclose(got.values[inner], (100 + 0.1 * u + 0.2 * v)[inner], atol=1e-6)
        rough = raster.Raster(np.random.default_rng(1).normal(size=(20, 30)), 0, 0, 2)
        got, _ = self.convert(self.write(rough), "--cell", 10)
        self.assertAlmostEqual(got.values.mean(), rough.values.mean(), places=6)

    def test_holes_are_filled_from_around(self):
        grid = self.plane()
        whole = grid.values.copy()
        grid.values[5:9, 6:12] = np.nan
        got, _ = self.convert(self.write(grid), "--fill")
        np.testing.assert_allclose(got.values, whole, atol=1e-6)
        grid.values[:, :3] = np.nan  # at the rim: the nearest
        got, _ = self.convert(self.write(grid), "--fill")
        self.assertFalse(np.isnan(got.values).any())
        np.testing.assert_allclose(got.values[2:-2, 0], whole[2:-2, 3], atol=0.5)

    def test_a_release_is_a_paraboloid_under_the_terrain(self):
        terrain = self.write(self.plane(80, 80, 1.0, 0.0, 0.0))
        done = run("terrain", "release", terrain, self.folder / "base.asc", "--centre", "40,35", "--radii", "20,10",
                   "--azimuth", 30, "--depth", 6)
        self.assertEqual(done.returncode, 0, done.stderr)
        base = raster.read_ascii(self.folder / "base.asc")
        depth = raster.read_ascii(terrain).values - base.values
        self.assertAlmostEqual(depth.sum() / (np.pi / 2 * 20 * 10 * 6), 1, delta=0.01)
        self.assertEqual(depth.min(), 0)
        self.refused(run("terrain", "release", terrain, self.folder / "b.asc", "--centre", "400,35", "--radii", "20,10",
                         "--depth", 6), "--centre: takes an ellipse")

    def release(self, terrain, area, *words):
        done = run("terrain", "release", terrain, self.folder / "base.asc", "--polygon", area, *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return raster.read_ascii(terrain).values - raster.read_ascii(self.folder / "base.asc").values

    def test_a_release_of_polygons_is_as_deep_as_given_within_its_rim(self):
        terrain = self.write(self.plane(80, 80, 1.0, 0.0, 0.0))
        (self.folder / "area.csv").write_text("x,y\n510,720\n550,720\n550,750\n510,750\n")
        (self.folder / "in.json").write_text(json.dumps({"origin": [500, 700, 0]}))
        depth = self.release(terrain, self.folder / "area.csv", "--depth", 5, "--rim", 10)
        self.assertEqual((depth.min(), round(depth.max(), 6)), (0, 5))
        self.assertAlmostEqual(depth[20, 30], 5 * 0.05, places=5)  # 0.5 m from the rim at y = 20
        self.assertAlmostEqual(depth[35, 30], 5, places=5)
        self.assertEqual(depth[:20].any() or depth[50:].any() or depth[:, :10].any() or depth[:, 50:].any(), False)
        # A frustum of a hip roof: the rim of 40 x 30 m, the top of 20 x 10 m, 5 m deep.
        self.assertAlmostEqual(depth.sum() / (5 / 6 * (40 * 30 + 60 * 40 + 20 * 10)), 1, delta=2e-3)
        rings = [[[10, 20], [50, 20], [50, 50], [10, 50], [10, 20]], [[25, 30], [35, 30], [35, 40], [25, 40], [25, 30]]]
        (self.folder / "hole.geojson").write_text(json.dumps(
            {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": {"type": "Polygon", "coordinates": rings}}]}))
        hole = self.release(terrain, self.folder / "hole.geojson", "--depth", 5, "--rim", 1e-6, "--local")
        self.assertAlmostEqual(hole.sum(), 5 * (40 * 30 - 100), places=3)

    def test_a_release_tells_where_its_polygons_are_not(self):
        terrain = self.write(self.plane(80, 80, 1.0, 0.0, 0.0))
        (self.folder / "area.csv").write_text("510,720\n550,720\n550,750\n")
        refused = lambda *words: self.refused(run("terrain", "release", terrain, self.folder / "b.asc", *words), "takes")  # noqa: E731
        refused("--polygon", self.folder / "area.csv", "--depth", 5)
        (self.folder / "line.csv").write_text("510,720\n550,720\n")
        refused("--polygon", self.folder / "line.csv", "--depth", 5)
        (self.folder / "bad.geojson").write_text("{}")
        refused("--polygon", self.folder / "bad.geojson", "--depth", 5)
        both = run("terrain", "release", terrain, self.folder / "b.asc", "--polygon", "a", "--centre", "1,1", "--depth", 5)
        self.assertIn("--centre has no place beside --polygon", both.stderr)

    def test_rasters_of_the_site_keep_the_prj_of_the_source(self):
        source = self.write(self.plane())
        (self.folder / "in.prj").write_text("PROJCS[...]")
        _, site = self.convert(source)
        self.assertEqual(site["prj"], "PROJCS[...]")
        self.assertFalse((self.folder / "out.prj").exists())  # its origin is shifted
        self.convert(source, "--origin", "keep")
        self.assertEqual((self.folder / "out.prj").read_text(), "PROJCS[...]")
        done = run("terrain", "release", self.folder / "out.asc", self.folder / "base.asc", "--centre", "1030,520", "--radii",
                   "9,9", "--depth", 2)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "base.prj").read_text(), "PROJCS[...]")

    def test_the_sample_of_matplotlib_is_in_metres(self):
        done = run("terrain", "jacksboro", self.folder / "out.asc")
        if "sample data" in done.stderr:
            self.skipTest("this matplotlib has no sample data")
        got = raster.read_ascii(self.folder / "out.asc")
        self.assertAlmostEqual(got.cell, 6371008.8 * np.radians(1 / 1200) * np.cos(np.radians(36.589583)), places=2)
        self.assertAlmostEqual(got.extent[3] / (344 * 92.66), 1, delta=0.003)
        self.assertGreater(np.nanmax(got.values), 1000)

    def test_a_bad_file_is_reported_in_one_line(self):
        self.refused(run("terrain", self.folder / "none.asc", self.folder / "o.asc"), "none.asc: takes a file that is there")
        (self.folder / "bad.asc").write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n")
        self.refused(run("terrain", self.folder / "bad.asc", self.folder / "o.asc"), "takes 2 x 2 values")
        (self.folder / "bad.tif").write_text("no raster")
        self.refused(run("terrain", self.folder / "bad.tif", self.folder / "o.asc"),
                     "that rasterio can read" if HAS_RASTERIO else "takes the Python package rasterio")

    def test_a_depth_on_the_terrain_has_the_volume_of_the_particles(self):
        import h5py
        terrain = self.write(self.plane(20, 20, 1.0, 0.0, 0.0), "t.asc")
        (self.folder / "t.json").write_text(json.dumps({"origin": [500, 700, 380], "prj": "PROJCS[...]"}))
        (self.folder / "frames").mkdir()
        (self.folder / "history.csv").write_text("time\n0\n")
        options = {"dim": "3", "bodies": "slide", "mesh_lower": "0,0,90", "mesh_upper": "20,20,120", "mesh_spacing": "1"}
        (self.folder / "options.json").write_text(json.dumps({"version": "0", "options": options}))
        random = np.random.default_rng(2)
        for k, low in enumerate((2, 8)):
            with h5py.File(self.folder / "frames" / f"frame_{k:05d}.h5", "w") as file:
                file.attrs["time"] = float(k)
                file["slide/position"] = low + 6 * random.random((4000, 3))
                file["slide/volume"] = np.full(4000, 0.02)
        done = run("plot_terrain", self.folder, terrain, "--write", "--cell", 1)
        self.assertEqual(done.returncode, 0, done.stderr)
        depth = raster.read_ascii(self.folder / "depth.asc")
        self.assertEqual((depth.x, depth.y), (500, 700))
        self.assertEqual((self.folder / "depth.prj").read_text(), "PROJCS[...]")
        self.assertAlmostEqual(depth.values.sum(), 80, places=4)
        self.assertEqual(depth.values[:8].sum(), 0)
        self.assertTrue((self.folder / "terrain.png").stat().st_size > 0)
        script = load("plot_terrain")
        words = ["plot_terrain", str(self.folder), str(terrain)]
        with unittest.mock.patch.object(script, "shade") as shade, unittest.mock.patch.object(sys, "argv", words):
            with contextlib.redirect_stdout(io.StringIO()):
                script.main()
        axes, drawn, _ = shade.call_args.args
        self.assertEqual((axes.get_xlim(), axes.get_ylim()), ((500, 520), (700, 720)))  # of the site, and its heights too
        self.assertEqual((drawn.x, drawn.y), (500, 700))
        np.testing.assert_allclose(drawn.values, self.plane(20, 20, 1.0, 0.0, 0.0).values + 380)
        self.refused(run("plot_terrain", self.folder, terrain, "--body", "mud"), "--body: takes a body of the run")

    @unittest.skipUnless(HAS_RASTERIO, "no rasterio")
    def test_geotiff_in_metres_and_in_degrees(self):
        import rasterio
        grid = self.plane()
        grid.values[2, 3] = np.nan
        profile = {"driver": "GTiff", "height": 20, "width": 30, "count": 1, "dtype": "float32", "nodata": -32768}
        values = np.where(np.isnan(grid.values), -32768, grid.values)[::-1].astype("float32")
        with rasterio.open(self.folder / "m.tif", "w", crs="EPSG:32616", transform=rasterio.Affine(2, 0, 1000, 0, -2, 540),
                           **profile) as file:
            file.write(values, 1)
        got, site = self.convert(self.folder / "m.tif")
        np.testing.assert_allclose(got.values, grid.values, atol=1e-4)
        self.assertEqual((site["origin"], site["crs"]), ([1000, 500, 0], "EPSG:32616"))
        step = 1 / 1200
        with rasterio.open(self.folder / "d.tif", "w", crs="EPSG:4326", transform=rasterio.Affine(step, 0, -84.4, 0, -step, 36.7),
                           **profile) as file:
            file.write(np.full((20, 30), 250, "float32"), 1)
        got, site = self.convert(self.folder / "d.tif")
        self.assertEqual(site["crs"], "EPSG:32616")
        self.assertTrue(75 < got.cell < 95, got.cell)
        self.assertEqual(np.nanmin(got.values), 250)
        self.refused(run("terrain", self.folder / "d.tif", self.folder / "o.asc", "--band", 2), "a band of at most 1")


class Fields(Folder):
    def moments(self, kind, lognormal=False, nu=1.5, count=1500):
        """Mean, deviation and correlations at lags of (2, 0), (0, 1), (3, 2) points, over an ensemble; of the logarithm where
        it is lognormal."""
        shape, spacing, lengths = (24, 12), (1.0, 0.5), (3.0, 0.8)
        field = fields.Field(shape, spacing, lengths, 20e3, 6e3, kind, nu, lognormal)
        values = np.array([field.make(seed) for seed in range(count)])
        base = np.log(values) if lognormal else values
        base = base - base.mean()
        pairs = [(2, 0), (0, 1), (3, 2)]
        got = [np.mean(base[:, :24 - a, :12 - b] * base[:, a:, b:]) / np.mean(base ** 2) for a, b in pairs]
        asked = [float(fields.correlation(kind, np.hypot(a * 1.0 / 3.0, b * 0.5 / 0.8), nu)) for a, b in pairs]
        return values.mean(), values.std(), got, asked

    def test_mean_deviation_and_correlation_are_those_asked_for(self):
        for kind, nu in [("exponential", 1.5), ("gaussian", 1.5), ("matern", 1.5), ("matern", 0.7)]:
            for lognormal in (False, True):
                with self.subTest(kind=kind, nu=nu, lognormal=lognormal):
                    mean, deviation, got, asked = self.moments(kind, lognormal, nu)
                    self.assertAlmostEqual(mean / 20e3, 1, delta=0.006)  # 4 standard errors
                    self.assertAlmostEqual(deviation / 6e3, 1, delta=0.03)
                    np.testing.assert_allclose(got, asked, atol=0.02)

    def test_a_wrong_correlation_is_seen(self):
        _, _, got, _ = self.moments("exponential", count=400)
        _, _, _, asked = self.moments("gaussian", count=2)
        self.assertGreater(np.abs(np.array(got) - asked).max(), 0.05)

    def test_matern_is_exponential_with_one_half(self):
        r = np.linspace(0, 4, 50)
        np.testing.assert_allclose(fields.correlation("matern", r, 0.5), fields.correlation("exponential", r), atol=1e-12)

    def test_marginals_are_gaussian_and_lognormal(self):
        from scipy import stats
        for lognormal, name in ((False, "norm"), (True, "norm")):
            field = fields.Field((1, 1, 1), (1, 1, 1), (1, 1, 1), 10.0, 4.0, "exponential", lognormal=lognormal)
            values = np.array([field.make(seed)[0, 0, 0] for seed in range(4000)])
            base = np.log(values) if lognormal else values
            self.assertGreater(stats.kstest((base - field.mean) / field.deviation, name).pvalue, 0.01)

    def test_a_seed_gives_the_same_field_and_another_a_different_one(self):
        words = ["--name", "su", "--lower", "0,0,0", "--upper", "8,4,3", "--spacing", "0.5,1,0.25", "--mean", 2e4, "--cov", 0.3,
                 "--length", "4,4,1"]
        for name, seed in (("a", 1), ("b", 1), ("c", 2)):
            done = run("random_field", self.folder / f"{name}.h5", *words, "--seed", seed)
            self.assertEqual(done.returncode, 0, done.stderr)
        (a, lower, spacing), (b, _, _), (c, _, _) = (fields.read_field(self.folder / f"{n}.h5", "su") for n in "abc")
        self.assertEqual(a.shape, (17, 5, 13))
        self.assertEqual((list(lower), list(spacing)), ([0, 0, 0], [0.5, 1, 0.25]))
        self.assertTrue((a == b).all() and (a != c).any() and (a > 0).all())

    def test_a_table_for_sweeps(self):
        done = run("random_field", self.folder / "f.h5", "--name", "su", "--lower", "0,0", "--upper", "4,2", "--spacing", 0.5,
                   "--mean", 2e4, "--cov", 0.3, "--length", "2,1", "--count", 3, "--seed", 7, "--distribution", "gaussian",
                   "--lowest", 1.9e4)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "f.csv", newline="") as file:
            header, *rows = csv.reader(file)
        self.assertEqual(header, ["soil_field"])
        lowest = [fields.read_field(row[0], "su")[0].min() for row in rows]
        self.assertEqual(lowest, [1.9e4] * 3)

    def test_a_sweep_has_the_distribution_of_a_column(self):
        values = np.random.default_rng(3).normal(10, 2, 40)
        (self.folder / "t.csv").write_text("soil_field\n" + "".join(f"f{k}.h5\n" for k in range(40)))
        for k, value in enumerate(values):
            folder = self.folder / "out" / f"run_{k:04d}"
            folder.mkdir(parents=True)
            (folder / "history.csv").write_text(f"time,a\n0,0\n1,{value!r}\n2,1\n")
        words = [self.folder / "t.csv", "--gather", "--out", self.folder / "out", "--distribution"]
        done = run("sweep", *words, "a:max")
        self.assertEqual(done.returncode, 0, done.stderr)
        got = np.genfromtxt(self.folder / "out" / "distribution.csv", delimiter=",", skip_header=1)
        np.testing.assert_array_equal(got[:, 1], values)
        self.assertIn(f"40 runs: mean {values.mean():.4g}, deviation {values.std(ddof=1):.4g}", done.stdout)
        self.assertTrue((self.folder / "out" / "distribution.png").stat().st_size > 0)
        self.assertIn("no column b", run("sweep", *words, "b").stderr)
        self.assertIn("takes COLUMN:last", run("sweep", *words, "a:mean").stderr)

    def picture_of_sweep(self, header, rows, x=None, y=None):
        """The axes that scripts/sweep draws for two runs with this history."""
        import matplotlib.pyplot as plt
        for k in range(2):
            folder = self.folder / "out" / f"run_{k:04d}"
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "history.csv").write_text("\n".join([header, *rows]) + "\n")
            (folder / "options.json").write_text(json.dumps({"version": "0", "options": {"dim": "2"}}))
        swept = Ensemble(self.folder / "out", ["su"], [["1"], ["2"]])
        with unittest.mock.patch.object(plt, "close"):
            draw_curves(swept, x, y)
        axes = plt.gcf().axes[0]
        plt.close("all")
        return axes

    def test_a_sweep_shows_the_force_over_the_way_and_the_way_goes_to_the_right(self):
        header = "time,base_x,base_y,base_force_x,base_force_y,plate_x,plate_y,plate_force_x,plate_force_y"
        axes = self.picture_of_sweep(header, [f"{t},0,0,9,9,0,{-0.1 * t},5,{2000 * t}" for t in range(4)])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("-plate_y (m)", "plate_force_y (kN/m)"))
        x, y = axes.lines[0].get_data()
        np.testing.assert_allclose(x, [0, 0.1, 0.2, 0.3])
        np.testing.assert_allclose(y, [0, 2, 4, 6])

    def test_a_sweep_of_a_body_that_is_pushed_sideways(self):
        header = "time,pipe_x,pipe_y,pipe_force_x,pipe_force_y"
        axes = self.picture_of_sweep(header, [f"{t},{0.2 * t},{-0.01 * t},{-3000 * t},1" for t in range(4)])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("pipe_x (m)", "pipe_force_x (kN/m)"))

    def test_a_sweep_of_bodies_that_do_not_move_is_over_time(self):
        axes = self.picture_of_sweep("time,base_x,base_force_x", [f"{t},0,{1e8 * t}" for t in range(4)])
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("time (s)", "base_force_x (MN/m)"))
        self.assertEqual(self.picture_of_sweep("time,base_x,base_force_x", []).get_xlabel(), "time (s)")  # no rows yet
        axes = self.picture_of_sweep("time,base_x,soil_mass", [f"{t},0,{7 * t}" for t in range(4)], y="soil_mass")
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), ("time (s)", "soil_mass (kg/m)"))

    def test_what_is_wrong_is_reported_in_one_line(self):
        words = {"--name": "su", "--lower": "0,0", "--upper": "4,2", "--spacing": "0.5", "--mean": "1", "--cov": "0.3",
                 "--length": "2,1"}
        for name, value, message in [("--upper", "4,0", "--upper: takes numbers greater"), ("--length", "1,0", "--length: takes"),
                                  ("--lower", "0", "take 2 numbers each"), ("--mean", "-1", "lognormal --mean more than 0"),
                                  ("--spacing", "1e-4", "or a larger --spacing")]:
            given = [word for pair in {**words, name: value}.items() for word in pair]
            with self.subTest(name=name, value=value):
                self.refused(run("random_field", self.folder / "f.h5", *given), message)


if __name__ == "__main__":
    unittest.main()
