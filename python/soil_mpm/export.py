"""Frames for other programs, by meshio: points of the particles with their fields, as VTU, XDMF 3, PLY and what else meshio writes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from soil_mpm.problems import Problem

if TYPE_CHECKING:
    from soil_mpm.frames import Frame


def with_meshio() -> Any:
    try:
        import meshio
    except ImportError:
        raise Problem("meshio is missing; takes pip install meshio") from None
    return meshio


def mesh_of(frame: Frame, bodies: Sequence[str] | None = None) -> Any:
    """A meshio.Mesh of the particles of some bodies, by default of all, rigid bodies too: points [n, 3] in m, a vertex each; point data
    are the datasets of the frame in SI units, NaN where a body lacks one, and `body`, the number of the body among `bodies`."""
    meshio = with_meshio()
    chosen = [frame[name] for name in (frame.names() if bodies is None else bodies)]
    names = list(dict.fromkeys(name for body in chosen for name in body if name != "position"))
    data = {name: np.concatenate([values_of(body, name, chosen) for body in chosen]) for name in names}
    data["body"] = np.concatenate([np.full(body.count, k, dtype=np.int32) for k, body in enumerate(chosen)])
    points = np.concatenate([body["position"][()] for body in chosen])
    return meshio.Mesh(points, [("vertex", np.arange(len(points))[:, None])], point_data=data)


def values_of(body: Any, name: str, bodies: Sequence[Any]) -> np.ndarray:
    """A dataset of a body; NaN [n] or [n, components] where it has none, as the first of the bodies that has it."""
    if name in body:
        return np.asarray(body[name][()], dtype=float)
    like = next(other for other in bodies if name in other)[name]
    return np.full((body.count, *like.shape[1:]), np.nan)


def write(frame: Frame, to: Path | str, bodies: Sequence[str] | None = None) -> Path:
    """Writes a frame to a file whose ending chooses the format, and returns its path. Problem where meshio does not write it."""
    meshio, path, mesh = with_meshio(), Path(to), mesh_of(frame, bodies)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        meshio.write(path, mesh)
    except (meshio.WriteError, meshio.ReadError, KeyError) as error:
        raise Problem(f"{path}: meshio does not write this: {error}") from None
    return path
