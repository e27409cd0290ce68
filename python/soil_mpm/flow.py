"""Measures of how evenly soil flows in 2D: the shape of its surface, and cells inside it that hold no particle."""

import numpy as np


def columns_of(position, lower, spacing, count):
    """Per column of cells: height of the highest particle over the floor in cells, NaN where there is none, and the rows
    of cells that hold particles, as a set."""
    cell = np.floor((position[:, :2] - lower) / spacing).astype(int)
    height = np.full(count, np.nan)
    rows = [set() for _ in range(count)]
    for (column, row), y in zip(cell, (position[:, 1] - lower[1]) / spacing):
        if 0 <= column < count:
            height[column] = y if np.isnan(height[column]) else max(height[column], y)
            rows[column].add(row)
    return height, rows


def roughness(height):
    """Mean absolute second difference of the surface from column to column, in cells."""
    second = height[:-2] - 2 * height[1:-1] + height[2:]
    return np.nanmean(np.abs(second)) if np.any(np.isfinite(second)) else np.nan


def empty_cells(height, rows):
    """Number of cells that lie whole below the highest particle of their column and hold no particle."""
    return sum(len(set(range(int(top))) - held) for top, held in zip(height, rows) if np.isfinite(top))


def measures(position, lower, spacing, count):
    """Roughness of the surface in cells, and the number of empty cells inside."""
    height, rows = columns_of(position, np.asarray(lower), spacing, count)
    return roughness(height), empty_cells(height, rows)


def depths(position, volume, half_length, lower, spacing, count):
    """Depth of the soil in each column of cells, in cells: volume over width. The volume of a particle lies evenly over its
    domain. half_length: along x, m, of all particles or of each."""
    edges = lower[0] + spacing * np.arange(count + 1)
    share = np.clip((edges[:, None] - (position[:, 0] - half_length)) / (2 * half_length), 0, 1)
    return np.diff(share @ volume) / spacing**2


def unevenness(depth, least=2):
    """Standard deviation of the depth of a column from the mean of its two neighbours, over the mean depth; of columns
    that stand, with both neighbours, at least `least` cells high."""
    deep = (depth[:-2] >= least) & (depth[1:-1] >= least) & (depth[2:] >= least)
    apart = depth[1:-1] - (depth[:-2] + depth[2:]) / 2
    return apart[deep].std() / depth[1:-1][deep].mean() if deep.any() else np.nan


def depths_of_columns(position, volume, half_length, lower, spacing, counts):
    """Depth of the soil [counts] in each column of cells of a 3D mesh, in cells, as depths(). half_length: along x and y, m, [2] or
    [N, 2]; counts: cells along x and y."""
    half = np.broadcast_to(half_length, (len(position), 2))
    shares = []
    for d in (0, 1):
        edges = lower[d] + spacing * np.arange(counts[d] + 1)
        share = np.clip((edges[:, None] - (position[:, d] - half[:, d])) / (2 * half[:, d]), 0, 1)
        shares.append(np.diff(share, axis=0))
    return (shares[0] * volume) @ shares[1].T / spacing**3


def weights(x, half_length):
    """First node reached and the weights [N, 3] of the three nodes from there, along an axis; x and half lengths in cells."""
    first = np.floor(x - half_length).astype(int)
    r = x - first
    beyond = np.maximum(0, r - 1 + half_length) / (2 * half_length)
    last = half_length * beyond**2
    own = np.maximum(0, 1 - half_length - r) + half_length * (beyond - 1) ** 2
    return first, np.stack([own, 1 - own - last, last], axis=1)


def filled(position, volume, half_length, lower, upper, spacing, mirrors):
    """Share of the volume of each node of the mesh that particles fill. half_length: m, [dim] or [N, dim]; mirrors: whether the mesh
    goes on beyond its sides as a mirror image, [dim][2]."""
    dim = len(lower)
    nodes = [round((b - a) / spacing) + 1 for a, b in zip(lower, upper)]
    half = np.broadcast_to(half_length, (len(position), dim)) / spacing
    share = np.zeros([n + 2 for n in nodes])  # with the nodes beyond
    axes = [weights((position[:, d] - lower[d]) / spacing, half[:, d]) for d in range(dim)]
    for k in np.ndindex(*[3] * dim):
        weight = np.prod([axes[d][1][:, k[d]] for d in range(dim)], axis=0)
        np.add.at(share, tuple(axes[d][0] + k[d] + 1 for d in range(dim)), volume * weight / spacing**dim)
    for d in range(dim):
        share = np.moveaxis(share, d, 0)
        for at, inside, on in ((0, 2, 1), (-1, -3, -2)):
            if mirrors[d][at]:
                share[inside] += share[at]
                share[on] *= 2
                share[at] = share[inside]
        share = np.moveaxis(share, 0, d)
    return share


def filling(position, volume, half_length, lower, upper, spacing, mirrors):
    """Mean and standard deviation of filled() inside the soil: at nodes whose neighbours all are filled by half or more."""
    share = filled(position, volume, half_length, lower, upper, spacing, mirrors)
    full = share >= 0.5
    for d in range(share.ndim):
        full = np.moveaxis(full, d, 0)
        inner = full.copy()
        inner[1:-1] = full[:-2] & full[1:-1] & full[2:]
        full = np.moveaxis(inner, 0, d)
    inside = share[(slice(1, -1),) * share.ndim][full[(slice(1, -1),) * share.ndim]]
    return inside.mean(), inside.std()
