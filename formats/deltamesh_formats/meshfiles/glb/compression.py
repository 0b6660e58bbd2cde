"""Decoders of compressed glTF data: buffer views of meshoptimizer, and primitives of Draco.

The specifications are those of the extensions EXT_meshopt_compression (KHR_meshopt_compression has
the same fields) and KHR_draco_mesh_compression (Khronos Group, github.com/KhronosGroup/glTF). The
packages that decode, meshopt and DracoPy, are imported when a file needs them.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError

DRACO: Final = "KHR_draco_mesh_compression"
MESHOPT: Final = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_MODES: Final = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTERS: Final = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")
# Bytes that a byte can stand for: a block of 256 rows of 4 bytes has at least one.
_MOST: Final = 1024


def meshopt_bytes(data: bytes, count: int, stride: int, mode: object, filter_: object) -> bytes:
    """Return the bytes of a buffer view that meshoptimizer has compressed.

    Parameters
    ----------
    data : bytes
    count, stride : int
        Rows, and bytes of each.
    mode, filter_ : str
        As the extension has them; anything else is refused.

    Raises
    ------
    MeshError
        For data that are damaged, and without the package meshopt.
    """
    if mode not in _MODES or filter_ not in _FILTERS:
        raise MeshError(f"there is no meshopt mode {str(mode)[:40]!r}, {str(filter_)[:40]!r}")
    if not stride or stride > 256 or count * stride > _MOST * len(data):
        raise MeshError(f"{len(data)} bytes of meshopt are not {count} rows of {stride} bytes")
    meshopt = _package("meshopt", "meshoptimizer")
    try:
        found = meshopt.decode_gltf_buffer(data, count, stride, mode, filter_)
    except Exception as error:
        raise MeshError(f"its meshopt data are damaged: {error}") from None
    return np.ascontiguousarray(found).tobytes()


def draco_arrays(data: bytes) -> tuple[Ints, Mapping[int, NDArray[Any]]]:
    """Return the triangles, int64 (t, 3), and the attributes by their ids, of Draco data.

    Raises
    ------
    MeshError
        For data that are damaged, or have no triangles, and without the package DracoPy.
    """
    draco = _package("DracoPy", "Draco")
    try:
        mesh = draco.decode(data)
        faces = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
        return faces, {one["unique_id"]: np.asarray(one["data"]) for one in mesh.attributes}
    except Exception as error:
        raise MeshError(f"its Draco data are damaged: {error}") from None


def _package(name: str, what: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise MeshError(
            f"it is compressed with {what}, which the package {name} reads: python -m pip install"
            f" {name}"
        ) from None
