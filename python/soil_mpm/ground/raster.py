"""Grids of square cells with a value in the middle of each: ESRI ASCII files, clipping, resampling, no-data. Needs numpy."""

import sys
from pathlib import Path

import numpy as np

NO_DATA = -9999


class Raster:
    """values[row, column] from the lowest y up, NaN where there is no data; x, y the lower left corner and cell the edge of
    a cell [m, or the unit of the source]."""

    def __init__(self, values, x, y, cell):
        self.values = np.asarray(values, dtype=float)
        self.x, self.y, self.cell = float(x), float(y), float(cell)

    @property
    def extent(self):
        """x0, x1, y0, y1"""
        rows, columns = self.values.shape
        return self.x, self.x + columns * self.cell, self.y, self.y + rows * self.cell

    def centres(self):
        """x of the columns and y of the rows, in the middle of cells."""
        rows, columns = self.values.shape
        return self.x + (np.arange(columns) + 0.5) * self.cell, self.y + (np.arange(rows) + 0.5) * self.cell

    def at(self, x, y):
        """Linear between the middles of cells, as the program has it but for the four triangles of a cell."""
        columns, rows = self.centres()
        u = np.clip((np.asarray(x) - columns[0]) / self.cell, 0, len(columns) - 1)
        v = np.clip((np.asarray(y) - rows[0]) / self.cell, 0, len(rows) - 1)
        i, j = np.minimum(u.astype(int), max(len(columns) - 2, 0)), np.minimum(v.astype(int), max(len(rows) - 2, 0))
        k, m = np.minimum(i + 1, len(columns) - 1), np.minimum(j + 1, len(rows) - 1)
        s, t, z = u - i, v - j, self.values
        return (1 - t) * ((1 - s) * z[j, i] + s * z[j, k]) + t * ((1 - s) * z[m, i] + s * z[m, k])


class WrongRaster(Exception):
    """One line that says what a file, or a request, should have been."""


def read_ascii(path):
    """An ESRI ASCII grid, by the rules of the program."""
    words = Path(path).read_text().split()
    header, first = {}, 0
    while first + 1 < len(words) and words[first][0].isalpha() and words[first].lower() != "nan":
        header[words[first].lower()], first = float(words[first + 1]), first + 2
    try:
        columns, rows, cell = int(header["ncols"]), int(header["nrows"]), header["cellsize"]
        x = header["xllcorner"] if "xllcorner" in header else header["xllcenter"] - cell / 2
        y = header["yllcorner"] if "yllcorner" in header else header["yllcenter"] - cell / 2
        values = np.array(words[first:], dtype=float)
    except (KeyError, ValueError) as error:
        raise WrongRaster(f"{path}: takes an ESRI ASCII grid; {error} is missing or no number") from None
    if values.size != columns * rows:
        raise WrongRaster(f"{path}: takes {columns} x {rows} values, as its header says; it has {values.size}")
    values[values == header.get("nodata_value", NO_DATA)] = np.nan
    return Raster(values.reshape(rows, columns)[::-1], x, y, cell)


def write_ascii(path, raster):
    rows, columns = raster.values.shape
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {raster.x:.10g}", f"yllcorner {raster.y:.10g}",
             f"cellsize {raster.cell:.10g}", f"NODATA_value {NO_DATA}"]
    for row in np.where(np.isnan(raster.values), NO_DATA, raster.values)[::-1]:
        lines.append(" ".join(f"{value:.9g}" for value in row))
    Path(path).write_text("\n".join(lines) + "\n")


def read_geotiff(path, band=1, crs=None):
    """A raster that rasterio can open: one with degrees, or with cells that are not square, in metres of the given or the
    nearest UTM system. The raster and the name of its coordinate system."""
    try:
        import rasterio
        from rasterio.enums import Resampling
        from rasterio.warp import calculate_default_transform, reproject
    except ImportError:
        raise WrongRaster(f"{path}: takes the Python package rasterio (apt-get install python3-rasterio, or "
                          "pip install rasterio); ESRI ASCII grids need none") from None
    try:
        with rasterio.open(path) as source:
            if band > source.count:
                raise WrongRaster(f"{path}: takes a band of at most {source.count}")
            values = source.read(band, masked=True).astype(float).filled(np.nan)
            transform, own = source.transform, source.crs
            target = rasterio.CRS.from_user_input(crs) if crs else utm_of(source) if own and own.is_geographic else own
            square = abs(transform.a + transform.e) < 1e-6 * transform.a and transform.b == transform.d == 0
            if target != own or not square:
                if own is None:
                    raise WrongRaster(f"{path}: takes a raster of square cells, or one with a coordinate system")
                height, width = values.shape
                transform, width, height = calculate_default_transform(own, target, width, height, *source.bounds)
                moved = np.full((height, width), np.nan)
                reproject(values, moved, src_transform=source.transform, src_crs=own, src_nodata=np.nan, dst_nodata=np.nan,
                          dst_transform=transform, dst_crs=target, resampling=Resampling.bilinear)
                values = moved
    except (rasterio.errors.RasterioError, OSError) as error:
        raise WrongRaster(f"{path}: takes a raster that rasterio can read: {error}") from None
    y = transform.f - values.shape[0] * transform.a
    return Raster(values[::-1], transform.c, y, transform.a), target.to_string() if target else ""


