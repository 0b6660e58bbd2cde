"""Types of the fields of glTF that the reader uses, checked once; faults are named by their path.

Fields that are not here are not read, or may be of any type. The tables are after the JSON schemas
of glTF 2.0 (Khronos Group, 2021, section 5).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final, TypeAlias

from deltamesh_formats.errors import MeshError

# A type of `_TYPES`; a list of a schema is an array of such elements, a table an object whose
# fields, if they are there, are of these schemas. `EACH` stands for all fields that an object has.
Schema: TypeAlias = "str | list[Schema] | dict[str, Schema]"

Tree: TypeAlias = Mapping[str, Any]

_TYPES: Final[Mapping[str, tuple[type, ...]]] = {
    "an object": (dict,),
    "an array": (list,),
    "a number": (int, float),
    "a string": (str,),
    "anything": (object,),
}
EACH: Final = "*"
_LONGEST: Final = 40  # of a value in a message

_ARRAY: Final[Schema] = ["anything"]
_OBJECTS: Final[Schema] = ["an object"]
_SPARSE: Final[Schema] = {"count": "a number", "indices": "an object", "values": "an object"}
_PRIMITIVE: Final[Schema] = {
    "attributes": {EACH: "a number"},
    "indices": "a number",
    "material": "a number",
    "mode": "a number",
    "extensions": "an object",
}
_FILE: Final[Schema] = {
    "scene": "a number",
    "scenes": [{"nodes": ["a number"]}],
    "nodes": [{"mesh": "a number", "children": ["a number"]}],
    "meshes": [{"primitives": [_PRIMITIVE]}],
    "accessors": [{"bufferView": "a number", "type": "a string", "sparse": _SPARSE}],
    "bufferViews": [{"buffer": "a number", "extensions": "an object"}],
    "buffers": [{"uri": "a string"}],
    "materials": _OBJECTS,
    "extensionsUsed": _ARRAY,
    "extensionsRequired": _ARRAY,
    **dict.fromkeys(("animations", "skins", "cameras", "textures", "images"), _ARRAY),
}


def check_types(tree: Mapping[str, Any]) -> None:
    """Refuse a file whose JSON has another type where one of those above belongs.

    Raises
    ------
    MeshError
        With the path of the field, such as "meshes[0].primitives is 5, not an array".
    """
    check(tree, _FILE, "")


def shown(value: object) -> str:
    """Return the JSON of a value, or its beginning, for a message."""
    text = json.dumps(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def check(value: object, schema: Schema, path: str) -> None:
    """Refuse a value of another type than its schema has; the path is that of messages.

    Raises
    ------
    MeshError
    """
    if isinstance(schema, str):
        _check_type(value, schema, path)
    elif isinstance(schema, list):
        _check_type(value, "an array", path)
        assert isinstance(value, list)
        for i, element in enumerate(value):
            check(element, schema[0], f"{path}[{i}]")
    else:
        _check_type(value, "an object", path)
        assert isinstance(value, dict)
        for name in value if EACH in schema else schema:
            if name in value:
                inner = schema.get(name, schema.get(EACH, "anything"))
                check(value[name], inner, f"{path}.{name}" if path else name)


def _check_type(value: object, name: str, path: str) -> None:
    if not isinstance(value, _TYPES[name]) or (isinstance(value, bool) and name == "a number"):
        raise MeshError(f"{path} is {shown(value)}, not {name}")


def items(tree: Tree, name: str) -> list[Any]:
    """Return an array in an object whose type is checked, empty if it is not there."""
    found: list[Any] = tree.get(name, [])
    return found
