"""Runs of decks, and how far the results of an image are from those of its deck, in the units of the deck."""
import os
import re
import shlex

from soil_mpm.python_modules import need  # noqa: E402

need("numpy", "h5py")

import numpy as np  # noqa: E402

from decks import text_of  # noqa: E402
from dimensions import (ACCELERATION, AREA, ENERGY, FORCE, LENGTH, MASS, MOMENTUM, SPEED, STRESS, VOLUME, WHOLE, column_kind, domain_of,  # noqa: E402
                        factor, field_kind, is_plane, names_of, per_width)
from images import EXACT  # noqa: E402
from mpm_regression.differences import Scales  # noqa: E402
from mpm_regression.folders import checkpoints, fresh, run as run_program  # noqa: E402
from soil_mpm.results import Run, read_frame  # noqa: E402

BOUNDS = {"double": 1e-9, "single": 0.05}  # of a field's largest value, as mpm_regression.compare has them
DOMAINS = 1e-4  # the same where half lengths follow the soil, which are numbers of single precision in every run


class Refused(Exception):
    """The program does not take a deck, or does not end it; the message is its last line."""


def write_stl(path, low, high):
    """A box as a surface of twelve triangles."""
    corner = [[(low, high)[(n >> k) & 1][k] for k in range(3)] for n in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    lines = ["solid box"]
    for a, b, c, d in quads:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop", *("vertex " + " ".join(repr(x) for x in corner[n]) for n in triangle), "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid box"]) + "\n")


def write_deck(deck, path):
    """Writes a deck, and the surfaces of triangles that it names, beside each other."""
    out = dict(deck)
    for name, value in deck.items():
        if isinstance(value, tuple) and value and value[0] == "stl":
            stl = path.with_name(f"{path.stem}_{name}.stl")
            write_stl(stl, *value[1:])
            out[name] = str(stl)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text_of(out))
    return path


def run_deck(binary, deck, folder, ranks=1, cut=0.0, steps=0):
    """Runs a deck, or its first part and from a checkpoint the rest; what it wrote."""
    path = write_deck(deck, folder.parent / f"{folder.name}.opts")
    prefix = shlex.split(f"{os.environ.get('MPIEXEC', 'mpirun')} -n {ranks} --bind-to none") if ranks > 1 else ()
    fresh(folder)

    def start(*options):
        done = run_program(binary, path, folder, *options, prefix=prefix, status=None)
        if done.returncode:
            said = [line for line in (done.stderr + done.stdout).splitlines() if line.strip() and ": warning" not in line]
            raise Refused(f"status {done.returncode}: {' '.join(said[:2] if done.returncode == 2 else said[:3])}")
    if cut:
        start("-time_max_steps", max(1, min(steps - 1, round(cut * steps))), "-checkpoint_interval", 1e6 * deck["time_end"])
        start("-restart", checkpoints(folder)[-1])
    else:
        start()
    return Run(folder)


# ------------------------------------------------------------------------------------------------ the way back

