"""Statements of OBJ that the reader and the writer know (Wavefront, Object Files, version 3.0)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from deltamesh_formats.polymesh.kinds import Kind

# Statements that name the faces below them.
PARTS: Final[Mapping[Kind, bytes]] = {
    "object": b"o",
    "group": b"g",
    "material": b"usemtl",
    "smoothing": b"s",
}
# Names of "s" that turn smoothing off.
OFF: Final = ("off", "0")
KEPT: Final = frozenset([b"v", b"vt", b"vn", b"f", b"fo", b"mtllib", *PARTS.values()])
# Statements that are not kept, by what they are called among the losses.
OTHERS: Final[Mapping[str, tuple[bytes, ...]]] = {
    "points": (b"p",),
    "lines": (b"l",),
    "free-form geometry": tuple(
        b"vp cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con".split()
    ),
    "texture maps": (b"usemap", b"maplib"),
    "display settings": tuple(
        b"bevel c_interp d_interp lod shadow_obj trace_obj ctech stech mg call csh".split()
    ),
}
