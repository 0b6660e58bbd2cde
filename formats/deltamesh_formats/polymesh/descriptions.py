"""Descriptions of attributes, parts and metadata in plain English, for warnings of losses."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Final

import numpy as np

from deltamesh_formats.polymesh.kinds import KIND_WORDS, Kind
from deltamesh_formats.polymesh.mesh import Attribute, Domain, PolyMesh, Role

_ROLES: Final[dict[Role, str]] = {
    "normal": "normals",
    "uv": "texture coordinates",
    "colour": "colours",
}
_DOMAINS: Final[dict[Domain, str]] = {"vertex": "vertices", "corner": "corners", "face": "faces"}
# Comments and headers, in which programs speak of themselves, are not worth a warning.
_METADATA: Final = {
    "mtllib": "material libraries",
    "copyright": "copyright",
    "units": "the unit",
}


def losses_of(
    mesh: PolyMesh,
    *,
    attributes: Collection[Attribute] = (),
    parts: Collection[Kind] = (),
    metadata: Collection[str] = (),
    polygons: bool = False,
    transforms: bool = False,
) -> tuple[str, ...]:
    """Return descriptions of what is lost of a mesh that is converted to another form.

    Positions and triangles are kept; the arguments name what is kept besides.

    Parameters
    ----------
    mesh : PolyMesh
    attributes : collection of Attribute
        Attributes of the mesh.
    parts : collection of str
        Kinds of parts.
    metadata : collection of str
        Keys of metadata; comments and headers are never named as lost.
    polygons, transforms : bool
        Whether faces of more than three corners are kept, and transforms of parts.

    Returns
    -------
    tuple of str
        Each once; those of `PolyMesh.lost` come first.
    """
    losses = dict.fromkeys(mesh.lost)
    if not polygons and (mesh.sizes != 3).any():
        losses["polygons of more than three corners"] = None
    kept = {id(attribute) for attribute in attributes}
    for attribute in mesh.attributes:
        if id(attribute) not in kept:
            losses[describe_attribute(attribute)] = None
    for group in mesh.parts:
        if group.kind not in parts:
            losses[KIND_WORDS[group.kind]] = None
        if group.transforms is not None and not transforms and _moves(group.transforms):
            losses["transforms"] = None
    return (*losses, *_metadata_losses(mesh, metadata))


def unreferenced_rows(mesh: PolyMesh) -> Iterator[str]:
    """Yield descriptions of rows of attributes that no element has; an encoder drops these."""
    for attribute in mesh.attributes:
        if attribute.index is None:
            continue
        used = np.bincount(attribute.index[attribute.index >= 0], minlength=len(attribute.values))
        if not used.all():
            whose = "vertex" if attribute.domain == "vertex" else "face"
            yield f"{describe_attribute(attribute)} that no {whose} refers to"


def filled_gaps(attributes: Iterable[Attribute]) -> Iterator[str]:
    """Yield descriptions of gaps that are filled where each element has to have a row."""
    for attribute in attributes:
        if attribute.index is not None and (attribute.index < 0).any():
            filler = "white" if attribute.role == "colour" else f"{attribute.filler:g}"
            filler = filler.replace("nan", "NaN")
            yield f"gaps in {describe_attribute(attribute)} (filled with {filler})"


def describe_attribute(attribute: Attribute) -> str:
    """Return a plural for an attribute: "normals", "colours of faces", "quality of vertices"."""
    what = _ROLES.get(attribute.role, attribute.name)
    if attribute.name[-1:].isdigit() and attribute.role in _ROLES:
        what += f" ({attribute.name})"
    usual = attribute.role in ("normal", "uv") or attribute.domain == "vertex"
    if attribute.role in _ROLES and usual:
        return what
    return f"{what} of {_DOMAINS[attribute.domain]}"


def _moves(transforms: np.ndarray) -> bool:
    return bool((transforms != np.eye(4)).any())


def _metadata_losses(mesh: PolyMesh, kept: Collection[str]) -> Iterator[str]:
    for key, description in _METADATA.items():
        if mesh.metadata.get(key) and key not in kept:
            yield description
