"""Values of particles at any points: weighted fits of linear functions. Needs numpy and scipy."""

import numpy as np

REACH = 1.5  # cells, from a point to the particles that count for it


def bell(r: np.ndarray) -> np.ndarray:
    a = np.minimum(np.abs(r), 1)
    return (1 - a) ** 2 * (1 + 2 * a)


def linear_values(offsets: np.ndarray, weights: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Weighted fit of linear functions, at the place itself; the mean where the points do not determine a slope."""
    ones = np.column_stack([np.ones(len(offsets)), offsets])
    matrix = ones.T @ (ones * weights[:, None])
    mean = weights @ values / weights.sum()
    spread = matrix / weights.sum()
    spread = spread[1:, 1:] - np.outer(spread[0, 1:], spread[0, 1:])
    if np.linalg.eigvalsh(spread).min() < 0.01:
        return mean
    return np.linalg.solve(matrix, ones.T @ (weights[:, None] * values))[0]


def sample(positions: np.ndarray, volumes: np.ndarray, values: np.ndarray, points: np.ndarray, spacing: float) -> np.ndarray:
    """values [N, k] of particles at points [n, dim], NaN where no particle is within half a cell along each axis."""
    from scipy.spatial import cKDTree
    dim = points.shape[1]
    tree = cKDTree(positions[:, :dim])
    result = np.full((len(points), values.shape[1]), np.nan)
    for n, point in enumerate(points):
        near = tree.query_ball_point(point, REACH * spacing, p=np.inf)
        offsets = (positions[near][:, :dim] - point) / spacing
        if len(near) == 0 or not (np.abs(offsets).max(axis=1) <= 0.5 + 1e-9).any():
            continue
        result[n] = linear_values(offsets, np.prod(bell(offsets / REACH), axis=1) * volumes[near], values[near])
    return result
