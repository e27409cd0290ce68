"""Measures that cases take from the curves and frames of a run."""

import numpy as np

from soil_mpm.results import read_frame

trapezoid = np.trapezoid if hasattr(np, "trapezoid") else np.trapz  # NumPy 2 has renamed it


def slope(t, y, start, end=np.inf):
    """Slope of the straight line of least squares through y(t) over start <= t <= end."""
    inside = (t >= start) & (t <= end)
    return np.polyfit(t[inside], y[inside], 1)[0]


def order(sizes, errors):
    """Order of convergence: slope of log(error) over log(size), by least squares."""
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def last_frame(run, body):
    """Fields of a body in the last frame: {name: array}, lengths in m, stress in Pa (xx yy zz xy yz zx)."""
    return read_frame(run.frame)[1][body]


def first_frame(run, body):
    return read_frame(min(run.folder.glob("frames/frame_*.h5")))[1][body]


def mesh_options(dim, spacing, lower, upper):
    """The options of a mesh; corners [dim], m."""
    corner = {name: ",".join(f"{x:.12g}" for x in place) for name, place in (("lower", lower), ("upper", upper))}
    return f"-dim {dim} -mesh_spacing {spacing:.12g} -mesh_lower {corner['lower']} -mesh_upper {corner['upper']}"
