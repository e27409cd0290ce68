"""Where pictures in space are seen from, in parallel projection, and where points lie in them. Needs numpy."""

from dataclasses import dataclass

import numpy as np

NAMED = {"iso": (-60.0, 30.0), "x": (0.0, 0.0), "y": (-90.0, 0.0), "z": (-90.0, 90.0)}  # degrees
ROOM = 1.16  # of a picture over what it shows, for the numbers at the axes


@dataclass
class Camera:
    """Directions [3] to the right and up in the picture, and from what is seen towards the camera."""
    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray

    def on_screen(self, points):
        """Places [N, 2] to the right and up of points [N, 3], m."""
        return np.asarray(points, dtype=float) @ np.column_stack([self.right, self.up])


def camera_of(azimuth, elevation):
    """Camera at an azimuth about z from x on, and an elevation over the horizontal plane, degrees."""
    a, e = np.radians([azimuth, elevation])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    return Camera(right, np.cross(towards, right), np.where(np.abs(towards) < 1e-12, 0, towards))


def parse_camera(text):
    """Azimuth and elevation in degrees of "iso", "x", "y", "z" or "AZIMUTH,ELEVATION"; ValueError for anything else."""
    if text in NAMED:
        return NAMED[text]
    azimuth, elevation = (float(word) for word in text.split(","))
    if not (np.isfinite(azimuth) and -90 <= elevation <= 90):
        raise ValueError(text)
    return azimuth, elevation


def corners_of(box):
    """The eight corners [8, 3] of a box."""
    return np.array([[box[k][0], box[m][1], box[n][2]] for k in (0, 1) for m in (0, 1) for n in (0, 1)])


def frame_of(camera, box, ratio):
    """Middle [3] of a box, and half of the width and height of a picture of some width over height that has it all, m."""
    middle = (np.asarray(box[0]) + box[1]) / 2
    half = ROOM * np.abs(camera.on_screen(corners_of(box) - middle)).max(axis=0)
    height = max(half[1], half[0] / ratio, 1e-9)
    return middle, (height * ratio, height)


def axis_lines(camera, box):
    """[(axis, begin [3], end [3])]: an edge of the box along each axis that is seen, on the outside of the picture: those of x and y low,
    that of z on the left."""
    middle, lines = (np.asarray(box[0]) + box[1]) / 2, []
    for axis in range(3):
        edges = [(low, high) for low in corners_of(box) for high in corners_of(box)
                 if low[axis] < high[axis] and np.array_equal(np.delete(low, axis), np.delete(high, axis))]
        across = [camera.on_screen((low + high) / 2 - middle) for low, high in edges]
        outside = [(-place[0], -place[1]) if abs(camera.up[axis]) > abs(camera.right[axis]) and axis == 2 else (-place[1], -place[0])
                   for place in across]
        low, high = edges[max(range(4), key=lambda k: tuple(np.round(outside[k], 9)))]
        if np.linalg.norm(camera.on_screen(high - low)) > 0.3 * np.linalg.norm(high - low):
            lines.append((axis, low, high))
    return lines
