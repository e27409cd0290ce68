"""Sections of surfaces of triangles with a plane across an axis. Needs numpy."""

import numpy as np


def section_of_triangles(vertices, triangles, axis, place):
    """Closed lines [N, 2] in the two other axes, m. A vertex on the plane counts as beyond it."""
    beyond = vertices[:, axis] >= place
    following = {}
    for corners in triangles[np.isin(beyond[triangles].sum(axis=1), (1, 2))]:
        start, end = crossing(corners, beyond)
        following[start] = end
    loops = []
    while following:
        edge, loop = next(iter(following)), []
        while edge in following:
            loop.append(point_of(vertices, edge, axis, place))
            edge = following.pop(edge)
        loops.append(np.array(loop))
    return [loop for loop in loops if len(loop) > 2]


def crossing(corners, beyond):
    """The edges by which a line along the plane enters and leaves a triangle, each as its two vertices in order."""
    edges = [(corners[k], corners[(k + 1) % 3]) for k in range(3)]
    into = next(edge for edge in edges if beyond[edge[0]] and not beyond[edge[1]])
    out = next(edge for edge in edges if not beyond[edge[0]] and beyond[edge[1]])
    return tuple(sorted(map(int, into))), tuple(sorted(map(int, out)))


def point_of(vertices, edge, axis, place):
    a, b = vertices[edge[0]], vertices[edge[1]]
    share = (place - a[axis]) / (b[axis] - a[axis])
    return np.delete(a + share * (b - a), axis)