class Back:
    """Results of an image in the units, axes and names of the deck."""

    def __init__(self, deck, image):
        self.deck, self.image, self.dim = deck, image, deck["dim"]
        free = [k for k in range(3) if k not in image.axes]  # in 2D the frames have three components too
        self.axes = [*image.axes, *free] if len(image.axes) == 3 or image.deck["dim"] == 2 else None
        if image.deck["dim"] == 3 and self.dim == 2:
            self.to = {0: 0, 1: 2, 2: 1}  # axis of the deck: of the image
            self.sign = {0: 1, 1: 1, 2: 1}
        else:
            self.to = {a: k for k, a in enumerate(self.axes)}
            self.sign = {a: (image.signs[k] if k < self.dim else 1) for k, a in enumerate(self.axes)}

    def by(self, units):
        """Factor of a quantity with these units of the deck."""
        out = 1 / factor(units, self.image.scales)
        whole = {per_width(u) for u in WHOLE} - {LENGTH, SPEED, ACCELERATION}
        fluxes = {(length, time - 1, mass) for length, time, mass in (per_width(VOLUME), per_width(MASS))}
        return out / self.image.width if self.image.deck["dim"] > self.dim and units in whole | fluxes else out

    def areas(self, values, copies=1):
        """Areas of a plane deck by those of a slab, which are of its width, and of so many particles across it."""
        return values / self.image.width * copies if self.image.deck["dim"] > self.dim else values

    def axis(self, name):
        return "xyz"[self.to["xyz".index(name)]]

    def shift_of(self, axis):
        k = self.to["xyz".index(axis)]
        return self.image.shift[k] if k < len(self.image.shift) else 0.0

    def end(self, axis, end):
        return end if self.sign["xyz".index(axis)] > 0 else {"min": "max", "max": "min"}[end]

    def column(self, column, history):
        """Values of a column of the deck by the history of the image, None where it has none."""
        units, kind, match = column_kind(column, self.deck)
        parts = match.groupdict()
        name, axis, end = parts.get("name"), parts.get("axis"), parts.get("end")
        bodies = self.image.joins.get(name, (name,))
        sign, shift, wanted = 1, 0.0, column
        if kind == "wall":
            side = parts["side"]
            wanted = f"wall_{self.axis(side)}{self.end(side, end)}_force_{self.axis(axis)}"
        elif axis:
            wanted = column.replace(f"_{axis}{end or ''}", f"_{self.axis(axis)}{self.end(axis, end) if end else ''}", 1)
        elif kind == "stress":
            pair = [self.axis(a) for a in parts["pair"]]
            wanted = next((w for w in (column[:-2] + a + b for a, b in (pair, pair[::-1])) if w in history), column)
            sign = np.prod([self.sign["xyz".index(a)] for a in parts["pair"]])
        if axis and kind in ("vector", "wall", "displacement", "extent", "place", "quantile", "flux"):
            sign = self.sign["xyz".index(axis)]
        if f"{name}_axis" in self.deck:  # what passes a section, towards the upper end of its axis
            sign *= self.sign["xyz".index(self.deck[f"{name}_axis"])]
        if kind == "quantile" and (sign < 0 or len(bodies) > 1):
            return None
        particle = kind == "displacement" and self.deck.get(f"{name}_kind") == "particle" and "_displacement_" not in column
        if kind in ("extent", "place", "quantile") or particle:
            shift = self.shift_of(axis)
        if kind == "level":
            shift = self.image.shift[-1]
        values = [history.get(wanted.replace(name, body, 1) if name else wanted) for body in bodies]
        if any(v is None for v in values):
            return None
        values = self.joined(kind, column, end, values, [history.get(f"{body}_mass") for body in bodies]) if len(bodies) > 1 else values[0]
        if values is not None and kind == "number" and column.endswith("_area"):
            values = self.areas(values)
        return None if values is None else sign * (values * self.by(units) - shift)

    @staticmethod
    def joined(kind, column, end, values, masses):
        if kind == "extent":
            return np.minimum(*values) if end == "min" else np.maximum(*values)
        if column.endswith("_grid_velocity"):
            return np.maximum(*values)
        if "_centre_" in column:
            return sum(m * v for m, v in zip(masses, values)) / sum(masses)
        return sum(values)

    def field(self, name, groups):
        """A field of the deck from a group of the image's frame."""
        units, kind = field_kind(name, self.deck)
        if kind == "periods":
            return None
        wanted = name
        if name[-2:] in ("_x", "_y", "_z"):
            wanted = f"{name[:-1]}{self.axis(name[-1])}"
            if wanted not in groups:
                return None
        if wanted not in groups:
            return None
        values = groups[wanted] * self.by(units)
        if self.image.copies > 1 and name in ("volume", "mass"):
            values = values * self.image.copies
        if name.startswith("load_area"):
            values = self.areas(values, self.image.copies)
        if kind == "vector" and name[-2] == "_":
            return values * self.sign["xyz".index(name[-1])]
        if kind == "level":
            upright = self.to[self.dim - 1] == self.image.deck["dim"] - 1
            return (values - self.image.shift[-1]) * self.sign[self.dim - 1] if upright else None
        if kind == "stress":
            return self.stress(values)
        if kind in ("place", "vector"):
            columns = []
            for a in range(3):
                k = self.to[a]
                shift = self.image.shift[k] if kind == "place" and k < len(self.image.shift) else 0.0
                columns.append(self.sign[a] * (values[:, k] - shift))
            if self.dim == 2 and self.image.deck["dim"] == 3:
                columns[2] = 0 * columns[2]
            return np.stack(columns, axis=1)
        return values

    def stress(self, values):
        pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
        place = {frozenset(pair): k for k, pair in enumerate(pairs)}
        return np.stack([values[:, place[frozenset((self.to[i], self.to[j]))]] * self.sign[i] * self.sign[j] for i, j in pairs], axis=1)


# ------------------------------------------------------------------------------------------------ comparison

def scales_of(run, deck):
    """Scale of a quantity by its units: what the others make of it (mpm_regression.differences)."""
    last = next((read_frame(f)[1] for f in reversed(run.frames)), None)
    s = Scales(run, last)
    energy = max([s.momentum * s.velocity / 2, *(np.abs(v).max() for n, v in run.history.items() if n.startswith(("energy_", "work_")))])
    # Round-off of sums of masses and volumes is that of particles, however little has passed a section.
    mass, volume = (min((fields[name].min() for fields in (last or {}).values() if len(fields.get(name, ()))), default=0.0)
                    for name in ("mass", "volume"))
    out = {MASS: mass, VOLUME: volume, STRESS: s.stress, SPEED: s.velocity, MOMENTUM: s.momentum, ENERGY: energy, FORCE: s.force,
           LENGTH: s.spacing, AREA: s.spacing**2}
    return {per_width(u) if is_plane(deck) and u in WHOLE else u: x for u, x in out.items()}, s


