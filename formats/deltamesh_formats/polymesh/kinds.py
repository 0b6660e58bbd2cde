"""Kinds of parts into which the polygons of a mesh are divided, and the words for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal, TypeAlias

Kind: TypeAlias = Literal["object", "mesh", "group", "material", "smoothing"]

KIND_WORDS: Final[Mapping[Kind, str]] = {
    "object": "objects",
    "mesh": "names of meshes",
    "group": "groups",
    "material": "materials",
    "smoothing": "smoothing groups",
}
