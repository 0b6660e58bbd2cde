"""Shared parts of the conversions: arrays by name, names of parts, options, warnings."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import Any, Final, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.arrays import attribute_of
from deltamesh_formats.polymesh.descriptions import describe_attribute, filled_gaps
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import Attribute, Domain, Parts, PolyMesh
from deltamesh_formats.polymesh.names import distinct_names
from deltamesh_formats.polymesh.seams import at_vertices

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)

Arrays = list[tuple[str, NDArray[Any]]]


def by_name(arrays: Arrays) -> dict[str, NDArray[Any]]:
    """Return arrays by name; (rows, 1) becomes (rows,), and a name that is taken gets a number."""
    columns = (A[:, 0] if A.ndim == 2 and A.shape[1] == 1 else A for _, A in arrays)
    return dict(zip(distinct_names(name for name, _ in arrays), columns, strict=True))


def dense_arrays(mesh: PolyMesh, domain: Domain, without: Iterable[Attribute] = ()) -> Arrays:
    """Return names and rows, (count, width), of the attributes of a domain, but for some."""
    left = [a for a in mesh.attributes if a.domain == domain]
    return [(a.name, a.dense()) for a in left if not any(a is one for one in without)]


def point_arrays(mesh: PolyMesh) -> tuple[Arrays, list[str]]:
    """Return names and rows of the attributes of vertices, and of those of corners without seams.

    The others are described in the second result, and gaps in colours that are filled.
    """
    points, lost = dense_arrays(mesh, "vertex"), gaps_in_colours(mesh)
    for attribute in mesh.attributes:
        if attribute.domain == "corner":
            values = at_vertices(mesh, attribute)
            if values is None:
                lost.append(f"{describe_attribute(attribute)} with seams")
            else:
                points.append((attribute.name, values))
    return points, lost


def gaps_in_colours(mesh: PolyMesh) -> list[str]:
    """Return descriptions of gaps in colours, which arrays have in white."""
    return list(filled_gaps(a for a in mesh.attributes if a.role == "colour"))


def attributes_of(
    domain: Domain, arrays: Mapping[str, ArrayLike], count: int, lost: list[str]
) -> tuple[Attribute, ...]:
    """Return attributes of what a library holds by name; what does not fit is named in `lost`.

    Parameters
    ----------
    domain : {"vertex", "corner", "face"}
    arrays : mapping of str to array_like
        Rows of more than one dimension are made flat.
    count : int
        Of the elements.
    lost : list of str
    """
    found = []
    for name, values in arrays.items():
        try:
            A = np.asarray(values)
            if A.ndim > 2 and len(A) == count:
                A = A.reshape(count, -1)
                lost.append(f"the shape of the {domain} array {str(name)!r}")
            found.append(attribute_of(str(name), domain, A, count))
        except (MeshError, ValueError):
            lost.append(f"the {domain} array {str(name)!r}")
    return tuple(found)


def parts_of(kind: Kind, labels: ArrayLike, names: Iterable[str], faces: int) -> Parts | None:
    """Return parts of the part of each face and of names, None unless they fit."""
    of_face, found = np.asarray(labels), tuple(map(str, names))
    if of_face.shape != (faces,) or of_face.dtype.kind not in "iu":
        return None
    if faces and not (int(of_face.min()) >= -1 and int(of_face.max()) < len(found)):
        return None
    return Parts(kind, found, of_face.astype(np.int64))


def taken_parts(
    face: dict[str, Any], names: Mapping[Kind, Iterable[str]], faces: int
) -> tuple[Parts, ...]:
    """Take the parts that have names, and labels that fit these, out of the arrays of the faces."""
    found = []
    for kind in KINDS:
        if kind in face and kind in names:
            parts = parts_of(kind, face[kind], names[kind], faces)
            if parts is not None:
                found.append(parts)
                del face[kind]
    return tuple(found)


def names_key(kind: Kind) -> str:
    """Return the key under which the names of parts of a kind are kept."""
    return f"{kind}_names"


def keeping_order(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of `encode`, with `keep_order` unless it is given."""
    return {"keep_order": True, **options}


def warn_of_losses(lost: Iterable[str], where: str) -> None:
    """Warn of losses, unless there are none, and name them."""
    descriptions = ", ".join(dict.fromkeys(lost))
    if descriptions:
        warnings.warn(f"not kept in {where}: {descriptions}", stacklevel=3)
