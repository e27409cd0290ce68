#!/usr/bin/env python3
"""ParaView's own reader opens the frames, and draws them.

    paraview_reads.py MPM [--picture FILE]

Needs Debian's python3-paraview; ends with 77, which ctest takes for left out, without it. The picture is drawn where there is a
display, or xvfb makes one, and left out with a line where ParaView cannot draw.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from folders import run

HERE = pathlib.Path(__file__).parent

try:
    from paraview import servermanager, simple
    from paraview.vtk.numpy_interface import dataset_adapter
except ImportError:
    print("left out: python3-paraview is not installed")
    sys.exit(77)


def leaves(data, name=""):
    """Names and datasets of a tree of blocks."""
    if not data.IsA("vtkMultiBlockDataSet"):
        yield name, dataset_adapter.WrapDataObject(data)
        return
    for n in range(data.GetNumberOfBlocks()):
        about = data.GetMetaData(n)
        own = about.Get(data.NAME()).split("[")[0] if about is not None and about.Has(data.NAME()) else name
        if data.GetBlock(n) is not None:
            yield from leaves(data.GetBlock(n), own)


def check_frame(reader, time, path):
    reader.UpdatePipeline(time)
    found = dict(leaves(servermanager.Fetch(reader)))
    with h5py.File(path) as file:
        assert file.attrs["time"] == time, (path, time)
        assert set(found) == set(file), (set(found), set(file))
        for name, group in file.items():
            read = found[name]
            position = group["position"][:]
            assert np.array_equal(np.asarray(read.Points), position), f"{path} {name}: positions"
            for field in set(group) - {"position", "stress"}:
                assert np.array_equal(np.asarray(read.PointData[field]), group[field][:]), f"{path} {name}: {field}"
            if "stress" in group:
                for k, component in enumerate(("xx", "yy", "zz", "xy", "yz", "zx")):
                    values = np.asarray(read.PointData[f"stress_{component}"]).ravel()
                    assert np.array_equal(values, group["stress"][:, k]), f"{path} {name}: stress_{component}"
    return sum(len(np.asarray(read.Points)) for read in found.values())


def draw(index, picture):
    """In a process of its own: ParaView aborts where it finds no display."""
    reader = simple.XDMFReader(FileNames=[index])
    view = simple.CreateRenderView(ViewSize=[900, 600])
    shown = simple.Show(reader, view)
    simple.ColorBy(shown, ("POINTS", "velocity"))
    shown.PointSize = 4
    view.InteractionMode = "2D"
    simple.ResetCamera(view)
    simple.SaveScreenshot(picture, view)
    assert pathlib.Path(picture).stat().st_size > 5000, "the picture is empty"


def main():
    folder = pathlib.Path(tempfile.mkdtemp(prefix="mpm_paraview_"))
    run(sys.argv[1], HERE / "small.opts", folder / "out", "-backend", "serial", "-time_max_steps", 100,
        "-output_nodes", "on", "-output_compression", 1)
    reader = simple.XDMFReader(FileNames=[str(folder / "out/particles.xdmf")])
    paths = sorted((folder / "out/frames").glob("*.h5"))
    times = list(reader.TimestepValues)
    assert len(times) == len(paths), (times, len(paths))
    points = sum(check_frame(reader, time, path) for time, path in zip(times, paths))
    picture = sys.argv[3] if sys.argv[2:3] == ["--picture"] else str(folder / "picture.png")
    display = [] if "DISPLAY" in os.environ or not shutil.which("xvfb-run") else ["xvfb-run", "-a"]
    drawn = subprocess.run([*display, sys.executable, __file__, "--draw", str(folder / "out/particles.xdmf"), picture],
                           capture_output=True).returncode == 0
    print(f"{len(paths)} frames, {points} points: ParaView reads the same numbers, and "
          + (f"draws {picture}" if drawn else "the picture is left out: it cannot draw here"))
    shutil.rmtree(folder)


if __name__ == "__main__":
    if sys.argv[1] == "--draw":
        draw(*sys.argv[2:])
    else:
        main()