def relative(values, wanted, scale):
    """Largest difference over the scale, infinite where the two do not match."""
    if values.shape != wanted.shape or (np.isnan(values) != np.isnan(wanted)).any():
        return np.inf
    wanted = np.where(np.isnan(wanted), 0, wanted).astype(float)
    difference = np.abs(np.where(np.isnan(values), 0, values) - wanted).max(initial=0)
    return 0.0 if difference == 0 else difference / max(np.abs(wanted).max(), scale, 1e-300)


def common_rows(run, deck, image, other):
    """Pairs of rows of equal steps."""
    a, b = run.history["step"], other.history["step"]
    if image.rows:
        return np.arange(len(a)), np.arange(len(b))
    steps, first, second = np.intersect1d(a, b, return_indices=True)
    return first, second


def nearest(places, points):
    """Distance from each of the places to the nearest of the points, and which one that is."""
    far, which = np.empty(len(places)), np.empty(len(places), dtype=int)
    for first in range(0, len(places), 512):
        part = slice(first, first + 512)
        squares = ((places[part, None, :] - points[None, :, :]) ** 2).sum(axis=2)
        which[part] = squares.argmin(axis=1)
        far[part] = np.sqrt(squares.min(axis=1))
    return far, which


def compare_history(run, deck, image, other):
    back, found = Back(deck, image), []
    sizes, _ = scales_of(run, deck)
    mine, theirs = common_rows(run, deck, image, other)
    history = {name: values[theirs] for name, values in other.history.items()}
    for column, values in run.history.items():
        if column == "wall_time" or re.fullmatch(image.skips, column) or (not image.rows and column not in history):
            continue
        moved = back.column(column, history)
        if moved is None:
            units, kind, _ = column_kind(column, deck)
            if kind != "quantile":
                found.append((np.inf, f"history {column} is missing"))
            continue
        found.append((relative(moved, values[mine], sizes.get(column_kind(column, deck)[0], 0.0)), f"history {column}"))
    return found


def body_of(groups, image, body):
    """The fields of a body of the deck in a frame of the image."""
    parts = [groups[name] for name in image.joins.get(body, (body,))]
    return parts[0] if len(parts) == 1 else {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}


def compare_frame(run, deck, image, number, other):
    back, found = Back(deck, image), []
    wanted, given = read_frame(run.frames[number])[1], read_frame(other.frames[number])[1]
    sizes, s = scales_of(run, deck)
    for body in [*names_of(deck, "bodies"), *names_of(deck, "rigid_bodies")]:
        fields, theirs = wanted[body], body_of(given, image, body)
        if body in names_of(deck, "rigid_bodies") and image.must != EXACT:
            continue  # rigid particles only show the body, which the history has
        if len(theirs["position"]) != image.copies * len(fields["position"]):
            found.append((np.inf, f"frame {number} {body}: {len(theirs['position'])} particles and {len(fields['position'])}"))
            continue
        same = np.arange(len(fields["position"]))
        if image.must != EXACT and len(same):
            places = back.field("position", theirs)
            far, same = nearest(places, fields["position"])
            if (np.bincount(same, minlength=len(fields["position"])) != image.copies).any() or far.max() > 0.1 * s.spacing:
                found.append((far.max() / s.spacing, f"frame {number} {body} position: particles have no image"))
                continue
        for name, values in fields.items():
            moved = back.field(name, theirs)
            if moved is None:
                if field_kind(name, deck)[1] not in ("periods", "level"):
                    found.append((np.inf, f"frame {number} {body} {name} is missing"))
                continue
            units = field_kind(name, deck)[0]
            size = s.strain if name in ("plastic_strain", "parted_volume") else sizes.get(units, 0.0)
            found.append((relative(moved, values[same], size), f"frame {number} {body} {name}"))
    return found


def bound_of(deck, image):
    """The largest difference that round-off explains, relative to a field's largest value."""
    if image.must == EXACT:
        return 0.0
    return max(BOUNDS[deck["precision"]], DOMAINS if domain_of(deck) != "fixed" else 0.0)


def compare(run, deck, image, other):
    """[(how far relative to the field's largest value, where)] of every column and field, the farthest first."""
    if image.rows and len(run.history["step"]) != len(other.history["step"]):
        return [(np.inf, f"history: {len(run.history['step'])} rows and {len(other.history['step'])}")]
    if len(run.frames) != len(other.frames):
        return [(np.inf, f"{len(run.frames)} frames and {len(other.frames)}")]
    found = compare_history(run, deck, image, other)
    for number in range(len(run.frames)):
        found += compare_frame(run, deck, image, number, other)
    return sorted(found, key=lambda each: -each[0])
