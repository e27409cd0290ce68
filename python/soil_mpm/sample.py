"""Values of particles at any points: weighted fits of linear functions. Needs numpy and scipy."""

import itertools

import numpy as np

REACH = 1.5  # cells, from a point to the particles that count for it
AT_ONCE = 4096  # points


def bell(r: np.ndarray) -> np.ndarray:
    a = np.minimum(np.abs(r), 1)
    return (1 - a) ** 2 * (1 + 2 * a)


def linear_values(offsets: np.ndarray, weights: np.ndarray, values: np.ndarray, begins: np.ndarray) -> np.ndarray:
    """Weighted fits of linear functions at m points, values at the points themselves [m, k]; the mean where the particles do not determine a
    slope. Particles begins[n] to begins[n + 1] of the arrays belong to point n, which has one at least: offsets [N, dim] from the point,
    weights [N], values [N, k]; begins [m + 1]."""
    from scipy.sparse import csr_matrix
    count, dim = values.shape[1], offsets.shape[1]
    sums = csr_matrix((weights, np.arange(len(weights)), begins), shape=(len(begins) - 1, len(weights)))
    ones = np.column_stack([np.ones(len(offsets)), offsets])
    matrix = np.stack([sums @ (ones * column[:, None]) for column in ones.T], axis=1)
    right = np.stack([sums @ (values * column[:, None]) for column in ones.T], axis=1)
    mean = right[:, 0] / matrix[:, 0, :1]
    spread = matrix / matrix[:, :1, :1]
    spread = spread[:, 1:, 1:] - spread[:, 0, 1:, None] * spread[:, 0, None, 1:]
    fits = np.linalg.eigvalsh(spread.reshape(-1, dim, dim)).min(axis=1) >= 0.01
    mean[fits] = np.linalg.solve(matrix[fits], right[fits].reshape(-1, dim + 1, count))[:, 0]
    return mean


def sample(positions: np.ndarray, volumes: np.ndarray, values: np.ndarray, points: np.ndarray, spacing: float) -> np.ndarray:
    """values [N, k] of particles at points [n, dim], NaN where no particle is within half a cell along each axis."""
    from scipy.spatial import cKDTree
    dim = points.shape[1]
    tree = cKDTree(positions[:, :dim])
    result = np.full((len(points), values.shape[1]), np.nan)
    for first in range(0, len(points), AT_ONCE):
        part = points[first:first + AT_ONCE]
        close = tree.query_ball_point(part, (0.5 + 1e-9) * spacing, p=np.inf, return_length=True) > 0
        lists = tree.query_ball_point(part[close], REACH * spacing, p=np.inf)
        if len(lists) == 0:
            continue
        counts = [len(each) for each in lists]
        near = np.fromiter(itertools.chain.from_iterable(lists), dtype=int, count=sum(counts))
        offsets = (positions[near][:, :dim] - np.repeat(part[close], counts, axis=0)) / spacing
        weights = np.prod(bell(offsets / REACH), axis=1) * volumes[near]
        result[first:first + AT_ONCE][close] = linear_values(offsets, weights, values[near], np.concatenate([[0], np.cumsum(counts)]))
    return result
