#!/usr/bin/env python3
"""Pictures of bodies in space: a small footing of the program, and made-up frames whose surfaces and forces are known.

usage: test_plot_view.py PATH_TO_mpm

Exit status 77 where PyVista is missing, or nothing can be drawn without a display.
"""

import contextlib
import importlib.util
import io
import json
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

sys.dont_write_bytecode = True

from soil_mpm.plot.fields import NothingToDraw, Slice
from soil_mpm.plot.render import with_pyvista

try:
    with_pyvista()
except NothingToDraw as missing:
    print(f"test_plot_view.py: {missing}", file=sys.stderr)
    sys.exit(77)
os.environ["MPM_PROGRAM"] = str(pathlib.Path(sys.argv.pop(1)).resolve())

from matplotlib import colormaps, image  # noqa: E402
from PIL import Image  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

from soil_mpm import Deck, Problem, __main__  # noqa: E402
from soil_mpm.plot import camera, pictures, render, solids, view  # noqa: E402
from soil_mpm.plot.space import SpaceScene  # noqa: E402
from soil_mpm.results import Run  # noqa: E402

MESH = {"dim": "3", "mesh_lower": "0,0,0", "mesh_upper": "8,5,6", "mesh_spacing": "0.5", "bodies": "soil", "rigid_bodies": "body"}


def share_near(pixels, colour, within=0.06):
    """Share of the pixels [n, m, 3] whose hue is that of a colour: the direction of red, green and blue."""
    unit = lambda rgb: rgb / np.maximum(np.linalg.norm(rgb, axis=-1, keepdims=True), 1e-9)
    near = np.linalg.norm(unit(pixels) - unit(np.asarray(colour)), axis=-1) < within
    return np.mean(near & (pixels.max(axis=-1) < 0.99))


