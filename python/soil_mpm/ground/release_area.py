"""Polygons that bound a mass to release: read from GeoJSON or CSV, and the distance of points inside them to their rim. Needs
numpy, and rasterio for a GeoJSON in degrees."""

import csv
import json
from pathlib import Path

import numpy as np

from soil_mpm.ground.raster import WrongRaster


def polygons_of(geometry):
    """The rings of a GeoJSON object: of all its polygons, outer ones and holes alike."""
    kind = geometry.get("type")
    if kind == "FeatureCollection":
        return [ring for feature in geometry["features"] for ring in polygons_of(feature)]
    if kind == "Feature":
        return polygons_of(geometry["geometry"])
    if kind == "GeometryCollection":
        return [ring for part in geometry["geometries"] for ring in polygons_of(part)]
    if kind == "Polygon":
        return geometry["coordinates"]
    if kind == "MultiPolygon":
        return [ring for polygon in geometry["coordinates"] for ring in polygon]
    return []


def read_csv(path):
    """One ring: x and y in the first two columns, below a header or not."""
    rows = [row for row in csv.reader(Path(path).read_text().splitlines()) if row and not row[0].lstrip().startswith("#")]
    try:
        float(rows[0][0])
    except (ValueError, IndexError):
        rows = rows[1:]
    return [[[float(word) for word in row[:2]] for row in rows]]


def read_rings(path):
    """Rings [points, 2] of a file, closed."""
    try:
        rings = read_csv(path) if Path(path).suffix.lower() in (".csv", ".txt") else polygons_of(json.loads(Path(path).read_text()))
        rings = [np.array([point[:2] for point in ring], dtype=float) for ring in rings]
    except (ValueError, KeyError, TypeError, AttributeError, IndexError):
        rings = []
    if not rings or not all(ring.ndim == 2 and ring.shape[1] == 2 and len(ring) > 2 and np.isfinite(ring).all() for ring in rings):
        raise WrongRaster(f"{path}: takes a GeoJSON with polygons, or a CSV with x,y of 3 vertices or more")
    return [ring if (ring[0] == ring[-1]).all() else np.vstack([ring, ring[:1]]) for ring in rings]


def to_site(path, rings, crs):
    """Rings in degrees, as GeoJSON has by its standard, in metres of the coordinate system of the site."""
    if Path(path).suffix.lower() in (".csv", ".txt") or not all((np.abs(ring) <= (180, 90)).all() for ring in rings):
        return rings
    try:
        from rasterio.warp import transform
    except ImportError:
        transform = None
    if transform is None or not crs:
        raise WrongRaster(f"{path}: takes metres of the site; degrees need the Python package rasterio and the coordinate system "
                          "that scripts/terrain keeps beside the terrain")
    return [np.array(transform("EPSG:4326", crs, *ring.T)).T for ring in rings]


def depth_inside(rings, x, y):
    """Distance to the rim [m] of points inside the rings (an odd number of them is around the point), 0 outside."""
    inside = np.zeros(x.shape, dtype=bool)
    nearest = np.full(x.shape, np.inf)
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring[:-1], ring[1:]):
            crosses = (ay > y) != (by > y)
            if ay != by:
                inside ^= crosses & (x < ax + (y - ay) * (bx - ax) / (by - ay))
            length = (bx - ax) ** 2 + (by - ay) ** 2
            along = np.clip(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length, 0, 1) if length > 0 else 0 * x
            nearest = np.minimum(nearest, np.hypot(x - ax - along * (bx - ax), y - ay - along * (by - ay)))
    return np.where(inside, nearest, 0.0)
