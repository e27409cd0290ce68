"""Units of pictures: the multiple of an SI unit for the numbers of an axis. Needs numpy."""

import numpy as np

MULTIPLES = {"N": [("N", 1.0), ("kN", 1e3), ("MN", 1e6), ("GN", 1e9)], "Pa": [("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)],
             "kg": [("kg", 1.0), ("t", 1e3), ("kt", 1e6), ("Mt", 1e9)], "J": [("J", 1.0), ("kJ", 1e3), ("MJ", 1e6), ("GJ", 1e9)]}
USUAL = {"N": 1, "Pa": 1}  # an engineer's kN and kPa
LARGEST, LEAST = 1e4, 0.1  # of an axis, in its unit

# Units of columns of the history, by the end of their names: docs/results.md.
ENDS = [("step", "-"), ("wall_time", "s"), ("time", "s"), ("dt", "s"), ("_pressure", "Pa"), ("_area", "m2"), ("_mass_flux", "kg/s"), ("_volume_flux", "m3/s"),
        ("_mass", "kg"), ("_volume", "m3"), ("_grid_velocity", "m/s"), ("_speed", "m/s"), ("_depth", "m"), ("_surface", "m"), ("_base", "m"),
        ("_strays", "-"), ("_limited", "-"), ("_put_back", "-"), ("_stretched", "-"), ("_particles", "-"), ("_merged", "-"),
        ("empty_cells", "-"), ("stage", "-"), ("unbalanced_ratio", "-"), ("energy", "J")]
PARTS = [("_momentum_flux_", "N"), ("_force_", "N"), ("_stress_", "Pa"), ("_velocity_", "m/s"), ("_momentum_", "kg m/s"), ("_displacement_", "m"),
         ("_centre_", "m"), ("energy_", "J"), ("work_", "J")]
EXTENSIVE = {"N", "kg", "J", "kg/s", "m3/s", "m3", "m2", "kg m/s"}  # of the modelled part, which is a metre wide in plane strain


def is_plane(run):
    return run.text("dim", "2") == "2" and run.text("geometry", "plane_strain") == "plane_strain"


def unit_of(column):
    """SI unit of a column of the history; empty where it is not known."""
    for end, unit in ENDS:
        if column == end or column.endswith(end):
            return unit
    for part, unit in PARTS:
        if part in column or column.startswith(part):
            return unit
    last = column.rpartition("_")[2]
    return "m" if last and last[0] in "xyz" and last[1:] in ("", "min", "max", "q999") else ""


def scale(values, unit):
    """(name, size) of the multiple of an SI unit for numbers in that unit: kN and kPa, and others where these give numbers that are
    too large or too small for an axis. A unit with no multiples is its own."""
    base, slash, rest = unit.partition("/")
    multiples = MULTIPLES.get(base)
    if multiples is None:
        return unit, 1.0
    finite = np.abs(np.asarray(values, dtype=float)[np.isfinite(values)])
    largest, k = finite.max(initial=0.0), USUAL.get(base, 0)
    while k + 1 < len(multiples) and largest >= LARGEST * multiples[k][1]:
        k += 1
    while k > 0 and 0 < largest < LEAST * multiples[k][1]:
        k -= 1
    return multiples[k][0] + slash + rest, multiples[k][1]


def axis_unit(run, values, unit):
    """(text, size): scale() with "/m" behind it where it is of a metre of width."""
    name, size = scale(values, unit)
    if unit not in EXTENSIVE or not is_plane(run):
        return name, size
    return ("m3/m" if name == "m3" else "m" if name == "m2" else f"{name}/m" if "/" not in name else f"{name} a metre"), size
