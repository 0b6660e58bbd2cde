"""Names of attributes in glTF, its semantics (glTF 2.0, section 3.7.2.1)."""

from __future__ import annotations

import re
from typing import Final

from deltamesh_formats.polymesh.mesh import Attribute, Role

_SETS: Final[dict[str, tuple[str, Role]]] = {
    "TEXCOORD": ("uv", "uv"),
    "COLOR": ("colour", "colour"),
}
_SET: Final = re.compile(r"(TEXCOORD|COLOR)_(\d+)")
_NAME: Final = re.compile(r"(uv|colour)(\d*)")
_PLAIN: Final = {"NORMAL": "normal", "TANGENT": "tangent"}
_SKIN: Final = re.compile(r"(JOINTS|WEIGHTS)_\d+")
# Widths of the attributes of each role.
_WIDTHS: Final[dict[Role, tuple[int, ...]]] = {"uv": (2,), "colour": (3, 4), "normal": (3,)}


def name_of(semantic: str) -> tuple[str, Role]:
    """Return name and role of an attribute by its semantic."""
    found = _SET.fullmatch(semantic)
    if found:
        name, role = _SETS[found[1]]
        number = int(found[2])
        return f"{name}{number or ''}", role
    if semantic in _PLAIN:
        return _PLAIN[semantic], "normal" if semantic == "NORMAL" else "other"
    return semantic.removeprefix("_"), "other"


def semantic_of(attribute: Attribute) -> str:
    """Return the semantic of an attribute; where glTF has none, it is "_" and the name."""
    name, real = attribute.name, attribute.values.dtype.kind == "f"
    if attribute.role != "other" and attribute.width in _WIDTHS[attribute.role]:
        found = _NAME.fullmatch(name)
        if found and (real or attribute.normalized):
            key = "TEXCOORD" if found[1] == "uv" else "COLOR"
            return f"{key}_{int(found[2] or 0)}"
        if name == "normal" and real:
            return "NORMAL"
    if (name == "tangent" and attribute.width == 4 and real) or _SKIN.fullmatch(name):
        return name.upper()
    return "_" + name
