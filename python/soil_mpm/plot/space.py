"""Particles of a frame in space: as boxes, points, or the surface that is round them. Needs numpy and PyVista."""

import numpy as np
import pyvista

from soil_mpm.fields import known_fields
from soil_mpm.plot.fields import NothingToDraw, Scene, place_of
from soil_mpm.plot.solids import fits, keep_side, moved, solid, with_table

MOST_CELLS = 4e8      # of the grid that finds hidden particles
MOST_NODES = 5e7      # of the grid of a surface
CORNERS = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (0, 4, 7, 3)]
SEAM = 1.04           # of a cube over its particle, so that no gap shows where the soil has stretched


class SpaceScene(Scene):
    """A frame of a run in 3D with all its particles. towards: direction [3] to the camera; with a Slice, what lies between its plane and
    the camera is left out. names: bodies and rigid bodies that are seen, by default all."""

    def __init__(self, run, frame, cut=None, towards=(0.5, -0.8, 0.5), names=()):
        self.towards, self.names, self.half = np.asarray(towards, dtype=float), list(names), None
        self.contacts, self.centres = {}, {}
        if int(run.text("dim", "2")) != 3:
            raise NothingToDraw("--view: the run is in 2D; field.png shows it")
        super().__init__(with_table(run), frame, cut)
        self.plane = [0, 1, 2]

    def cut_at(self, cut):
        """Takes contact apart from bodies, and keeps what is to be seen."""
        self.contacts = {name: self.groups.pop(name) for name in list(self.groups) if "contact_force" in self.groups[name]}
        self.groups.pop("nodes", None)
        unknown = [name for name in self.names if name not in self.groups]
        if unknown:
            raise NothingToDraw(f"--bodies: given \"{unknown[0]}\", takes of {self.frame}: {', '.join(self.groups)}")
        reach = 0.75 * max(self.size(name) for name in self.bodies)
        place = None if cut is None else place_of(self.run, self.groups, self.bodies, cut, reach)
        self.groups = {name: fields for name, fields in self.groups.items() if not self.names or name in self.names}
        self.centres = {name: fields["position"].mean(axis=0) for name, fields in self.groups.items() if len(fields["position"])}
        self.bodies = [name for name in self.bodies if name in self.groups]
        if not self.bodies:
            raise NothingToDraw(f"--bodies: given {','.join(self.names)}, takes a deformable body among them")
        if cut is not None:
            self.cut_off(cut, place)

    def cut_off(self, cut, place):
        """Leaves out the particles between a plane and the camera."""
        sign = 1 if self.towards[cut.axis] >= 0 else -1
        self.half = -sign * np.eye(3)[cut.axis], place * np.eye(3)[cut.axis]
        for groups in (self.groups, self.contacts):
            for name, fields in groups.items():
                kept = sign * (fields["position"][:, cut.axis] - place) <= 1e-9 * abs(place)
                groups[name] = {key: values[kept] for key, values in fields.items()}
        self.bodies = [name for name in self.bodies if len(self.groups[name]["position"])]
        if not self.bodies:
            raise NothingToDraw(f"--slice: no particle of a body is behind {'xyz'[cut.axis]} = {place:.4g} m in {self.frame}")
        self.where += f", {'xyz'[cut.axis]} = {place:.4g} m"

    def rigids(self):
        return sorted(self.groups.keys() - set(self.bodies))

    def box(self):
        """Lower and upper corner [3] of all that is seen, m."""
        ends = []
        for name, fields in self.groups.items():
            if len(fields["position"]):
                half = self.size(name) / 2
                ends.append((fields["position"].min(axis=0) - half, fields["position"].max(axis=0) + half))
        limits = [np.array(self.run.numbers(f"mesh_{end}")) for end in ("lower", "upper")]
        if self.half is not None:
            normal, point = self.half
            limits = [np.where(sign * normal > 0, point, limit) for sign, limit in zip((1, -1), limits)]
        return tuple(np.clip(end, *limits) for end in (np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)))

    def known(self):
        """{name: Field} of the bodies of the frame, each as the first body that has it."""
        found = {}
        for body in self.bodies:
            found = {**known_fields(self.groups[body], self.units), **found}
        return found

    def values_of(self, body, name):
        """Values [N] of a field; None where the body has no such data."""
        field = known_fields(self.groups[body], self.units).get(name)
        return None if field is None else self.field(name).of(self.groups[body])

    def values(self, name):
        self.field(name)
        return np.concatenate([values for body in self.bodies if (values := self.values_of(body, name)) is not None])

    # ------------------------------------------------------------------------------------------ meshes

    def half_edges(self, name):
        """Half of the edges of the box of each particle [N, 3], m: of its domain where the frame has it, else of a cube of its volume."""
        fields = self.groups[name]
        if "half_length_x" in fields:
            return np.column_stack([fields[f"half_length_{axis}"] for axis in "xyz"])
        edge = np.cbrt(fields["volume"]) if "volume" in fields else np.full(len(fields["position"]), self.size(name))
        return np.repeat(edge[:, None] / 2, 3, axis=1)

    def seen(self, name):
        """Which particles [N] others do not hide on all sides: those of cells that have a neighbour without particles."""
        places = self.groups[name]["position"]
        spacing = max(self.run.number("mesh_spacing"), 2 * self.size(name))
        cells = np.floor((places - places.min(axis=0)) / spacing).astype(np.int32) + 1
        shape = cells.max(axis=0) + 2
        if np.prod(shape.astype(float)) > MOST_CELLS:
            return np.ones(len(places), dtype=bool)
        filled = np.zeros(shape, dtype=bool)
        filled[tuple(cells.T)] = True
        for axis in range(3):
            filled = filled & np.roll(filled, 1, axis) & np.roll(filled, -1, axis)
        return ~filled[tuple(cells.T)]

    def cubes(self, name, values=None):
        """A box of the size of each particle that is seen, with `values` [N]."""
        seen = self.seen(name)
        places, half = self.groups[name]["position"][seen], SEAM * self.half_edges(name)[seen]
        corners = places[:, None] + half[:, None] * np.array(CORNERS)
        faces = 8 * np.arange(len(places))[:, None, None] + np.array(FACES)
        mesh = pyvista.PolyData(corners.reshape(-1, 3), faces=np.insert(faces.reshape(-1, 4), 0, 4, axis=1).ravel())
        if values is not None:
            mesh.cell_data["value"] = np.repeat(values[seen], len(FACES))
        return mesh

    def points(self, name, values=None):
        """The particles that are seen, with `values` [N]."""
        seen = self.seen(name)
        cloud = pyvista.PolyData(self.groups[name]["position"][seen])
        if values is not None:
            cloud["value"] = values[seen]
        return cloud

    def surface(self, name, values=None):
        """The surface on which half of the space is filled, with means of `values` [N] over the particles near it."""
        places, volumes = self.groups[name]["position"], 8 * self.half_edges(name).prod(axis=1)
        lower, upper = places.min(axis=0), places.max(axis=0)
        spacing = max(self.size(name), (np.prod(upper - lower) / MOST_NODES) ** (1 / 3))
        origin = lower - 3 * spacing
        shape = np.ceil((upper - origin) / spacing).astype(int) + 4
        spread = lambda weights: smooth(deposit((places - origin) / spacing, weights, shape))
        filled = spread(volumes)
        grid = pyvista.ImageData(dimensions=shape, spacing=[spacing] * 3, origin=origin)
        grid["filled"] = filled.ravel(order="F") / spacing ** 3
        if values is not None:
            grid["value"] = mean_of(spread(volumes * values), filled).ravel(order="F")
        return grid.contour([0.5], scalars="filled")

    def solid(self, rigid):
        """Surface of a rigid body where it is in the frame, None where its shape is not known, or its particles lie elsewhere."""
        given, points = self.triangles.get(rigid), self.groups[rigid]["position"]
        if not len(points):
            return None
        if given is not None and not self.run.words(f"{rigid}_parts"):
            mesh = pyvista.PolyData(given["vertices"], faces=np.insert(given["triangles"], 0, 3, axis=1).ravel())
        else:
            mesh = solid(self.run, rigid)
            mesh = None if mesh is None else moved(self.run, rigid, mesh, self.centres[rigid], self.time)
        if mesh is not None and self.half is not None:
            mesh = keep_side(mesh, *self.half)
        return mesh if mesh is not None and mesh.n_points and fits(mesh, points, 2.5 * self.size(rigid)) else None


# ---------------------------------------------------------------------------------------------- grids


def deposit(places, weights, shape):
    """Weights [N] of points at places [N, 3], in cells of the grid, spread linearly over the nodes of the grid."""
    first = np.floor(places).astype(np.int64)
    share, total = places - first, np.zeros(int(np.prod(shape)))
    for corner in np.ndindex(2, 2, 2):
        part = np.prod(np.where(corner, share, 1 - share), axis=1)
        total += np.bincount(np.ravel_multi_index((first + corner).T, shape), weights * part, len(total))
    return total.reshape(shape)


def smooth(values):
    """Means of each node with its neighbours along each axis, weights 1, 2, 1. The outermost nodes are empty."""
    for axis in range(values.ndim):
        values = (np.roll(values, 1, axis) + 2 * values + np.roll(values, -1, axis)) / 4
    return values


def mean_of(sums, weights):
    """sums / weights; at nodes without weight the mean of their neighbours."""
    wide, all_sums = smooth(weights), smooth(sums)
    near = np.divide(all_sums, wide, out=np.zeros_like(sums), where=wide > 0)
    return np.divide(sums, weights, out=near, where=weights > 1e-6 * weights.max())
