"""Where texture coordinates begin: at the bottom left of the picture, or at its top left as in GLB.

glTF 2.0, section 3.9.3, has (0, 0) at the top left; OBJ, PLY, OFF and the libraries that draw them
have it at the bottom left. Numbers stay as a file has them, so that they come back to the last bit
where nothing is converted; metadata tell which they are, and who writes another kind of file turns
them.
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
    """Tell whether the texture coordinates of a mesh begin at the top left."""
    return mesh.metadata.get(KEY) == TOP_LEFT


def marked_top_left(mesh: PolyMesh) -> PolyMesh:
    """Return a mesh of which metadata tell that, if it has texture coordinates."""
    if mesh.attribute("uv", "vertex", "corner") is None:
        return mesh
    return replace(mesh, metadata={**mesh.metadata, KEY: TOP_LEFT})


def with_origin(mesh: PolyMesh, *, top_left: bool) -> PolyMesh:
    """Return a mesh whose texture coordinates begin there: v becomes 1 - v where they do not yet.

    What is no fraction, whole numbers that are not normalized, stays as it is.
    """
    if is_top_left(mesh) == top_left:
        return mesh
    metadata = {key: words for key, words in mesh.metadata.items() if key != KEY}
    attributes = tuple(_turned(a) if a.role == "uv" else a for a in mesh.attributes)
    turned = replace(mesh, attributes=attributes, metadata=metadata)
    return marked_top_left(turned) if top_left else turned


def _turned(attribute: Attribute) -> Attribute:
    values: NDArray[Any] = attribute.values.copy()
    if attribute.width < 2:
        return attribute
    if values.dtype.kind == "f":
        values[:, 1] = 1 - values[:, 1]
    elif attribute.normalized and values.dtype.kind == "u":
        values[:, 1] = np.iinfo(values.dtype).max - values[:, 1]
    return replace(attribute, values=values)
