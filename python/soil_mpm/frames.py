"""Frames of a run, read as far as is asked: the particles of each body, and fields at points, lines, grids and sections."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Sequence

import h5py
import numpy as np

from soil_mpm.fields import DERIVED
from soil_mpm.problems import NoSuchResult

if TYPE_CHECKING:
    from soil_mpm.results import Run

UNITS = {"position": "m", "velocity": "m/s", "grid_velocity": "m/s", "stress": "Pa", "volume": "m3"}  # of frames that name none
AT_ONCE = 1 << 20  # particles that are read at a time


def read_rows(data: h5py.Dataset, rows: np.ndarray) -> np.ndarray:
    """Rows of a dataset [n, ...] by their numbers [n], which rise: the parts of the file that have some of them, one after the other."""
    found = np.empty((len(rows), *data.shape[1:]), data.dtype)
    begins = np.searchsorted(rows, np.arange(0, len(data) + AT_ONCE, AT_ONCE))
    for begin, end in zip(begins[:-1], begins[1:]):
        if end > begin:
            first, last = rows[begin], rows[end - 1]
            found[begin:end] = data[first:last + 1][rows[begin:end] - first]
    return found


def numbers_of(rows: slice | Sequence[int] | Sequence[bool] | np.ndarray, count: int) -> np.ndarray:
    """Numbers of particles, which rise, of a slice, of such numbers, or of a mask [count]; NoSuchResult for all else."""
    if isinstance(rows, slice):
        found = np.arange(*rows.indices(count))
    else:
        found = np.asarray(rows)
        if found.dtype == bool and found.shape == (count,):
            found = np.flatnonzero(found)
    rises = found.ndim == 1 and np.all(found[1:] > found[:-1])
    if found.size == 0:
        return np.empty(0, dtype=int)
    if not rises or not np.issubdtype(found.dtype, np.integer) or found[0] < 0 or found[-1] >= count:
        raise NoSuchResult(f"rows takes a slice that goes forward, numbers from 0 to {count - 1} that rise, or {count} truth values")
    return found


class Rows(Mapping[str, np.ndarray]):
    """Some particles of a body: rows["stress"] reads them, as an array [n] or [n, components]."""

    def __init__(self, body: Body, rows: np.ndarray):
        self._body, self._rows = body, rows

    def __getitem__(self, key: str) -> np.ndarray:
        return read_rows(self._body[key], self._rows)

    def __contains__(self, key: object) -> bool:
        return key in self._body

    def __iter__(self) -> Iterator[str]:
        return iter(self._body)

    def __len__(self) -> int:
        return len(self._body)


class Body(Mapping[str, Any]):
    """Particles of a body or rigid body in a frame. body["stress"] is a dataset of the file, of which an index reads the part alone:
    body["stress"][:100, 0]. body.field("mises") reads a field whole. Attributes are datasets: body.stress[:]."""

    def __init__(self, name: str, group: h5py.Group):
        self.name, self._group = name, group

    def __getitem__(self, key: str) -> h5py.Dataset:
        if key not in self._group:
            raise NoSuchResult(f"{self.name} has no {key} in this frame; it has {', '.join(self._group)}")
        return self._group[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._group)

    def __len__(self) -> int:
        return len(self._group)

    def __getattr__(self, name: str) -> h5py.Dataset:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except NoSuchResult as error:
            raise AttributeError(str(error)) from None

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *self})

    def __repr__(self) -> str:
        return f"<Body {self.name}: {self.count} particles; {', '.join(self)}>"

    @property
    def count(self) -> int:
        """Number of particles."""
        return len(self["position"])

    def fields(self) -> list[str]:
        """Names that field() takes: datasets, and what follows from them."""
        return list(dict.fromkeys([*self, *(name for name, derived in DERIVED.items() if derived.is_in(self))]))

    def field(self, name: str, rows: slice | Sequence[int] | Sequence[bool] | np.ndarray | None = None) -> np.ndarray:
        """A field of all particles, in SI units: a dataset of the frame [N] or [N, 3 or 6], or what follows from them [N]: pressure,
        effective_pressure, mises [Pa], stress_xx ... stress_zx [Pa], velocity_x ... velocity_z [m/s], speed [m/s]. rows: particles that are
        read, in their order in the frame: a slice, numbers that rise, or a mask [N]."""
        datasets = self if rows is None else Rows(self, numbers_of(rows, self.count))
        if name == "speed":
            return DERIVED["grid_velocity"].of(datasets)
        if name in self:
            return datasets[name][()]
        if name in DERIVED and DERIVED[name].is_in(self):
            return DERIVED[name].of(datasets)
        raise NoSuchResult(f"{self.name} has no field {name}; it has {', '.join(self.fields())}")

    def positions(self, dim: int) -> Iterator[tuple[int, np.ndarray]]:
        """Positions [n, dim] in m of some particles after the other, and the number of the first of them."""
        data = self["position"]
        for first in range(0, len(data), AT_ONCE):
            yield first, data[first:first + AT_ONCE][:, :dim]

    def unit(self, name: str) -> str:
        """SI unit of a field; empty where it is not known."""
        if name in self:
            unit = self[name].attrs.get("unit", UNITS.get(name, ""))
            return unit.decode() if isinstance(unit, bytes) else str(unit)
        return "m/s" if name == "speed" else DERIVED[name].unit if name in DERIVED else ""


class Frame:
    """A frame of a run: frame["soil"] is a Body, frame.time its time [s]. The file is open until close(), or the end of `with`."""

    def __init__(self, run: Run, path: Path):
        self.run, self.path = run, path
        self._file = h5py.File(path)
        self.time = float(self._file.attrs["time"])
        self.step = int(self._file.attrs["step"])

    def __enter__(self) -> Frame:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        self._file.close()

    def __repr__(self) -> str:
        return f"<Frame {self.path.name}: t = {self.time:.6g} s; {', '.join(self.names())}>"

    def names(self) -> list[str]:
        """Bodies and rigid bodies of the frame."""
        return [name for name, group in self._file.items() if "position" in group and name != "nodes"]

    def bodies(self) -> list[str]:
        """Deformable bodies of the frame."""
        return [name for name in self.names() if "volume" in self._file[name]]

    def __getitem__(self, name: str) -> Body:
        if name not in self._file:
            raise NoSuchResult(f"{self.path}: no body {name}; there are {', '.join(self.names())}")
        return Body(name, self._file[name])

    def mesh(self, bodies: Sequence[str] | None = None) -> Any:
        """The particles as a meshio.Mesh of points with their fields: soil_mpm.export."""
        from soil_mpm.export import mesh_of
        return mesh_of(self, bodies)

    # ------------------------------------------------------------------------------------------ fields at places

    def at(self, points: Any, fields: Sequence[str] | str, bodies: Sequence[str] | None = None) -> dict[str, np.ndarray]:
        """Fields at points [n, dim] in m, {name: [n] or [n, 3 or 6]}, NaN where there is no soil within half a cell: weighted fits of
        linear functions to the particles near a point (soil_mpm.sample). bodies: those that count, by default all."""
        from soil_mpm.sample import sample
        names = [fields] if isinstance(fields, str) else list(fields)
        bodies = list(bodies) if bodies is not None else self.bodies()
        points = np.atleast_2d(np.asarray(points, dtype=float))
        if points.shape[1] != self.run.dim:
            raise NoSuchResult(f"points have {points.shape[1]} coordinates; the run is in {self.run.dim}D")
        near = {body: self.near(body, points) for body in bodies}
        position, volume = (np.concatenate([self[body].field(key, near[body]) for body in bodies]) for key in ("position", "volume"))
        found: dict[str, np.ndarray] = {}
        for name in names:
            values = np.concatenate([self[body].field(name, near[body]) for body in bodies])
            flat = values.reshape(len(values), int(np.prod(values.shape[1:])))
            found[name] = sample(position, volume, flat, points, self.run.number("mesh_spacing")).reshape(len(points), *values.shape[1:])
        return found

    def near(self, body: str, points: np.ndarray) -> np.ndarray:
        """Numbers of the particles of a body in the box of some points and two cells round it."""
        room = 2 * self.run.number("mesh_spacing")
        lower, upper = points.min(axis=0) - room, points.max(axis=0) + room
        return np.concatenate([first + np.flatnonzero(np.all((position >= lower) & (position <= upper), axis=1))
                               for first, position in self[body].positions(self.run.dim)] or [np.empty(0, dtype=int)])

    def on_line(self, begin: Any, end: Any, fields: Sequence[str] | str, points: int = 201, **more: Any) -> dict[str, np.ndarray]:
        """Fields along a line from one point to another [m]; "way" is the distance from its beginning [m]."""
        begin, end = np.asarray(begin, dtype=float), np.asarray(end, dtype=float)
        share = np.linspace(0, 1, points)
        return {"way": share * np.linalg.norm(end - begin), **self.at(begin + share[:, None] * (end - begin), fields, **more)}

    def on_grid(self, fields: Sequence[str] | str, lower: Any = None, upper: Any = None, spacing: float | None = None,
                **more: Any) -> dict[str, np.ndarray]:
        """Fields on a grid [nx, ny, ...]; "x", "y" and "z" are its coordinates along the axes [m]. By default it has the points at the
        middles of the mesh's cells in the box of the bodies."""
        step = spacing or self.run.number("mesh_spacing")
        low, high = self.corners() if lower is None or upper is None else (None, None)
        lower = np.asarray(lower if lower is not None else low, dtype=float)
        upper = np.asarray(upper if upper is not None else high, dtype=float)
        axes = [np.arange(a + step / 2, b, step) for a, b in zip(lower, upper)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        values = self.at(grid.reshape(-1, len(axes)), fields, **more)
        shaped = {name: each.reshape(*grid.shape[:-1], *each.shape[1:]) for name, each in values.items()}
        return {**dict(zip("xyz", axes)), **shaped}

    def on_section(self, axis: str, place: float, fields: Sequence[str] | str, spacing: float | None = None,
                   **more: Any) -> dict[str, np.ndarray]:
        """Fields on a section of a 3D run, the plane axis = place [m], as on_grid; the coordinates are those of the other two axes."""
        if self.run.dim != 3 or axis not in ("x", "y", "z"):
            raise NoSuchResult("on_section takes an axis x, y or z of a run in 3D; in 2D see on_grid and on_line")
        k, step = "xyz".index(axis), spacing or self.run.number("mesh_spacing")
        lower, upper = self.corners()
        lower[k], upper[k] = place - step / 2, place + step / 4
        found = self.on_grid(fields, lower, upper, step, **more)
        return {name: values if name in "xyz" else values.take(0, axis=k) for name, values in found.items() if name != axis}

    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner [dim] of the cells that the bodies reach, m."""
        step, origin = self.run.number("mesh_spacing"), np.array(self.run.numbers("mesh_lower"))
        ends = [(part.min(axis=0), part.max(axis=0)) for body in self.bodies() for _, part in self[body].positions(self.run.dim)]
        low, high = np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)
        return origin + np.floor((low - origin) / step) * step, origin + np.ceil((high - origin) / step) * step


