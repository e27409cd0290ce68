"""A film of a run's frames: film.gif and film.mp4. Needs matplotlib and Pillow; ffmpeg for the MP4."""

import shutil
import subprocess
import sys

import numpy as np
from PIL import Image

from soil_mpm.plot.fields import NothingToDraw, Scene, default_fields, panels, size_markers
from soil_mpm.results import time_of

SECONDS = 6.0          # that a film takes
SLOWEST, FASTEST = 4, 25  # pictures a second
DPI = 80


def frames_of(run, until):
    """Paths of the frames up to a time [s]."""
    return [frame for frame in run.frames if until is None or time_of(frame) <= until * (1 + 1e-9)]


def scenes_of(frames, scene_of, report=False):
    """The scene of each frame in which there is a body, one at a time: together they may be more than memory holds."""
    for frame in frames:
        try:
            yield scene_of(frame)
        except NothingToDraw as nothing:
            if report:
                print(f"plot: {nothing}: it is left out of the film", file=sys.stderr)


def common_view(scenes, fields):
    """Fields, box [m] and limits of the colours that hold all scenes, so that they mean the same from first to last."""
    boxes, limits = [], {}
    for scene in scenes:
        fields = fields or default_fields(scene)
        boxes.append(scene.box())
        for name in fields:
            values = scene.values(name)
            if values.any():
                limits.setdefault(name, []).append(scene.limits(name))
    if not boxes:
        return fields, None, None
    box = np.min([lower for lower, _ in boxes], axis=0), np.max([upper for _, upper in boxes], axis=0)
    common = {name: (min(least for least, _ in each), max(most for _, most in each)) for name, each in limits.items()}
    return fields, box, {name: common.get(name, (0, 1)) for name in fields}


def picture(scene, fields, box, limits):
    """A scene as an image of few colours, of even height and width as films take them."""
    import matplotlib.pyplot as plt
    figure, axes = panels(len(fields), box)
    figure.set_dpi(DPI)
    drawn = [mark for each, name in zip(axes, fields) for mark in scene.draw(each, name, limits[name], box)]
    size_markers(figure, drawn)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    plt.close(figure)
    return Image.fromarray(pixels[:pixels.shape[0] // 2 * 2, :pixels.shape[1] // 2 * 2]).quantize(255)


def write_gif(pictures, rate, path):
    first, *others = pictures
    first.save(path, save_all=True, append_images=others, duration=round(1000 / rate), loop=0)
    return path


def write_mp4(pictures, rate, path):
    """Returns the path, or None and a word to the user where ffmpeg is missing or fails."""
    if shutil.which("ffmpeg") is None:
        print(f"plot: ffmpeg is not installed: no {path.name}; film.gif shows the same", file=sys.stderr)
        return None
    width, height = pictures[0].size
    command = ["ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r",
               f"{rate:.6g}", "-i", "-", "-pix_fmt", "yuv420p", str(path)]
    done = subprocess.run(command, input=b"".join(each.convert("RGB").tobytes() for each in pictures), capture_output=True)
    if done.returncode != 0:
        why = done.stderr.decode(errors="replace").strip().splitlines()
        path.unlink(missing_ok=True)
        print(f"plot: ffmpeg failed: no {path.name}: {why[-1] if why else 'it gave no reason'}", file=sys.stderr)
        return None
    return path


def draw_film(run, fields=(), until=None, cut=None):
    """film.gif and film.mp4 of some fields over all frames, or those up to a time [s]. Returns the paths of those made."""
    frames, scene_of = frames_of(run, until), lambda frame: Scene(run, frame, cut)
    fields, box, limits = common_view(scenes_of(frames, scene_of, report=True), list(fields))
    if box is None:
        raise NothingToDraw(f"--film: {run.folder}/frames holds no frame to show")
    return write_film(run.folder, [picture(scene, fields, box, limits) for scene in scenes_of(frames, scene_of)])


def write_film(folder, pictures):
    """film.gif and film.mp4 of images of one size: paths of those made."""
    rate = min(max(len(pictures) / SECONDS, SLOWEST), FASTEST)
    made = write_gif(pictures, rate, folder / "film.gif"), write_mp4(pictures, rate, folder / "film.mp4")
    return [path for path in made if path]
