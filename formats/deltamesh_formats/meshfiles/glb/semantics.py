"""Names of attributes in glTF, its semantics (glTF 2.0, section 3.7.2.1)."""

from __future__ import annotations

import re
from typing import Any, Final

from numpy.typing import NDArray

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
    name, dtype = attribute.name, attribute.values.dtype
    # Integers that stand for fractions; signed ones are those of KHR_mesh_quantization.
    short = attribute.normalized and dtype.itemsize <= 2
    signed, unsigned = short and dtype.kind == "i", short and dtype.kind == "u"
    real = dtype.kind == "f"
    if attribute.role != "other" and attribute.width in _WIDTHS[attribute.role]:
        found = _NAME.fullmatch(name)
        if found and found[1] == "uv" and (real or signed or unsigned):
            return f"TEXCOORD_{int(found[2] or 0)}"
        if found and found[1] == "colour" and (real or unsigned):
            return f"COLOR_{int(found[2] or 0)}"
        if name == "normal" and (real or signed):
            return "NORMAL"
    is_tangent = name == "tangent" and attribute.width == 4 and (real or signed)
    return name.upper() if is_tangent or _SKIN.fullmatch(name) else "_" + name


def is_quantized(semantic: str, values: NDArray[Any]) -> bool:
    """Return whether an attribute is one that only KHR_mesh_quantization allows."""
    named = semantic in _PLAIN or semantic.startswith("TEXCOORD")
    return named and values.dtype.kind == "i"