def utm_of(source):
    """The zone of the Universal Transverse Mercator system, on WGS 84, around the middle of a raster in degrees."""
    import rasterio
    longitude, latitude = (source.bounds.left + source.bounds.right) / 2, (source.bounds.bottom + source.bounds.top) / 2
    zone = int((longitude + 180) // 6) % 60 + 1
    return rasterio.CRS.from_epsg((32600 if latitude >= 0 else 32700) + zone)


def clip(raster, box):
    """The cells whose middles are in x0, y0, x1, y1."""
    x0, y0, x1, y1 = box
    columns, rows = raster.centres()
    i, j = np.flatnonzero((columns >= x0) & (columns <= x1)), np.flatnonzero((rows >= y0) & (rows <= y1))
    if i.size == 0 or j.size == 0:
        low_x, high_x, low_y, high_y = raster.extent
        raise WrongRaster(f"--clip: takes a box that holds cells of the raster, which is from {low_x:.10g},{low_y:.10g} to "
                          f"{high_x:.10g},{high_y:.10g}")
    values = raster.values[j[0]:j[-1] + 1, i[0]:i[-1] + 1]
    return Raster(values, raster.x + i[0] * raster.cell, raster.y + j[0] * raster.cell, raster.cell)


def hat_integrals(count, edges):
    """Integrals, from the first cell's side to each edge [cells], of the functions by which values in the middles of cells are
    interpolated: linear, and level in the outer halves of the outermost cells."""
    u = np.asarray(edges)[:, None] - 0.5 - np.arange(count)
    v = np.clip(u, -1, 1)
    inner = np.where(v < 0, (1 + v) ** 2 / 2, 1 - (1 - v) ** 2 / 2)
    inner[:, 0] = np.where(u[:, 0] < 0, u[:, 0] + 0.5, inner[:, 0])
    inner[:, -1] = np.where(u[:, -1] > 0, 0.5 + u[:, -1], inner[:, -1])
    return inner


def axis_weights(count, cell, new):
    """Weights [new cells, cells] of one direction: means of what is linear between the cells over new ones that are larger, else
    linear."""
    size = max(int(np.floor(count * cell / new + 1e-9)), 1)
    weights = np.zeros((size, count))
    if new > cell:
        weights = np.diff(hat_integrals(count, np.arange(size + 1) * new / cell), axis=0)
    else:
        at = np.clip((np.arange(size) + 0.5) * new / cell - 0.5, 0, count - 1)
        left = np.minimum(at.astype(int), max(count - 2, 0))
        weights[np.arange(size), left] = 1 - (at - left)
        weights[np.arange(size), np.minimum(left + 1, count - 1)] += at - left
    return weights / weights.sum(axis=1, keepdims=True)


def resample(raster, cell):
    """Cells of another size, from the same lower left corner; a new cell that no-data touches has none."""
    rows, columns = raster.values.shape
    along, across = axis_weights(rows, raster.cell, cell), axis_weights(columns, raster.cell, cell)
    missing = np.isnan(raster.values)
    values = along @ np.where(missing, 0, raster.values) @ across.T
    values[along @ missing @ across.T > 1e-9] = np.nan
    return Raster(values, raster.x, raster.y, cell)


def fill(raster):
    """No-data from the cells around it: linear between them, and the nearest one where it reaches the rim. How many."""
    from scipy.interpolate import griddata
    from scipy.ndimage import binary_dilation
    missing = np.isnan(raster.values)
    if missing.all():
        raise WrongRaster("--fill: takes a raster that has data")
    if not missing.any():
        return raster, 0
    known = binary_dilation(missing, iterations=2) & ~missing
    points, values = np.argwhere(known), raster.values[known]
    holes = np.argwhere(missing)
    near = griddata(points, values, holes, method="nearest")
    try:
        inner = griddata(points, values, holes, method="linear")
    except Exception:  # points on one line have no triangles
        inner = near
    filled = raster.values.copy()
    filled[missing] = np.where(np.isnan(inner), near, inner)
    return Raster(filled, raster.x, raster.y, raster.cell), int(missing.sum())


def fail(error):
    print(f"{Path(sys.argv[0]).name}: {error}", file=sys.stderr)
    sys.exit(2)
