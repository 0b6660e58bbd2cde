"""Origin of texture coordinates: the bottom left of the picture, or its top left.

glTF 2.0, section 3.9.3, has (0, 0) at the top left; OBJ, PLY, OFF and the libraries that draw them
have it at the bottom left. A mesh keeps the numbers of its file, so that they come back to the last
bit in a file of the same kind, and has the origin in its metadata; writers of other kinds convert.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

KEY: Final = "texture_origin"
TOP_LEFT: Final = ("top left",)


def is_top_left(mesh: PolyMesh) -> bool:
    """Return whether the texture coordinates of a mesh begin at the top left."""
    return mesh.metadata.get(KEY) == TOP_LEFT


def marked_top_left(mesh: PolyMesh) -> PolyMesh:
    """Return a mesh with metadata of that origin, if it has texture coordinates."""
    if mesh.attribute("uv", "vertex", "corner") is None:
        return mesh
    return replace(mesh, metadata={**mesh.metadata, KEY: TOP_LEFT})


def with_origin(mesh: PolyMesh, *, top_left: bool) -> PolyMesh:
    """Return a mesh whose texture coordinates begin there: v becomes 1 - v if they do not yet.

    Integers that are not normalized are not fractions, and stay as they are.
    """
    if is_top_left(mesh) == top_left:
        return mesh
    metadata = {key: texts for key, texts in mesh.metadata.items() if key != KEY}
    attributes = tuple(_flipped(a) if a.role == "uv" else a for a in mesh.attributes)
    flipped = replace(mesh, attributes=attributes, metadata=metadata)
    return marked_top_left(flipped) if top_left else flipped


def _flipped(attribute: Attribute) -> Attribute:
    values: NDArray[Any] = attribute.values.copy()
    if attribute.width < 2:
        return attribute
    if values.dtype.kind == "f":
        values[:, 1] = 1 - values[:, 1]
    elif attribute.normalized and values.dtype.kind == "u":
        values[:, 1] = np.iinfo(values.dtype).max - values[:, 1]
    return replace(attribute, values=values)
