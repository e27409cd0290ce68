"""Fields of a run's particles at one time, and cuts through them in 3D. Needs matplotlib."""

import sys
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

from soil_mpm.fields import known_fields
from soil_mpm.plot.curves import COLOURS, save
from soil_mpm.plot.outlines import outline
from soil_mpm.plot.surfaces import section_of_triangles
from soil_mpm.results import read_frame, stage_of, units_of
from soil_mpm.runout import profile, slides, time_of_frame

DEFAULT_FIELDS = ["grid_velocity", "plastic_strain"]


class NothingToDraw(Exception):
    """Raised where the data of a picture are not there; its text is the line for the user."""


# ---------------------------------------------------------------------------------------------- colours


def colours_of(name, field):
    return "RdBu_r" if field.signed else "magma_r" if name == "plastic_strain" else "viridis"


def limits_of(field, values):
    """Where the colours begin and end, so that a few strays do not bleach all others."""
    top = np.percentile(np.abs(values) if field.signed else values, 99.8) or 1
    return (-top, top) if field.signed else (0, top)


# ---------------------------------------------------------------------------------------------- cuts of 3D


@dataclass
class Slice:
    """A plane normal to an axis; without `at` [m] it goes through the moving rigid's middle, else the bodies'."""
    axis: int = 1
    at: float = None


def parse_slice(text):
    """The Slice of "y=0.5", "z" or "auto"; ValueError for anything else."""
    if text == "auto":
        return Slice()
    axis, equals, number = text.partition("=")
    if axis not in ("x", "y", "z") or bool(equals) != bool(number):
        raise ValueError(text)
    at = float(number) if equals else None
    if at is not None and not np.isfinite(at):
        raise ValueError(text)
    return Slice("xyz".index(axis), at)


def middle_of(run, positions, axis):
    """Middle of some points along an axis [m]; where they end at a roller side, a plane of symmetry, that side, unless
    they fill the mesh."""
    lower, upper = positions[:, axis].min(), positions[:, axis].max()
    corners = [run.numbers(f"mesh_{end}", [np.nan] * 3)[axis] for end in ("lower", "upper")]
    near = run.number("mesh_spacing")
    at_end = [abs(place - corner) < near and run.text(f"mesh_{'xyz'[axis]}{end}", "roller") == "roller"
              for place, corner, end in zip((lower, upper), corners, ("min", "max"))]
    fills = upper - lower > 0.9 * (corners[1] - corners[0])
    return corners[at_end.index(True)] if any(at_end) and not fills else (lower + upper) / 2


def place_of(run, groups, bodies, cut, reach):
    """Where a Slice cuts its axis, m: through the first moving rigid that has soil within `reach` [m] of there."""
    if cut.at is not None:
        return cut.at
    soil = np.concatenate([groups[name]["position"] for name in bodies])
    for name in run.moving_rigids():
        if name in groups and len(groups[name]["position"]):
            place = middle_of(run, groups[name]["position"], cut.axis)
            if np.abs(soil[:, cut.axis] - place).min() < reach:
                return place
    return middle_of(run, soil, cut.axis)


