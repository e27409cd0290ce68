#!/usr/bin/env python3
"""Frames as meshes of meshio: what other programs read of them is what the frame has.

usage: test_export.py PATH_TO_mpm

Exit status 77 where meshio is missing.
"""

import contextlib
import importlib.util
import io
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

if importlib.util.find_spec("meshio") is None:
    print("test_export.py: there is no meshio", file=sys.stderr)
    sys.exit(77)
os.environ["MPM_PROGRAM"] = str(pathlib.Path(sys.argv.pop(1)).resolve())

import meshio

from soil_mpm import Deck, __main__


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name) / "out"
        cls.run_ = Deck.read("footing_coarse").copy(mesh_spacing=0.25, mesh_upper=(3, 4.5), time_end=0.2, backend="serial").run(cls.folder, progress=False)

    def test_a_mesh_has_what_the_frame_has(self):
        with self.run_.frame_at(0.1) as frame:
            mesh, soil, plate = frame.mesh(), frame["soil"], frame["plate"]
            order = [frame[name] for name in frame.names()]
            np.testing.assert_array_equal(mesh.points, np.concatenate([body["position"][()] for body in order]))
            of_soil = mesh.point_data["body"] == frame.names().index("soil")
            np.testing.assert_array_equal(mesh.point_data["stress"][of_soil], soil["stress"][()])
            self.assertTrue(np.isnan(mesh.point_data["stress"][~of_soil]).all())
            self.assertEqual(plate.count, (~of_soil).sum())

    def test_files_are_read_again(self):
        for name in ("soil.vtu", "soil.xdmf"):
            with contextlib.redirect_stdout(io.StringIO()) as out:
                words = ["export", str(self.folder), str(self.folder / name), "--time", "0.1", "--body", "soil"]
                self.assertEqual(__main__.main(words), 0)
            read = meshio.read(out.getvalue().strip())
            with self.run_.frame_at(0.1) as frame:
                np.testing.assert_allclose(read.points, frame["soil"]["position"][()])
                np.testing.assert_allclose(read.point_data["plastic_strain"], frame["soil"]["plastic_strain"][()])
                np.testing.assert_allclose(read.point_data["stress"], frame["soil"]["stress"][()])

    def test_mistakes(self):
        for words in ([str(self.folder), str(self.folder / "a.unknown")], [str(self.folder), str(self.folder / "a.vtu"), "--body", "clay"]):
            with contextlib.redirect_stderr(io.StringIO()) as said:
                self.assertEqual(__main__.main(["export", *words]), 2)
            self.assertEqual(len(said.getvalue().strip().splitlines()), 1, said.getvalue())


if __name__ == "__main__":
    unittest.main()