class Footing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name) / "out"
        deck = Deck.read("footing_square").copy(mesh_spacing=0.3, mesh_upper=(2.7, 2.7, 3.3), plate_upper=(0.6, 0.6, 3), time_step=7e-4, time_end=0.1,
                                                output_interval=0.05, backend="serial")
        cls.run_ = deck.run(cls.folder, progress=False)

    def test_the_picture_has_bodies_and_legend(self):
        path = self.run_.view("mises", camera="240,30")
        pixels = image.imread(path)[..., :3]
        self.assertEqual((path.name, pixels.shape), ("view.png", (1080, 1920, 3)))
        scene, legend = pixels[100:, :1600], pixels[150:, 1700:]
        self.assertGreater(np.mean((scene < 0.95).any(axis=2)), 0.2)
        self.assertGreater(share_near(scene, np.array([0x8a, 0x90, 0x97]) / 255, 0.02), 0.001)  # the plate
        for share in (0.05, 0.5, 0.95):
            self.assertGreater(share_near(legend, colormaps["viridis"](share)[:3]), 1e-3)
        again = image.imread(self.run_.view("mises", camera=(240, 30), to=self.folder / "again.png"))[..., :3]
        np.testing.assert_array_equal(again, pixels)

    def test_words_of_the_page(self):
        scene = view.scene_of(self.run_, self.run_.frame, view.View(), None)
        figure = view.page(scene, view.View(), ["mises", "plastic_strain"], {"mises": (0, 3), "plastic_strain": (0, 1)}, scene.box())
        words = [text.get_text() for text in figure.texts]
        self.assertEqual(words, ["von Mises stress (kPa), t = 0.1 s", "plastic shear strain (-), t = 0.1 s"])
        self.assertGreaterEqual(min(text.get_fontsize() for text in figure.texts), 16)
        labels = {text.get_text() for text in figure.axes[0].texts}
        self.assertLessEqual({"x (m)", "y (m)", "z (m)", "0", "2.7"}, labels)

    def test_a_section_leaves_out_what_is_before_it(self):
        scene = SpaceScene(self.run_, self.run_.frame, Slice(1, 1.2), (0, -1, 0))
        low, high = scene.box()
        self.assertAlmostEqual(low[1], 1.2, 4)
        self.assertAlmostEqual(high[1], 2.7, 5)
        self.assertGreater(scene.groups["soil"]["position"][:, 1].min(), 1.2)
        self.assertIsNone(scene.solid("plate"))  # it ends at 0.6
        cut = SpaceScene(self.run_, self.run_.frame, Slice(1, 0.3), (0, -1, 0)).solid("plate")
        np.testing.assert_allclose(cut.bounds, (0, 0.6, 0.3, 0.6, 2.69, 2.99), atol=1e-5)
        self.assertRaisesRegex(NothingToDraw, "behind y = -1", SpaceScene, self.run_, self.run_.frame, Slice(1, -1.0), (0, 1, 0))

    def test_the_film_has_a_picture_for_each_frame(self):
        paths, missing = pictures.draw_all(self.run_, [], pictures.Wishes(fields=["mises"], view=view.View(style="points"), film=True))
        self.assertEqual([path.name for path in paths][:2], ["view.png", "film.gif"])
        self.assertEqual(missing, [])
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual((film.n_frames, film.size), (len(self.run_.frames), view.FILM))

    def test_vtk_reads_what_is_exported(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOHDF import vtkHDFReader
        path = self.folder / "frame.vtkhdf"
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(__main__.main(["export", str(self.folder), str(path), "--time", "0.05"]), 0)
        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        reader.Update()
        read = reader.GetOutput()
        with self.run_.frame_at(0.05) as frame:
            bodies = [frame[name] for name in frame.names()]
            np.testing.assert_array_equal(vtk_to_numpy(read.GetPoints().GetData()), np.concatenate([body["position"][()] for body in bodies]))
            of = {name: vtk_to_numpy(read.GetPointData().GetArray(name)) for name in ("body", "stress", "velocity")}
            soil = of["body"] == frame.names().index("soil")
            np.testing.assert_array_equal(of["stress"][soil], frame["soil"]["stress"][()])
            np.testing.assert_array_equal(of["velocity"], np.concatenate([body["velocity"][()] for body in bodies]))
            self.assertTrue(np.isnan(of["stress"][~soil]).all())

    def test_a_report_has_the_bodies_in_space(self):
        picture = self.folder / "view.png"
        picture.unlink(missing_ok=True)
        self.assertIn('alt="view"', self.run_.report().read_text())
        made = picture.stat().st_mtime_ns
        self.run_.report()
        self.assertEqual(picture.stat().st_mtime_ns, made)

    def test_mistakes_are_one_line(self):
        for words, status in ((["--view", "top"], 2), (["--style", "points"], 2), (["--view", "iso", "--bodies", "clay"], 1),
                              (["--view", "iso", "--field", "heat"], 1), (["--view", "iso", "--forces"], 1)):
            with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.suppress(SystemExit):
                self.assertEqual(__main__.main(["plot", str(self.folder), *words]), status)
            last = said.getvalue().strip().splitlines()[-1]
            self.assertIn(words[0] if words[0] == "--style" else words[-2] if len(words) == 4 else words[-1] if len(words) == 3 else words[0], last)
        self.assertRaisesRegex(Problem, "camera: given", self.run_.view, camera="top")
        self.assertRaisesRegex(Problem, "style: given", self.run_.view, style="lines")
        self.assertRaisesRegex(Problem, "cut: given", self.run_.view, cut="w=1")
        with mock.patch.object(render.importlib.util, "find_spec", lambda name: None):
            self.assertRaisesRegex(Problem, r"PyVista or SciPy is missing; takes pip install", self.run_.view)


class Made(unittest.TestCase):
    """Frames that are made up."""

    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def run_of(self, options, groups=None, history=None):
        (self.folder / "frames").mkdir(exist_ok=True)
        (self.folder / "options.json").write_text(json.dumps({"version": "0", "options": {**MESH, **options}}))
        columns = history or {"time": [0.0, 1.0], "body_x": [0, 0], "body_y": [0, 0], "body_z": [0, 0]}
        rows = [",".join(map(repr, map(float, row))) for row in zip(*columns.values())]
        (self.folder / "history.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
        with h5py.File(self.folder / "frames" / "frame_00000.h5", "w") as file:
            file.attrs["time"] = 1.0
            for name, fields in (groups or {}).items():
                for key, values in fields.items():
                    file[f"{name}/{key}"] = values
        return Run(self.folder)

    def test_volumes_of_shapes(self):
        box = {"lower": "1,1,1", "upper": "3,4,2"}
        cases = [({"shape": "box", **box}, 6), ({"shape": "box", "lower": "-1,1,1", "upper": "3,9,2"}, 3 * 4),
                 ({"shape": "box", **box, "angle_deg": "30"}, 6), ({"shape": "polygon", "polygon": "1,1,5,1,5,2,2,2,2,5,1,5", "width": "1,3"}, 14),
                 ({"shape": "ball", "centre": "4,2,3", "radius": "1"}, 4 / 3 * np.pi), ({"shape": "ball", "centre": "4,0,3", "radius": "1"}, 2 / 3 * np.pi),
                 ({"shape": "cylinder", "centre": "4,2,1", "radius": "1", "height": "3"}, 3 * np.pi),
                 ({"shape": "cylinder", "centre": "4,2,1", "radius": "1", "height": "3", "tip_angle_deg": "90"}, (2 + 1 / 3) * np.pi),
                 ({"shape": "cone", "centre": "4,2,1", "tip_angle_deg": "90", "radius": "1"}, np.pi / 3),
                 ({"shape": "half_plane", "point": "0,0,2", "normal": "0,0,1"}, 80), ({"shape": "layer", "base": "0,0,8,1", "top": "2"}, 60),
                 ({"parts": "a,b"}, 2)]
        parts = {f"{part}_{key}": value for part, at in (("a", 1), ("b", 3)) for key, value in
                 {"shape": "box", "lower": f"{at},1,1", "upper": f"{at + 1},2,2"}.items()}
        for options, volume in cases:
            mesh = solids.solid(self.run_of({**parts, **{f"body_{key}": text for key, text in options.items()}}), "body")
            self.assertTrue(mesh.is_manifold, options)
            self.assertLess(abs(mesh.volume / volume - 1), 0.02, (options, mesh.volume))
        for options in ({"shape": "stl"}, {"shape": "box", **box, "fillet": "0.2"}, {"shape": "box", **box, "cut_out": "a"},
                        {"shape": "layer", "top": "gone.asc", "base": "0"}):
            self.assertIsNone(solids.solid(self.run_of({f"body_{key}": text for key, text in options.items()}), "body"), options)

    def test_a_rigid_that_turned_is_where_its_particles_are(self):
        turn, way = np.array([0.3, -2.0, 1.1]), np.array([1.0, 0.5, -0.2])
        lower, upper = np.array([2, 1, 2.0]), np.array([4, 2, 3.5])
        middle = (lower + upper) / 2
        corners = camera.corners_of((lower, upper))
        now = middle + way + Rotation.from_rotvec(turn).apply(corners - middle)
        history = {"time": [0, 1], **{f"body_{a}": [0, way[k]] for k, a in enumerate("xyz")}, **{f"body_angle_{a}": [0, turn[k]] for k, a in enumerate("xyz")}}
        options = {"body_shape": "box", "body_lower": "2,1,2", "body_upper": "4,2,3.5"}
        soil = {"position": np.array([[1.0, 1, 1]]), "volume": np.array([0.1])}
        run = self.run_of(options, {"soil": soil, "body": {"position": now}}, history)
        mesh = SpaceScene(run, run.frame).solid("body")
        apart = np.linalg.norm(np.asarray(mesh.points)[:, None] - now[None], axis=2).min(axis=1)
        self.assertLess(apart.max(), 1e-6)
        half = solids.rotation_at(run, "body", 0.5).as_rotvec()
        np.testing.assert_allclose(half, turn / 2, atol=1e-12)

    def block(self, count=12, spacing=0.25):
        places = (np.indices([count] * 3).reshape(3, -1).T + 0.5) * spacing + 1
        return {"position": places, "volume": np.full(len(places), spacing ** 3), "plastic_strain": places[:, 0]}

    def test_hidden_particles_are_left_out_and_the_surface_holds_the_volume(self):
        run = self.run_of({}, {"soil": self.block()})
        scene = SpaceScene(run, run.frame)
        seen = scene.seen("soil")
        inner = (np.abs(scene.groups["soil"]["position"] - 2.5) < 1).all(axis=1)  # all but an outer cell of two particles
        np.testing.assert_array_equal(seen, ~inner)
        surface = scene.surface("soil", scene.values_of("soil", "plastic_strain"))
        self.assertLess(abs(surface.volume / 27 - 1), 0.05)
        np.testing.assert_allclose(surface["value"], np.clip(np.asarray(surface.points)[:, 0], 1.125, 3.875), atol=0.26)
        cubes = scene.cubes("soil")
        self.assertEqual(cubes.n_cells, 6 * seen.sum())

    def test_forces_are_arrows(self):
        force = {"position": np.array([[2.5, 2.5, 4.0]]), "contact_force": np.array([[0.0, 0, 5000.0]])}
        run = self.run_of({"contact_pairs": "soil:pile"}, {"soil": self.block(), "soil_pile": force})
        pixels = [image.imread(run.view("plastic_strain", forces=forces))[..., :3] for forces in (False, True)]
        red = [share_near(each[100:950, :1600], np.array([0xc1, 0x12, 0x1f]) / 255, 0.05) for each in pixels]
        self.assertLess(red[0], 1e-5)
        self.assertGreater(red[1], 2e-4)
        scene = view.scene_of(run, run.frame, view.View(), None)
        self.assertEqual(scene.rigids(), [])
        figure = view.page(scene, view.View(forces=True), ["plastic_strain"], {"plastic_strain": (0, 4)}, scene.box(), longest=5000.0)
        self.assertIn("arrows: contact force, the longest 5 kN", [text.get_text() for text in figure.texts])

    def test_a_terrain_is_drawn(self):
        (self.folder / "top.asc").write_text("ncols 8\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + "0.5 0.5 0.5 0.5 0.5 0.5 0.5 1\n" * 5)
        run = self.run_of({}, {"soil": self.block()})
        pixels = [image.imread(run.view("plastic_strain", camera="iso", terrain=path))[100:, :1600, :3] for path in (None, self.folder / "top.asc")]
        grey = [np.mean((np.ptp(each, axis=2) < 0.01) & (each[..., 0] > 0.5) & (each[..., 0] < 0.92)) for each in pixels]
        self.assertLess(grey[0], 0.01)
        self.assertGreater(grey[1], 0.05)

    def test_cameras(self):
        for name, right, up in (("x", (0, 1, 0), (0, 0, 1)), ("y", (1, 0, 0), (0, 0, 1)), ("z", (1, 0, 0), (0, 1, 0))):
            seen = camera.camera_of(*camera.parse_camera(name))
            np.testing.assert_allclose([seen.right, seen.up], [right, up], atol=1e-12)
            self.assertEqual([axis for axis, _, _ in camera.axis_lines(seen, ((0, 0, 0), (1, 2, 3)))], [k for k in range(3) if "xyz"[k] != name])
        for text in ("top", "1", "1,2,3", "0,91", "nan,0"):
            self.assertRaises(ValueError, camera.parse_camera, text)


if __name__ == "__main__":
    unittest.main()
