"""Frames for other programs: points of the particles with their fields, as VTKHDF, or by meshio as VTU, XDMF 3, PLY and what else it writes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Sequence

import h5py
import numpy as np

from soil_mpm.problems import Problem

if TYPE_CHECKING:
    from soil_mpm.frames import Frame

POLY_VERTEX = 2  # type of a cell


def with_meshio() -> Any:
    try:
        import meshio
    except ImportError:
        raise Problem("meshio is missing; takes pip install meshio") from None
    return meshio


def points_of(frame: Frame, bodies: Sequence[str] | None = None) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Particles of some bodies, by default of all, rigid bodies too: points [n, 3] in m, and the datasets of the frame in SI units
    {name: [n] or [n, 3 or 6]}, NaN where a body lacks one, with `body`, the number of the body among `bodies`."""
    chosen = [frame[name] for name in (frame.names() if bodies is None else bodies)]
    names = list(dict.fromkeys(name for body in chosen for name in body if name != "position"))
    data = {name: np.concatenate([values_of(body, name, chosen) for body in chosen]) for name in names}
    data["body"] = np.concatenate([np.full(body.count, k, dtype=np.int32) for k, body in enumerate(chosen)])
    return np.concatenate([body["position"][()] for body in chosen]), data


def mesh_of(frame: Frame, bodies: Sequence[str] | None = None) -> Any:
    """A meshio.Mesh of the particles of some bodies, a vertex each, with the data of points_of()."""
    meshio = with_meshio()
    points, data = points_of(frame, bodies)
    return meshio.Mesh(points, [("vertex", np.arange(len(points))[:, None])], point_data=data)


def write_vtkhdf(frame: Frame, path: Path, bodies: Sequence[str] | None = None) -> None:
    """The particles of some bodies as an unstructured grid of VTKHDF 1.0 (the page of VTK on this format): one cell of all vertices."""
    points, data = points_of(frame, bodies)
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = (1, 0)
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        root["Points"] = points
        for name, size in (("NumberOfPoints", len(points)), ("NumberOfConnectivityIds", len(points)), ("NumberOfCells", 1)):
            root[name] = np.array([size])
        root["Types"], root["Offsets"] = np.array([POLY_VERTEX], dtype=np.uint8), np.array([0, len(points)])
        root["Connectivity"] = np.arange(len(points))
        for name, values in data.items():
            root[f"PointData/{name}"] = values
        root["FieldData/TimeValue"] = np.array([frame.time])


def values_of(body: Any, name: str, bodies: Sequence[Any]) -> np.ndarray:
    """A dataset of a body; NaN [n] or [n, components] where it has none, as the first of the bodies that has it."""
    if name in body:
        return np.asarray(body[name][()], dtype=float)
    like = next(other for other in bodies if name in other)[name]
    return np.full((body.count, *like.shape[1:]), np.nan)


def write(frame: Frame, to: Path | str, bodies: Sequence[str] | None = None) -> Path:
    """Writes a frame to a file whose ending chooses the format, and returns its path: .vtkhdf, or what meshio writes. Problem where meshio
    does not write it."""
    path = Path(to)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".vtkhdf":
        write_vtkhdf(frame, path, bodies)
        return path
    meshio, mesh = with_meshio(), mesh_of(frame, bodies)
    try:
        meshio.write(path, mesh)
    except (meshio.WriteError, meshio.ReadError, KeyError) as error:
        raise Problem(f"{path}: meshio does not write this: {error}") from None
    return path
