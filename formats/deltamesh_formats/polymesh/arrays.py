"""Conversion of plain arrays to meshes, and of attributes of meshes to arrays by name.

`from_arrays` makes a `PolyMesh` and names what is wrong with the arrays; `to_arrays` returns the
attributes of a domain by their names.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from deltamesh_formats.arguments import brief
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh, Role
from deltamesh_formats.polymesh.names import distinct_names
from deltamesh_formats.polymesh.validation import checked

Named: TypeAlias = Mapping[str, ArrayLike]

# The names under which programs keep what has a role, a further set with its number.
_NAMES: Final[tuple[tuple[Role, str, tuple[int, ...]], ...]] = (
    ("normal", "normals?", (3,)),
    ("uv", r"uvs?|texcoords?|tcoords|texture coordinates", (2, 3)),
    ("colour", r"colou?rs?|rgba?", (3, 4)),
)


def from_arrays(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[ArrayLike],
    *,
    vertex: Named | None = None,
    corner: Named | None = None,
    face: Named | None = None,
) -> PolyMesh:
    """Return a mesh of arrays; they are copied only where their types have to change.

    Parameters
    ----------
    vertices : array_like (n, 3)
        Finite real numbers.
    faces : array_like (m, k), or a sequence of polygons
        Vertex indices from 0: triangles, quads, or polygons of any sizes.
    vertex, corner, face : mapping of str to array_like, optional
        Attributes by name: real numbers, or truth values (which become 0 and 1), a row for each
        vertex, corner of a face, or face. (rows,) is (rows, 1); of a corner also (m, k, width).
        "normal", "uv" and "colour", their plurals and usual spellings, and with a number, have
        that role if their width and type fit; unsigned integers of a colour are fractions.

    Returns
    -------
    PolyMesh
        `PolyMesh.vertex_data` and so on are these mappings again.

    Raises
    ------
    MeshError
        If the arrays are no mesh, or an attribute does not fit it; it is named.

    Examples
    --------
    >>> mesh = from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], vertex={"T": [1, 2, 3]})
    >>> mesh.vertex_data["T"]
    array([1, 2, 3])
    """
    return checked(unchecked(vertices, faces, vertex=vertex, corner=corner, face=face))


def unchecked(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[ArrayLike],
    *,
    vertex: Named | None = None,
    corner: Named | None = None,
    face: Named | None = None,
) -> PolyMesh:
    """Return the mesh of `from_arrays`, whose positions and indices may be anything.

    Raises
    ------
    MeshError
        For arrays that do not fit each other.
    """
    V = _numbers(vertices, "vertices", "fiu", size=16)
    if V.ndim != 2 or V.shape[1] != 3:
        raise MeshError(f"vertices must have shape (n, 3), not {V.shape}")
    corners, offsets, regular = _polygons(faces)
    counts: dict[Domain, int] = {
        "vertex": len(V),
        "corner": len(corners),
        "face": len(offsets) - 1,
    }
    given: tuple[tuple[Domain, Named | None], ...] = (
        ("vertex", vertex),
        ("corner", corner),
        ("face", face),
    )
    for domain, named in given:
        if named is not None and not isinstance(named, Mapping):
            raise MeshError(f"{domain} must be a mapping of names to arrays, not {brief(named)}")
    attributes = tuple(
        attribute_of(name, domain, values, counts[domain], regular)
        for domain, named in given
        for name, values in (named or {}).items()
    )
    return PolyMesh(
        np.ascontiguousarray(V, dtype=np.float64),
        corners,
        offsets,
        attributes,
        precision="float32" if V.dtype == np.float32 else "float64",
    )


def attribute_of(
    name: str, domain: Domain, values: ArrayLike, count: int, regular: int | None = None
) -> Attribute:
    """Return one attribute of arrays, as `from_arrays` does.

    Parameters
    ----------
    name : str
    domain : {"vertex", "corner", "face"}
    values : array_like
    count : int
        Of the elements.
    regular : int, optional
        Corners of each face, if all have as many.

    Raises
    ------
    MeshError
    """
    A = _numbers(values, f"{domain} attribute {name!r}", "fiub")
    if domain == "corner" and regular and A.ndim > 1 and A.shape[:2] == (count // regular, regular):
        A = A.reshape(count, *A.shape[2:])
    rows = A.reshape(-1, 1) if A.ndim == 1 else A
    if rows.ndim != 2 or len(rows) != count or rows.shape[1] == 0:
        raise MeshError(
            f"{domain} attribute {name!r} has shape {A.shape}, not ({count},) or ({count}, width)"
        )
    if rows.dtype.kind == "b":
        rows = rows.view(np.uint8)
    rows = np.ascontiguousarray(rows, dtype=rows.dtype.newbyteorder("="))
    role = role_of(name, rows)
    return Attribute(name, domain, rows, role, normalized=role == "colour" and _counts(rows))


def role_of(name: str, values: NDArray[Any]) -> Role:
    """Return the role of an attribute of that name, (rows, width), if its numbers fit it."""
    for role, names, widths in _NAMES:
        if re.fullmatch(rf"({names})\d*", name, re.IGNORECASE) and values.shape[1] in widths:
            fits = values.dtype.kind == "f" or (role == "colour" and _counts(values))
            return role if fits else "other"
    return "other"


def to_arrays(
    mesh: PolyMesh, domain: Domain, keep: Callable[[Attribute], bool] = lambda _: True
) -> dict[str, NDArray[Any]]:
    """Return the attributes of a domain by their names, (rows,) or (rows, width).

    Rows of an index are in place; an element without one has `Attribute.filler`. Of attributes
    that share a name the second is called "name_2", and so on.

    Parameters
    ----------
    mesh : PolyMesh
    domain : {"vertex", "corner", "face"}
    keep : callable, optional
        Which attributes.
    """
    chosen = [a for a in mesh.attributes if a.domain == domain and keep(a)]
    arrays = (a.dense() for a in chosen)
    columns = (A[:, 0] if A.shape[1] == 1 else A for A in arrays)
    return dict(zip(distinct_names(a.name for a in chosen), columns, strict=True))


def _numbers(values: ArrayLike, name: str, kinds: str, size: int = 8) -> NDArray[Any]:
    """Return an array of numbers of at most `size` bytes; anything else is refused by name."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise MeshError(f"{name}: not an array: {error}") from None
    if array.dtype.kind not in kinds or array.dtype.itemsize > size:
        raise MeshError(f"{name} must be real numbers, not {array.dtype}")
    return array