class Scene:
    """A frame as it is drawn: its bodies, the plane seen, and where that is. In 3D only particles at the cut are kept."""

    def __init__(self, run, frame, cut=None):
        self.run, self.frame = run, frame
        self.dim = int(run.text("dim", "2"))
        self.time, groups = read_frame(frame)
        self.units = units_of(frame)
        self.groups = {name: fields for name, fields in groups.items() if "position" in fields}
        self.triangles = {name: groups[f"{name}_surface"] for name in self.groups if "triangles" in groups.get(f"{name}_surface", {})}
        self.bodies = [name for name, fields in self.groups.items() if len(fields["position"]) and self.is_body(name, fields)]
        stage = stage_of(frame)
        self.plane, self.place = [0, 1], None
        self.where = f"t = {self.time:.4g} s" + (f", stage {stage}" if stage else "")
        if self.bodies and self.dim == 3:
            self.cut_at(cut)
        elif cut is not None and self.dim == 2:
            raise NothingToDraw("--slice: the run is in 2D")
        if not self.bodies:
            raise NothingToDraw(f"{frame} holds no body: no field")

    def is_body(self, name, fields):
        named = self.run.words("bodies")
        return name in named if named else "volume" in fields

    def size(self, name):
        """Edge of a body's or rigid's particles, m."""
        if "volume" in self.groups[name]:
            volume = self.groups[name]["volume"]
            if self.run.text("geometry", "plane_strain") == "axisymmetric":  # that of the whole ring
                volume = volume / (2 * np.pi * self.groups[name]["position"][:, 0])
            return np.median(volume) ** (1 / self.dim) if len(volume) else 0.0
        return self.run.number("mesh_spacing", 1.0) / self.run.number(f"{name}_particles_per_cell", 2 if name in self.bodies else 4)

    def cut_at(self, cut):
        """Keeps the particles near the cut, by default that of Slice()."""
        cut = cut or Slice()
        reach = 0.75 * max(self.size(name) for name in self.bodies)
        place = place_of(self.run, self.groups, self.bodies, cut, reach)
        for name, fields in self.groups.items():
            inside = np.abs(fields["position"][:, cut.axis] - place) < reach
            self.groups[name] = {key: values[inside] for key, values in fields.items()}
        kept = [name for name in self.bodies if len(self.groups[name]["position"])]
        if self.bodies and not kept:
            raise NothingToDraw(f"--slice: no particle of a body is at {'xyz'[cut.axis]} = {place:.4g} m in {self.frame}")
        self.bodies = kept
        self.plane = [axis for axis in range(3) if axis != cut.axis]
        self.place = place
        self.where += f", {'xyz'[cut.axis]} = {place:.4g} m"

    def box(self):
        """Lower and upper corner of bodies and moving rigids, with a margin."""
        seen = [name for name in self.groups if name in self.bodies or name in self.run.moving_rigids()]
        points = np.concatenate([self.groups[name]["position"][:, self.plane] for name in seen])
        lower, upper = points.min(axis=0), points.max(axis=0)
        margin = 0.02 * (upper - lower).max() or 1
        return lower - margin, upper + margin

    def known(self):
        """{name: Field} of the first body of the frame."""
        return known_fields(self.groups[self.bodies[0]], self.units)

    def field(self, name):
        """The Field of a name; NothingToDraw where a body has no such data."""
        known = self.known()
        if name not in known:
            raise NothingToDraw(f"--field: given \"{name}\", takes of {self.frame}: {', '.join(known)}")
        return known[name]

    def values(self, name):
        return np.concatenate([self.field(name).of(self.groups[body]) for body in self.bodies])

    def limits(self, name):
        """Where the colours of a field begin and end. Plastic strain ends where softening clay has lost 95 % of what it can
        lose: more changes nothing, and would leave one colour to all that is not a shear band."""
        least, most = limits_of(self.field(name), self.values(name))
        lost = [self.softening_strain(self.run.text(f"{body}_material")) for body in self.bodies]
        return (least, min(most, max(lost))) if name == "plastic_strain" and all(lost) else (least, most)

    def softening_strain(self, material):
        """The strain at which a material has lost 95 % of what it can lose, on this mesh; 0 where it does not soften."""
        if self.run.text(f"{material}_model") != "softening_clay":
            return 0.0
        cell = self.run.number("mesh_spacing", 1.0)
        return self.run.number(f"{material}_xi95") * self.run.number(f"{material}_xi95_cell", cell) / cell

    def outlines(self, rigid):
        """Corners [N, 2] of a rigid and of each of its parts in the plane seen [m], None where they are not known or its particles
        lie elsewhere. Those of triangles are as they are turned."""
        parts, across = self.run.words(f"{rigid}_parts"), 3 - sum(self.plane)
        if rigid in self.triangles and not parts:
            return section_of_triangles(*(self.triangles[rigid][key] for key in ("vertices", "triangles")), across, self.place)
        points, moved = self.groups[rigid]["position"][:, self.plane], self.run.displacement(rigid, self.time)
        if not len(points) or moved is None:
            return None
        at = None if self.place is None else self.place - moved[across]
        found = [outline(self.run, name, self.plane, at) for name in parts or [rigid]]
        if self.dim == 3 and parts:  # some are elsewhere; the points tell whether one is missing
            found = [corners for corners in found if corners is not None]
        if not found or any(corners is None for corners in found):
            return None
        whole, reach = self.moved_with(rigid, np.concatenate(found), points, moved), 2.5 * self.size(rigid)
        ends = [np.abs(end(whole, axis=0) - end(points, axis=0)).max() for end in (np.min, np.max)]
        return np.split(whole, np.cumsum([len(corners) for corners in found])[:-1]) if max(ends) <= reach else None

    def moved_with(self, rigid, corners, points, moved):
        """Corners as the rigid has moved, and in 2D turned."""
        corners = corners + moved[self.plane]
        angle = self.run.angle(rigid, self.time)
        if angle != 0:  # about the centre of mass
            given = self.run.text(f"{rigid}_centre_of_mass", "")
            centre = points.mean(axis=0) if not given else np.array([float(x) for x in given.split(",")]) + moved
            corners = centre + (corners - centre) @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
        return corners

    def draw(self, axes, name, limits=None, box=None):
        """Draws a field in colour and the rigids in grey: [(collection, particle's size [m])], the size yet to be set."""
        field, values = self.field(name), self.values(name)
        least, most = limits or self.limits(name)
        drawn = []
        for body in self.bodies:
            points = self.groups[body]["position"][:, self.plane]
            drawn.append((axes.scatter(*points.T, c=field.of(self.groups[body]), marker="s", lw=0, vmin=least, vmax=most,
                                       cmap=colours_of(name, field)), self.size(body)))
        beyond = ["neither", "min", "max", "both"][(values.min() < least) + 2 * (values.max() > most)]
        axes.figure.colorbar(drawn[0][0], ax=axes, shrink=0.8, pad=0.02, extend=beyond)
        for rigid in sorted(self.groups.keys() - set(self.bodies) - {"nodes"}):
            parts, points = self.outlines(rigid), self.groups[rigid]["position"][:, self.plane]
            for corners in parts or []:
                axes.fill(*corners.T, color="0.25", lw=0, zorder=2)
            if parts is None:
                drawn.append((axes.scatter(*points.T, color="0.25", marker="s", lw=0), self.size(rigid)))
        lower, upper = box or self.box()
        axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), title=f"{field.title}, {self.where}",
                 xlabel="xyz"[self.plane[0]] + " (m)", ylabel="xyz"[self.plane[1]] + " (m)", aspect="equal")
        return drawn


