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