def _counts(values: NDArray[Any]) -> bool:
    """Return whether the numbers are those of an image: bytes, or two bytes each."""
    return values.dtype.kind == "u" and values.dtype.itemsize <= 2


def _polygons(
    faces: ArrayLike | Sequence[ArrayLike],
) -> tuple[Ints, Ints, int | None]:
    """Return corners and offsets, and how many corners all faces have, if they have as many."""
    if isinstance(faces, np.ndarray) and faces.dtype != object:
        rows: Sequence[NDArray[Any]] | NDArray[Any] = faces
    else:
        if not isinstance(faces, Iterable):
            raise MeshError(f"faces must be rows of vertex indices, not {brief(faces)}")
        rows = [np.asarray(face) for face in faces]
        for i, row in enumerate(rows):
            if row.ndim != 1:
                raise MeshError(f"face {i} is not a row of vertex indices: {row.tolist()}")
    regular = None
    if isinstance(rows, np.ndarray) or len({len(row) for row in rows}) == 1:
        table = np.asarray(rows)
        if table.ndim != 2:
            raise MeshError(f"faces must have shape (m, corners), not {table.shape}")
        regular, flat = table.shape[1], table.reshape(-1)
        offsets = np.arange(len(table) + 1, dtype=np.int64) * regular
    else:
        flat = np.concatenate(rows) if rows else np.zeros(0, dtype=np.int64)
        offsets = np.cumsum([0, *(len(row) for row in rows)], dtype=np.int64)
    if flat.dtype.kind not in "iu":
        raise MeshError(f"faces must be integers, not {flat.dtype}")
    small = np.diff(offsets) < 3
    if small.any():
        i = int(np.argmax(small))
        raise MeshError(f"face {i} has {int(np.diff(offsets)[i])} corners, fewer than three")
    return np.ascontiguousarray(flat, dtype=np.int64), offsets, regular
