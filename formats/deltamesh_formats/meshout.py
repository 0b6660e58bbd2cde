"""The bytes of a mesh file, whole; the same arrays give the same bytes.

OBJ, OFF and PLY are written here: they can hold float64 to the last bit, but trimesh prints a
fixed number of decimals and has PLY in float32 only. STL and GLB are float32 by their nature and
are written by trimesh.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.errors import MeshError

FORMATS: Final = ("obj", "ply", "off", "stl", "glb")

_Vertices: TypeAlias = NDArray[np.float64]
_Faces: TypeAlias = NDArray[np.int64]


def mesh_bytes(vertices: _Vertices, faces: _Faces, file_format: str) -> bytes:
    """Return the bytes of a mesh file.

    Parameters
    ----------
    vertices : float64 (n, 3)
        Kept to the last bit by OBJ, OFF and PLY, rounded to float32 by STL and GLB.
    faces : int64 (m, 3)
        Vertex indices from 0.
    file_format : str
        One of `FORMATS`.

    Raises
    ------
    MeshError
        For a mesh without faces, and one that the format cannot hold.
    """
    if not len(faces):
        raise MeshError("a mesh without faces is not written")
    return _WRITERS[file_format](vertices, faces)


def _write_obj(vertices: _Vertices, faces: _Faces) -> bytes:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    return "\n".join([*lines, ""]).encode("ascii")


def _write_off(vertices: _Vertices, faces: _Faces) -> bytes:
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces.tolist()]
    return "\n".join([*lines, ""]).encode("ascii")


_PLY_HEADER = """ply
format binary_little_endian 1.0
element vertex {}
property double x
property double y
property double z
element face {}
property list uchar int vertex_indices
end_header
"""


def _write_ply(vertices: _Vertices, faces: _Faces) -> bytes:
    records = np.empty(len(faces), dtype=[("count", "u1"), ("indices", "<i4", 3)])
    records["count"], records["indices"] = 3, faces
    header = _PLY_HEADER.format(len(vertices), len(faces)).encode("ascii")
    return header + vertices.astype("<f8").tobytes() + records.tobytes()


def _write_float32(vertices: _Vertices, faces: _Faces, file_format: str) -> bytes:
    import trimesh

    if np.abs(vertices).max() > np.finfo(np.float32).max:
        raise MeshError(f"{file_format.upper()} holds float32, and a coordinate exceeds that")
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    data: Any = mesh.export(file_type=file_format)
    return bytes(data)


_WRITERS: Final[dict[str, Callable[[_Vertices, _Faces], bytes]]] = {
    "obj": _write_obj,
    "ply": _write_ply,
    "off": _write_off,
    "stl": lambda vertices, faces: _write_float32(vertices, faces, "stl"),
    "glb": lambda vertices, faces: _write_float32(vertices, faces, "glb"),
}
