#!/usr/bin/env python3
"""ParaView's own reader opens the frames, and draws them.

    paraview_reads.py MPM [--benchmarks] [--precisions double,single] [--pictures FOLDER]

Needs Debian's python3-paraview; ends with 77, which ctest takes for left out, without it. Pictures are drawn where there is a
display, or xvfb makes one, and left out with a line where ParaView cannot draw.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from matplotlib import image

from mpm_regression.folders import run

HERE = pathlib.Path(__file__).parent
INPUTS = HERE.parent.parent / "inputs"

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


def check_surface(read, group, what):
    """The triangles of a rigid body, where they are."""
    assert np.array_equal(np.asarray(read.Points), group["vertices"][:]), f"{what}: vertices"
    cells = np.asarray(read.Cells).reshape(-1, 4)
    assert np.all(cells[:, 0] == 3) and np.array_equal(cells[:, 1:], group["triangles"][:]), f"{what}: triangles"


def check_frame(reader, time, path):
    reader.UpdatePipeline(time)
    found = dict(leaves(servermanager.Fetch(reader)))
    with h5py.File(path) as file:
        assert file.attrs["time"] == time, (path, time)
        assert set(found) == set(file), (set(found), set(file))
        for name, group in file.items():
            read = found[name]
            if "triangles" in group:
                check_surface(read, group, f"{path} {name}")
                continue
            position = group["position"][:]
            assert np.array_equal(np.asarray(read.Points), position), f"{path} {name}: positions"
            for field in set(group) - {"position", "stress"}:
                assert np.array_equal(np.asarray(read.PointData[field]), group[field][:]), f"{path} {name}: {field}"
            if "stress" in group:
                for k, component in enumerate(("xx", "yy", "zz", "xy", "yz", "zx")):
                    values = np.asarray(read.PointData[f"stress_{component}"]).ravel()
                    assert np.array_equal(values, group["stress"][:, k]), f"{path} {name}: stress_{component}"
    return sum(len(np.asarray(read.Points)) for read in found.values())


def last_frame(folder, field):
    """Lower and upper corner of all points, m; how far particles are apart; what 99 % of the field do not exceed."""
    with h5py.File(sorted((folder / "frames").glob("*.h5"))[-1]) as file:
        points = np.concatenate([group["position"][:] for name, group in file.items() if name != "nodes" and "position" in group])
        bodies = [group for group in file.values() if "volume" in group]
        apart = min(group["volume"][:].mean() for group in bodies)**0.5
        values = np.concatenate([group[field][:] for group in bodies])
    return points.min(0), points.max(0), apart, np.quantile(np.linalg.norm(values.reshape(len(values), -1), axis=1), 0.99)


def put(item, **properties):
    for name, value in properties.items():
        setattr(item, name, value)


def draw(folder, picture, field):
    """The last frame, in a process of its own: ParaView aborts where it finds no display."""
    index = str(folder / "particles.xdmf")
    grids = list(simple.XDMFReader(FileNames=[index]).GridStatus)  # ParaView numbers the grids of later frames: soil[1]
    lower, upper, apart, most = last_frame(folder, field)
    margin = 40  # pixels
    pixel = max((upper[0] - lower[0]) / 1120, (upper[1] - lower[1]) / 700)  # m
    width, height = (int((upper[k] - lower[k]) / pixel) + (2 + 3 * k) * margin for k in (0, 1))
    width, height = max(width, 600), max(height, 300)
    view = simple.CreateRenderView(ViewSize=[width, height], InteractionMode="2D", OrientationAxesVisibility=0,
                                   UseColorPaletteForBackground=0, Background=[1, 1, 1], CameraParallelProjection=1)
    for name in sorted({grid.split("[")[0] for grid in grids} - {"nodes"}):
        reader = simple.XDMFReader(FileNames=[index], GridStatus=[grid for grid in grids if grid.split("[")[0] == name])
        time = reader.TimestepValues[-1]
        reader.UpdatePipeline(time)
        shown = simple.Show(reader, view, PointSize=max(2.0, 1.6 * apart / pixel), AmbientColor=[0.3] * 3, DiffuseColor=[0.3] * 3)
        if field not in reader.PointData.keys():
            continue
        simple.ColorBy(shown, ("POINTS", field))
        shown.SetScalarBarVisibility(view, True)
        colours = simple.GetColorTransferFunction(field)
        colours.ApplyPreset("Viridis (matplotlib)")
        colours.RescaleTransferFunction(0, most)
        bar = simple.GetScalarBar(colours, view)
        put(bar, Orientation="Horizontal", WindowLocation="Lower Center", ScalarBarLength=0.4, Title=f"{field} at {time:g} s",
                ComponentTitle="", RangeLabelFormat="%.2g", TitleColor=[0] * 3, LabelColor=[0] * 3)
    view.ViewTime = time
    middle = (lower + upper) / 2 - [0, 1.2 * margin * pixel, 0]  # room for the scale below
    put(view, CameraFocalPoint=list(middle), CameraPosition=[*middle[:2], 1], CameraParallelScale=height * pixel / 2)
    simple.SaveScreenshot(str(picture), view)
    share = np.mean(np.any(image.imread(picture)[..., :3] < 0.95, axis=2))
    assert share > 0.05, f"only {share:.1%} of the picture are drawn"


def try_to_draw(folder, picture, field):
    """Whether there is a picture; where ParaView has no display, there is none. xvfb does not always come up in time."""
    display = [] if "DISPLAY" in os.environ or not shutil.which("xvfb-run") else ["xvfb-run", "-a"]
    for _ in range(5):
        done = subprocess.run([*display, sys.executable, __file__, "--draw", str(folder), str(picture), field],
                              capture_output=True, text=True)
        if done.returncode == 0:
            return True
        assert "Error" not in done.stderr.splitlines()[-1], done.stderr
    return False


def look_at(binary, deck, field, pictures, *options):
    with tempfile.TemporaryDirectory(prefix="mpm_paraview_") as temporary:
        folder = pathlib.Path(temporary) / "out"
        run(binary, deck, folder, *options)
        reader = simple.XDMFReader(FileNames=[str(folder / "particles.xdmf")])
        paths = sorted((folder / "frames").glob("*.h5"))
        times = list(reader.TimestepValues)
        assert len(times) == len(paths), (times, len(paths))
        points = sum(check_frame(reader, time, path) for time, path in zip(times, paths))
        picture = (pictures or folder) / f"{deck.stem}.png"
        drawn = try_to_draw(folder, picture, field)
    print(f"{deck.stem}: {len(paths)} frames, {points} points: ParaView reads the same numbers, and "
          + (f"draws them{f' ({picture})' if pictures else ''}" if drawn else "cannot draw here"), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("binary")
    parser.add_argument("--benchmarks", action="store_true", help="the footing, the landslide and the boulder too")
    parser.add_argument("--pictures", type=pathlib.Path, help="a folder to keep the pictures in")
    parser.add_argument("--precisions", default="double")
    arguments = parser.parse_args()
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    look = lambda *words: look_at(arguments.binary, words[0], words[1], arguments.pictures, *words[2:])
    for precision in arguments.precisions.split(","):
        look(HERE / "small.opts", "velocity", "-backend", "serial", "-time_max_steps", 100, "-output_nodes", "on",
             "-output_compression", 1, "-precision", precision)
    if arguments.benchmarks:
        look(INPUTS / "footing_coarse.opts", "plastic_strain", "-output_interval", 0.5)
        look(INPUTS / "landslide_coarse.opts", "grid_velocity", "-output_interval", 1, "-time_end", 8)
        look(INPUTS / "rolling_boulder.opts", "plastic_strain", "-output_interval", 0.1, "-time_end", 0.3)


if __name__ == "__main__":
    if sys.argv[1] == "--draw":
        draw(pathlib.Path(sys.argv[2]), sys.argv[3], sys.argv[4])
    else:
        main()
