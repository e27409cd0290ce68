#!/usr/bin/env python3
"""Fields, slices and films of soil_mpm.plot.fields and film, on a made-up cube of soil with a pile.
Needs numpy, h5py, matplotlib and Pillow."""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
from PIL import Image

sys.dont_write_bytecode = True

from soil_mpm import results  # noqa: E402
from soil_mpm.plot import curves as plot_curves, fields as plot_fields, film as plot_film  # noqa: E402

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"

CUBE = {"dim": "3", "mesh_lower": "0,0,0", "mesh_upper": "4,4,2", "mesh_spacing": "0.5", "bodies": "soil", "rigid_bodies": "pile",
        "pile_motion": "prescribed", "mesh_ymin": "roller"}


def write_cube(folder, **changes):
    """Soil of 4 m x 4 m x 1 m whose plastic strain is its y, with a pile at 0 < y < 1; frames at 0 and 1 s."""
    (folder / "frames").mkdir()
    (folder / "options.json").write_text(json.dumps({"version": "0", "options": {**CUBE, **changes}}))
    (folder / "history.csv").write_text("time,pile_z,pile_force_z\n0,0,0\n1,-0.1,2000\n")
    for time in range(2):
        with h5py.File(folder / "frames" / f"frame_{time:05d}.h5", "w") as file:
            file.attrs["time"] = float(time)
            points = np.stack(np.meshgrid(*[np.arange(0.125, end, 0.25) for end in (4, 4, 1)]), -1).reshape(-1, 3)
            file["soil/position"], file["soil/plastic_strain"] = points, points[:, 1]
            file["soil/stress"] = np.tile([-3e3, -3e3, -6e3, 0, 4e3, 0], (len(points), 1))
            file["soil/volume"] = np.full(len(points), 0.25 ** 3)
            file["pile/position"] = np.array([[1.0, y, 1.2 - 0.1 * time] for y in np.arange(0.0625, 1, 0.125)])