def size_markers(figure, drawn):
    """Gives the square markers of each (collection, size [m]) that size in the finished layout, half as much more so
    that no gap shows where the soil has stretched."""
    figure.canvas.draw()
    for collection, size in drawn:
        to_pixels = collection.axes.transData.transform
        points = (to_pixels([size, 0]) - to_pixels([0, 0]))[0] * 72 / figure.dpi
        collection.set_sizes([max(1.5 * points, 0.8) ** 2])


# ---------------------------------------------------------------------------------------------- pictures


def default_fields(scene):
    """The fields that are drawn where none is asked for: those of DEFAULT_FIELDS that the frame has, else its first."""
    known = scene.known()
    found = [name for name in DEFAULT_FIELDS if name in known] or list(known)[:1]
    if not found:
        raise NothingToDraw(f"{scene.frame} holds no field of a body beside the position")
    return found


def panels(count, box, title_room=1.1):
    """A figure with `count` panels of the shape of a box: on top of one another where it is wide."""
    lower, upper = box
    ratio = (upper - lower)[1] / (upper - lower)[0]
    if ratio < 0.5 or count == 1:
        height = min(max(11 * ratio, 0.8), 9) + title_room
        rows, columns, size = count, 1, (12 if ratio < 0.8 else min(9 / ratio + 3, 12), count * height)
    else:
        rows, columns, size = 1, count, (6.5 * count, min(5.2 * ratio, 9) + 0.9)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    return figure, axes.ravel()


def draw_field(run, fields=(), time=None, cut=None):
    """field.png: some fields in the last frame, or the one nearest to a time [s]. Returns its path, or None without
    frames."""
    frame = run.frame if time is None else run.frame_near(time)
    if frame is None:
        print(f"plot: {run.folder}/frames holds no frame: no field", file=sys.stderr)
        return None
    scene = Scene(run, frame, cut)
    fields = fields or default_fields(scene)
    figure, axes = panels(len(fields), scene.box())
    drawn = [mark for each, name in zip(axes, fields) for mark in scene.draw(each, name)]
    size_markers(figure, drawn)
    return save(figure, run.folder / "field.png")


def draw_profiles(axes, scene, stations=6):
    """Velocity in x over the height of the first body at some places along it."""
    fields, spacing = scene.groups[scene.bodies[0]], scene.run.number("mesh_spacing")
    x = fields["position"][:, 0]
    lower, upper = np.percentile(x, [2, 98])
    for station, colour in zip(np.linspace(lower, upper, stations), COLOURS):
        height, velocity = profile(fields, station, 4 * spacing, scene.plane[1], spacing)
        if len(height):
            axes.plot(velocity, height, ".-", color=colour, label=f"x = {station:.1f} m")
    axes.set(xlabel="velocity in x (m/s)", ylabel="height (m)", title="velocity over the height")
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8)


def draw_velocity(run, time=None, cut=None):
    """velocity.png: velocity of the nodes in the frame nearest to a time [s], if none is given that of the largest kinetic
    energy, and its profiles over the height. Returns its path, or None if nothing slides."""
    if not slides(run) or not run.frames:
        return None
    scene = Scene(run, run.frame_near(time_of_frame(run) if time is None else time), cut)
    if "grid_velocity" not in scene.known() or scene.plane[0] != 0:
        return None
    lower, upper = scene.box()
    height = min(max(11 * (upper - lower)[1] / (upper - lower)[0], 1.2), 9)
    figure, axes = plt.subplots(2, 1, figsize=(12, height + 5), height_ratios=(height + 0.8, 4.2), layout="constrained")
    drawn = scene.draw(axes[0], "grid_velocity")
    draw_profiles(axes[1], scene)
    size_markers(figure, drawn)
    return save(figure, run.folder / "velocity.png")
