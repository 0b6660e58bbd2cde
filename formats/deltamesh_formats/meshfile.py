"""Mesh files in and out: OBJ, PLY, OFF, STL and GLB.

Reading goes through the loaders of trimesh (Dawson-Haggerty et al., trimesh.org), but not through
its mesh class, which merges vertices and drops faces: what comes back is the file's own list of
vertices, in its order, isolated ones included, and its own faces, polygons cut into triangles.
`meshtext` first rewrites the text files that the loaders would misread, and what they leave out
without a word (half a file, triangle strips, compressed buffers) is an error here.
`meshout` has the way back.
"""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats import meshtext
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshout import FORMATS, mesh_bytes

__all__ = ["FORMATS", "MeshData", "mesh_bytes", "mesh_format", "read_mesh", "write_mesh"]

PathOrFile: TypeAlias = str | os.PathLike[str] | BinaryIO
_Part: TypeAlias = tuple[NDArray[np.float64], NDArray[np.int64]]


@dataclass(frozen=True)
class MeshData:
    """What a mesh file holds.

    Attributes
    ----------
    vertices : float64 (n, 3)
        Every vertex of the file, in its order and unit.
    faces : int64 (m, 3)
        Vertex indices from 0, in the file's winding.
    format : str
        One of `FORMATS`.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    format: str


def mesh_format(target: PathOrFile, file_format: str | None = None) -> str:
    """Return the format that is asked for or, without one, that of the file name's extension.

    Raises
    ------
    MeshError
        When it is not one of `FORMATS`.
    """
    name = _name(target)
    found = (file_format or Path(name).suffix).removeprefix(".").lower()
    if found in FORMATS:
        return found
    known = ", ".join(FORMATS)
    if found:
        raise MeshError(f"{name}: {found!r} is not a mesh format known here: {known}")
    raise MeshError(f"{name}: the name does not tell the mesh format; give one of {known}")


def read_mesh(source: PathOrFile, file_format: str | None = None) -> MeshData:
    """Read a mesh file; nothing is merged, dropped or reordered.

    Parameters
    ----------
    source : path or binary file object
    file_format : str, optional
        One of `FORMATS`; by default the file name's extension tells.

    Returns
    -------
    MeshData
        The meshes of a GLB scene are one, each in its place, in the order of the file; polygons
        are cut into fans of triangles, as a rule in place.

    Raises
    ------
    MeshError
        For an unknown format, a file that is not one of that format, and one without faces.
    OSError
        When the file cannot be opened or read.
    """
    name, known = _name(source), mesh_format(source, file_format)
    data = Path(source).read_bytes() if isinstance(source, (str, os.PathLike)) else source.read()
    try:
        # trimesh averages normals that we have no use for (0/0), and numpy still only warns of
        # text that is not a number.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            warnings.filterwarnings("error", message="string or file could not be read")
            vertices, faces = _join(_READERS[known](data))
        _check(vertices, faces)
    except (OSError, MemoryError):
        raise
    except MeshError as error:
        raise MeshError(f"{name}: {error}") from None
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise MeshError(f"{name}: not readable as {known.upper()} ({reason})") from error
    return MeshData(vertices, faces, known)


def write_mesh(
    target: PathOrFile,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    file_format: str | None = None,
) -> None:
    """Write a mesh file; all its bytes are made before the first one is written.

    Parameters
    ----------
    target : path or binary file object
    vertices : float64 (n, 3)
        Kept to the last bit by OBJ, OFF and PLY, rounded to float32 by STL and GLB.
    faces : int64 (m, 3)
        Vertex indices from 0.
    file_format : str, optional
        One of `FORMATS`; by default the file name's extension tells.

    Raises
    ------
    MeshError
        For an unknown format, and a mesh that the format cannot hold.
    OSError
        When the file cannot be written.
    """
    data = mesh_bytes(vertices, faces, mesh_format(target, file_format))
    if isinstance(target, (str, os.PathLike)):
        Path(target).write_bytes(data)
    else:
        target.write(data)


def _name(target: PathOrFile) -> str:
    if isinstance(target, (str, os.PathLike)):
        return os.fspath(target)
    return str(getattr(target, "name", "") or "<stream>")


def _read_obj(data: bytes) -> list[_Part]:
    from trimesh.exchange.obj import load_obj

    plain, records = meshtext.plain_obj(data)
    # maintain_order keeps the list of vertices whole; nothing else is left in the plain text.
    loaded = load_obj(io.BytesIO(plain), skip_materials=True, maintain_order=True)
    return _checked_parts(loaded, records)


def _read_ply(data: bytes) -> list[_Part]:
    from trimesh.exchange.ply import load_ply

    plain, records = meshtext.plain_ply(data)
    # fix_texture would split vertices along the seams of a texture.
    try:
        loaded = load_ply(io.BytesIO(plain), skip_materials=True, fix_texture=False)
    except ValueError as error:
        if "unexpected length" not in str(error):
            raise
        reason = "it is cut short, or its faces differ in their number of corners"
        raise MeshError(f"its length does not fit its header: {reason}") from error
    return _checked_parts(loaded, records)


def _read_off(data: bytes) -> list[_Part]:
    from trimesh.exchange.off import load_off

    plain, records = meshtext.plain_off(data)
    return _checked_parts(load_off(io.BytesIO(plain)), records)


def _read_stl(data: bytes) -> list[_Part]:
    from trimesh.exchange.stl import load_stl

    plain, records = meshtext.plain_stl(data)
    return _checked_parts(load_stl(io.BytesIO(plain)), records)


def _read_glb(data: bytes) -> list[_Part]:
    import trimesh

    meshtext.check_glb(data)
    scene: Any = trimesh.load(
        io.BytesIO(data), file_type="glb", force="scene", process=False, skip_materials=True
    )
    # trimesh walks the nodes backwards: put the meshes in the order of the file.
    order = {name: i for i, name in enumerate(scene.geometry)}
    parts = [part for part in reversed(scene.dump()) if isinstance(part, trimesh.Trimesh)]
    parts.sort(key=lambda part: order[part.metadata["name"]])
    return [_part(part.vertices, part.faces) for part in parts]


_READERS: Final[dict[str, Callable[[bytes], list[_Part]]]] = {
    "obj": _read_obj,
    "ply": _read_ply,
    "off": _read_off,
    "stl": _read_stl,
    "glb": _read_glb,
}


def _checked_parts(loaded: dict[str, Any], records: meshtext.Records) -> list[_Part]:
    """Turn what a loader returns into arrays, and compare their length with what the file says."""
    meshes: Iterable[dict[str, Any]] = loaded.get("geometry", {"": loaded}).values()
    parts = [_part(mesh["vertices"], mesh.get("faces")) for mesh in meshes]
    found = sum(len(vertices) for vertices, _ in parts), sum(len(faces) for _, faces in parts)
    for what, number, wanted in zip(("vertices", "faces"), found, records, strict=True):
        if number < wanted:
            raise MeshError(f"only {number} of its {wanted} {what} can be read: is it cut short?")
    return parts


def _part(vertices: Any, faces: Any) -> _Part:
    V = np.array(vertices, dtype=np.float64, order="C")
    if V.ndim != 2 or V.shape[1] != 3:
        raise MeshError(f"its vertices have shape {V.shape}, not (n, 3)")
    if faces is None or not len(faces):
        return V, np.empty((0, 3), dtype=np.int64)
    polygons = np.array(faces, dtype=np.int64)
    if polygons.ndim != 2 or polygons.shape[1] < 3:
        raise MeshError(f"its faces have shape {polygons.shape}, not (m, 3)")
    return V, _fans(polygons)


def _fans(polygons: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut polygons, int64 (m, k), into the triangles (0, i, i + 1), in the order of the file."""
    corners = polygons.shape[1]
    triangles = [polygons[:, [0, i, i + 1]] for i in range(1, corners - 1)]
    return np.stack(triangles, axis=1).reshape(-1, 3)


def _join(parts: list[_Part]) -> _Part:
    """Put meshes one after the other."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    none = np.empty((0, 3))
    vertices = np.concatenate([none, *(vertices for vertices, _ in parts)])
    shifted = [faces + start for (_, faces), start in zip(parts, starts, strict=False)]
    return vertices, np.concatenate([none.astype(np.int64), *shifted])


def _check(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
    if not len(vertices):
        raise MeshError("it holds no mesh: no vertices and no faces")
    if not len(faces):
        raise MeshError(f"it holds {len(vertices)} vertices but no faces: a point cloud")
    bad = ((faces < 0) | (faces >= len(vertices))).any(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        message = f"face {i} has vertex indices {faces[i].tolist()}"
        raise MeshError(f"{message}, outside 0..{len(vertices) - 1}")