class Cube(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def scene(self, cut=None, **changes):
        run = results.Run(self.folder)
        run.options.update(changes)
        return plot_fields.Scene(run, run.frame, cut)

    def test_colours_of_softening_clay_end_where_its_strength_is_lost(self):
        write_cube(self.folder)
        across = plot_fields.Slice(0, 2.0)  # holds every y
        self.assertGreater(self.scene(across).limits("plastic_strain")[1], 3)
        softening = {"soil_material": "clay", "clay_model": "softening_clay", "clay_xi95": "2"}
        self.assertEqual(self.scene(across, **softening).limits("plastic_strain"), (0, 2))
        self.assertEqual(self.scene(across, **softening, clay_xi95_cell="0.25").limits("plastic_strain"), (0, 1))
        self.assertGreater(self.scene(across, **softening).limits("mises")[1], 2)

    def test_rings_are_drawn_as_large_as_their_section(self):
        write_cube(self.folder)
        with h5py.File(self.folder / "frames" / "frame_00001.h5", "a") as file:
            file["soil/volume"][:] = 0.25 ** 2 * 2 * np.pi * file["soil/position"][:, 0]
        self.assertAlmostEqual(self.scene(dim="2", geometry="axisymmetric").size("soil"), 0.25)

    def test_places_of_slices(self):
        self.assertEqual(plot_fields.parse_slice("auto"), plot_fields.Slice(1, None))
        self.assertEqual(plot_fields.parse_slice("z"), plot_fields.Slice(2, None))
        self.assertEqual(plot_fields.parse_slice("x=-2.5"), plot_fields.Slice(0, -2.5))
        for text in ("", "w=1", "y=", "=1", "y=nan", "y=inf", "y=1=2", "yy"):
            self.assertRaises(ValueError, plot_fields.parse_slice, text)

    def test_a_slice_goes_through_the_moving_rigid(self):
        write_cube(self.folder)
        for changes, least, most in (({}, 0, 0.19), ({"mesh_ymin": "fixed"}, 0.3, 0.7), ({"pile_motion": "fixed"}, 1.8, 2.2)):
            y = self.scene(**changes).values("plastic_strain")
            self.assertTrue(len(y) and y.min() >= least and y.max() <= most, (changes, y.min(), y.max()))
        self.assertIn("y = 0 m", self.scene().where)
        self.assertEqual(len(self.scene().groups["pile"]["position"]), 1)

    def test_a_slice_at_a_place(self):
        write_cube(self.folder)
        scene = self.scene(plot_fields.Slice(0, 3.1))
        self.assertEqual(scene.plane, [1, 2])
        np.testing.assert_allclose(scene.groups["soil"]["position"][:, 0], 3.125)
        self.assertEqual(len(scene.groups["pile"]["position"]), 0)
        with self.assertRaisesRegex(plot_fields.NothingToDraw, "no particle of a body is at z = 9 m"):
            self.scene(plot_fields.Slice(2, 9.0))
        with self.assertRaisesRegex(plot_fields.NothingToDraw, "the run is in 2D"):
            self.scene(plot_fields.Slice(), dim="2")

    def test_fields_by_name(self):
        write_cube(self.folder)
        scene = self.scene()
        np.testing.assert_allclose(scene.values("pressure"), 4)
        np.testing.assert_allclose(scene.values("mises"), np.sqrt(9 + 3 * 16))
        np.testing.assert_allclose(scene.values("stress_yz"), 4)
        self.assertEqual(plot_fields.default_fields(scene), ["plastic_strain"])  # the frame has no velocity
        with self.assertRaisesRegex(plot_fields.NothingToDraw, 'given "speed", takes .*pressure, mises'):
            scene.values("speed")

    def test_pictures_at_a_time(self):
        write_cube(self.folder)
        run = results.Run(self.folder)
        self.assertGreater(plot_fields.draw_field(run, ["mises", "volume"], 0.1, plot_fields.Slice(2)).stat().st_size, 10000)
        self.assertEqual(run.frame_near(0.1).name, "frame_00000.h5")
        self.assertGreater(plot_curves.draw_curves(run, []).stat().st_size, 10000)

    def test_a_film_has_each_frame_and_says_what_it_lacks(self):
        write_cube(self.folder)
        run, printed = results.Run(self.folder), io.StringIO()
        path, os.environ["PATH"] = os.environ["PATH"], str(self.folder)
        try:
            with contextlib.redirect_stderr(printed):
                made = plot_film.draw_film(run)
        finally:
            os.environ["PATH"] = path
        self.assertEqual([each.name for each in made], ["film.gif"])
        self.assertEqual(printed.getvalue(), "plot: ffmpeg is not installed: no film.mp4; film.gif shows the same\n")
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual(film.n_frames, 2)
        plot_film.draw_film(run, until=0.5)
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual(getattr(film, "n_frames", 1), 1)
        self.assertRaises(plot_fields.NothingToDraw, plot_film.draw_film, run, (), -1.0)

    def test_an_mp4_gets_the_pixels_and_a_failing_ffmpeg_is_reported(self):
        pictures = [Image.fromarray(np.full((4, 6, 3), k, np.uint8)) for k in range(3)]
        pictures[1] = pictures[1].quantize(255)
        ffmpeg, target = self.folder / "ffmpeg", self.folder / "film.mp4"
        path, os.environ["PATH"] = os.environ["PATH"], f"{self.folder}:{os.environ['PATH']}"
        try:
            ffmpeg.write_text('#!/bin/sh\nfor last; do :; done\ncat > "$last"\n')
            ffmpeg.chmod(0o755)
            self.assertEqual(plot_film.write_mp4(pictures, 5, target), target)
            self.assertEqual(target.read_bytes(), bytes([0] * 72 + [1] * 72 + [2] * 72))
            ffmpeg.write_text("#!/bin/sh\ncat > /dev/null\necho no such codec >&2\nexit 1\n")
            printed = io.StringIO()
            with contextlib.redirect_stderr(printed):
                self.assertIsNone(plot_film.write_mp4(pictures, 5, target))
            self.assertEqual(printed.getvalue(), "plot: ffmpeg failed: no film.mp4: no such codec\n")
            self.assertFalse(target.exists())
        finally:
            os.environ["PATH"] = path

    def test_the_command_tells_what_is_wrong_in_a_line(self):
        write_cube(self.folder)
        for words, status, line in ((["--slice", "y=9"], 1, "plot: --slice: no particle of a body is at y = 9 m"),
                                    (["--field", "speed"], 1, 'plot: --field: given "speed", takes'),
                                    (["--slice", "q"], 2, 'given "q", takes auto, x, y or z'), (["--time", "0.2"], 0, "")):
            done = subprocess.run([sys.executable, str(SCRIPTS / "plot"), str(self.folder), *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn(line, done.stderr.splitlines()[-1] if line else "")


if __name__ == "__main__":
    unittest.main()
