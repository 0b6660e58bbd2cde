"""Validator of meshes, the one place where arrays from outside are checked.

A `PolyMesh` may come from a reader, from arrays, or be made by hand, and then be anything.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final, get_args

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.arguments import brief, is_real
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError, NoSurfaceError
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import (
    Attribute,
    Parts,
    PolyMesh,
    Precision,
    Role,
    keep_faces,
)

# Descriptions that readers give of points, lines, and surfaces that are not polygons.
_POINTS: Final = ("points",)
_LINES: Final = ("lines", "elements edge")
_FREE_FORM: Final = "free-form geometry"
# Indices of a face that a message prints.
_FEW: Final = 8


def checked(mesh: PolyMesh, largest: float = math.inf) -> PolyMesh:
    """Return the mesh without its faces of fewer than three corners, or refuse it.

    What is left out is named in `lost`.

    Parameters
    ----------
    mesh : PolyMesh
    largest : float
        The largest absolute value of a coordinate.

    Raises
    ------
    MeshError
        For an array of another shape or type than `PolyMesh` says, a position that is not finite or
        too large, an index out of range, or a mesh without vertices; the message names the array,
        attribute or part, or the first element at fault.
    NoSurfaceError
        For points or lines without a face.
    """
    check_arrays(mesh)
    sizes = mesh.sizes
    whole = sizes >= 3
    has_points = any(word in mesh.lost for word in (*_POINTS, *_LINES))
    if not (len(mesh.vertices) or has_points):
        raise MeshError(f"it holds no mesh: no vertices and no faces{_also(mesh)}")
    named = mesh
    if not whole.all():
        few = f"{np.count_nonzero(~whole)} faces of fewer than three corners"
        named = replace(mesh, lost=(*mesh.lost, few))
    if not whole.any():  # before the positions: those of clouds need not be finite
        raise _no_surface(named, edges=int(np.count_nonzero(sizes == 2)))
    _check_positions(mesh.vertices, largest)
    check_indices(mesh)
    return keep_faces(named, whole)


def _no_surface(mesh: PolyMesh, edges: int) -> MeshError:
    """Return an error about a mesh without faces, which names programs that compress its kind.

    Parameters
    ----------
    mesh : PolyMesh
    edges : int
        Count of the faces of two corners that it had.
    """
    n = len(mesh.vertices)
    has = f"it holds {n} vertices but no faces" if n else "it holds no faces"
    if _FREE_FORM in mesh.lost:
        return MeshError(f"{has}: free-form geometry{_also(mesh)}")
    if edges or any(word in mesh.lost for word in _LINES):
        return NoSurfaceError(f"{has}: a set of lines{_also(mesh)}, which pcodec compresses")
    tools = "which LAZ, Draco and pcodec compress"
    return NoSurfaceError(f"{has}: a point cloud{_also(mesh)}, {tools}")


def _check_positions(V: Floats, largest: float) -> None:
    bad = ~np.isfinite(V).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"vertex {i} is not finite: {V[i].tolist()}")
    bad = (np.abs(V) > largest).any(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"vertex {i} is beyond {largest:g}: {V[i].tolist()}")


def check_indices(mesh: PolyMesh) -> None:
    """Refuse a mesh of which a face has a vertex that is not there.

    Raises
    ------
    MeshError
    """
    n = len(mesh.vertices)
    bad = (mesh.corners < 0) | (mesh.corners >= n)
    if bad.any():
        face = int(np.searchsorted(mesh.offsets, np.argmax(bad), side="right")) - 1
        indices = mesh.corners[mesh.offsets[face] : mesh.offsets[face + 1]].tolist()
        if len(indices) <= _FEW:
            raise MeshError(f"face {face} has vertex indices {indices}, outside 0..{n - 1}")
        index, size = int(mesh.corners[np.argmax(bad)]), len(indices)
        message = f"face {face}, of {size} corners, has the vertex index {index}"
        raise MeshError(f"{message}, outside 0..{n - 1}")


def _also(mesh: PolyMesh) -> str:
    """Return the contents of a file that has no mesh, fit for a message."""
    lost = ", ".join(mesh.lost)
    return f" (and {lost if lost.isprintable() else ascii(lost)[1:-1]})" if lost else ""


def check_arrays(mesh: PolyMesh) -> None:
    """Refuse a mesh that has something else than `PolyMesh` says.

    Numbers of positions, and indices of vertices, may be anything.

    Raises
    ------
    MeshError
        It names the array, attribute or part, or the field.
    """
    for name in ("vertices", "corners", "offsets"):
        _expect_array(name, getattr(mesh, name))
    _expect_all("attributes", mesh.attributes, Attribute)
    _expect_all("parts", mesh.parts, Parts)
    _expect_all("lost", mesh.lost, str)
    _check_metadata(mesh.metadata)
    _expect_one_of("precision", mesh.precision, get_args(Precision))
    if not isinstance(mesh.format, str):
        raise MeshError(f"format must be a str, not {brief(mesh.format)}")
    _check_margin("margin", mesh.margin)
    n, c = len(mesh.vertices), len(mesh.corners)
    _expect("vertices", mesh.vertices, np.float64, (n, 3))
    _expect("corners", mesh.corners, np.int64, (c,))
    _expect("offsets", mesh.offsets, np.int64, (max(len(mesh.offsets), 1),))
    if mesh.offsets[0] != 0 or mesh.offsets[-1] != c or (mesh.sizes < 0).any():
        raise MeshError(f"offsets must ascend from 0 to {c}, the number of corners")
    counts = {"vertex": n, "corner": c, "face": len(mesh.offsets) - 1}
    for attribute in mesh.attributes:
        _check_attribute(attribute, counts)
    for parts in mesh.parts:
        _check_parts(parts, counts["face"])
    kinds = [parts.kind for parts in mesh.parts]
    if len(set(kinds)) < len(kinds):
        raise MeshError("the mesh has parts of one kind twice")


def _check_attribute(attribute: Attribute, counts: Mapping[str, int]) -> None:
    if not isinstance(attribute.name, str):
        raise MeshError(f"names of attributes must be str, not {brief(attribute.name)}")
    name = f"{attribute.domain} attribute {attribute.name!r}"
    _expect_one_of(f"the domain of attribute {attribute.name!r}", attribute.domain, (*counts,))
    _expect_one_of(f"the role of {name}", attribute.role, get_args(Role))
    _expect_array(name, attribute.values)
    _check_margin(f"the margin of {name}", attribute.margin)
    if not isinstance(attribute.normalized, (bool, np.bool_)):
        raise MeshError(f"{name}: normalized must be a bool, not {brief(attribute.normalized)}")
    count, values, index = counts[attribute.domain], attribute.values, attribute.index
    if not _is_numeric(values.dtype):
        raise MeshError(f"{name} is of type {values.dtype}: numbers of up to 64 bits only")
    if values.ndim != 2:
        raise MeshError(f"{name} has values of shape {values.shape}, not (rows, width)")
    if index is None:
        if len(values) != count:
            raise MeshError(f"{name} has {len(values)} rows for {count} elements")
        return
    _expect(f"the index of {name}", index, np.int64, (count,))
    if index.min(initial=-1) < -1 or index.max(initial=-1) >= len(values):
        raise MeshError(f"the index of {name} leads out of its {len(values)} rows")


def _is_numeric(dtype: np.dtype[Any]) -> bool:
    """Return whether numbers, or the two real numbers of a complex one, have up to 64 bits."""
    size = dtype.itemsize // (2 if dtype.kind == "c" else 1)
    return dtype.kind in "biufc" and size <= 8


def _check_parts(parts: Parts, faces: int) -> None:
    _expect_one_of("the kind of parts", parts.kind, get_args(Kind))
    name = f"parts of kind {parts.kind!r}"
    _expect_all(f"names of {name}", parts.names, str)
    count = len(parts.names)
    _expect(name, parts.of_face, np.int64, (faces,))
    if parts.of_face.min(initial=-1) < -1 or parts.of_face.max(initial=-1) >= count:
        raise MeshError(f"{name} lead out of their {count} names")
    if parts.transforms is not None:
        _expect(f"transforms of {name}", parts.transforms, np.float64, (count, 4, 4))


def _check_metadata(metadata: object) -> None:
    if not isinstance(metadata, Mapping):
        raise MeshError(f"metadata must be a mapping of names to texts, not {brief(metadata)}")
    for key, lines in metadata.items():
        if not isinstance(key, str):
            raise MeshError(f"names of metadata must be str, not {brief(key)}")
        _expect_all(f"metadata {key!r}", lines, str)


def _check_margin(name: str, margin: object) -> None:
    if not (is_real(margin) and 0 <= margin < math.inf):
        raise MeshError(f"{name} must be a number from 0 on, not {brief(margin)}")


def _expect_one_of(name: str, value: object, known: tuple[str, ...]) -> None:
    if not isinstance(value, str) or value not in known:
        raise MeshError(f"{name} must be one of {', '.join(known)}, not {brief(value)}")


def _expect_all(name: str, values: object, kind: type) -> None:
    if not isinstance(values, (tuple, list)):
        raise MeshError(f"{name} must be a tuple of {kind.__name__}, not {brief(values)}")
    for value in values:
        if not isinstance(value, kind):
            raise MeshError(f"{name} must be a tuple of {kind.__name__}, not of {brief(value)}")


def _expect_array(name: str, array: object) -> None:
    if not isinstance(array, np.ndarray) or not array.ndim:
        raise MeshError(f"{name} must be an array, not {brief(array)}")


def _expect(name: str, array: NDArray[Any], dtype: type, shape: tuple[int, ...]) -> None:
    has = np.shape(array), getattr(array, "dtype", type(array).__name__)
    if has != (shape, np.dtype(dtype)):
        raise MeshError(f"{name} must be {np.dtype(dtype)} {shape}, not {has[1]} {has[0]}")
