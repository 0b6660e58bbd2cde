"""Types and properties of PLY by name (Turk, The PLY Polygon File Format, 1994)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final, NamedTuple

from deltamesh_formats.polymesh.mesh import Role

# Names of 1994, those of later writers, and 64-bit integers, which no standard has.
TYPES: Final[Mapping[str, str]] = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
    "int64": "i8",
    "uint64": "u8",
}
_WRITTEN: Final = ("char", "uchar", "short", "ushort", "int", "uint", "float", "double")
NAMES: Final[Mapping[str, str]] = {TYPES[name]: name for name in _WRITTEN}

FORMATS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
POSITION: Final = ("x", "y", "z")
INDICES: Final = ("vertex_indices", "vertex_index")


class Group(NamedTuple):
    """Properties that make up one attribute."""

    name: str
    role: Role
    properties: tuple[str, ...]


# A longer group comes before one that it begins with.
GROUPS: Final = (
    Group("normal", "normal", ("nx", "ny", "nz")),
    Group("colour", "colour", ("red", "green", "blue", "alpha")),
    Group("colour", "colour", ("red", "green", "blue")),
    Group("rgb", "colour", ("r", "g", "b", "a")),
    Group("rgb", "colour", ("r", "g", "b")),
    *(
        Group(name, "colour", tuple(f"{name}_{channel}" for channel in channels))
        for name in ("diffuse", "ambient", "specular")
        for channels in (("red", "green", "blue", "alpha"), ("red", "green", "blue"))
    ),
    Group("uv", "uv", ("s", "t")),
    Group("u v", "uv", ("u", "v")),
    Group("texture_u texture_v", "uv", ("texture_u", "texture_v")),
)
# List of the texture coordinates of a face, as VCG and its users name it.
WEDGE_UV: Final = "texcoord"

_ROLES: Final = re.compile(r"(normal|uv|colour)\d*")


def role_of(name: str) -> Role:
    """Return the role of an attribute by its name."""
    found = _ROLES.fullmatch(name)
    roles: dict[str, Role] = {"normal": "normal", "uv": "uv", "colour": "colour"}
    return roles[found[1]] if found else "other"


def properties_of(name: str, width: int) -> tuple[str, ...]:
    """Return the names of the properties of an attribute."""
    for group in GROUPS:
        if group.name == name and len(group.properties) == width:
            return group.properties
    return (name,) if width == 1 else tuple(f"{name}_{i}" for i in range(width))
