"""Objects, properties and build of a 3MF, as its XML has them."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.threemf.archive import Archive

# A file of the package, and the id of a resource in it.
Key = tuple[str, str]
Rgba = tuple[int, int, int, int]

_TEXTURES: Final = ("texture2d", "texture2dgroup")
_KNOWN: Final = frozenset(
    ["model", "resources", "mesh", "vertices", "triangles", "components", "build", "tex2coord"]
)


class Placement(NamedTuple):
    """Object by its key, and the transform that places it."""

    key: Key
    matrix: Floats


@dataclass
class Object:
    """Object: numbers of its vertices and triangles, flat, or the components that it is made of.

    `properties` has for each triangle the id of a group of properties and three numbers in it,
    None for no properties.
    """

    name: str
    pid: str
    pindex: str
    coordinates: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    properties: list[tuple[str, int, int, int] | None] = field(default_factory=list)
    components: list[Placement] = field(default_factory=list)


@dataclass
class Model:
    """What a 3MF has; `lost` describes the rest."""

    unit: str = ""
    objects: dict[Key, Object] = field(default_factory=dict)
    materials: dict[Key, list[str]] = field(default_factory=dict)
    colours: dict[Key, list[Rgba]] = field(default_factory=dict)
    build: list[Placement] = field(default_factory=list)
    lost: dict[str, None] = field(default_factory=dict)


def read_model(data: bytes) -> Model:
    """Read the model of a 3MF, and the other models that its components are in.

    Raises
    ------
    MeshError
        For what is no 3MF; the element at fault is named.
    """
    archive, model = Archive(data), Model()
    waiting = [archive.model()]
    done = set[str]()
    while waiting:
        path = waiting.pop()
        if _canonical(path) not in done:
            done.add(_canonical(path))
            elements = _Elements(model, path, is_root=len(done) == 1)
            archive.parse(path, elements.start)
            waiting += elements.others
    return model


class _Elements:
    """Handlers of the elements of one model file."""

    def __init__(self, model: Model, path: str, *, is_root: bool) -> None:
        self.model, self.path, self.is_root = model, _canonical(path), is_root
        self.others: list[str] = []
        self.object = Object("", "", "")
        self.names: list[str] = []
        self.rows: list[Rgba] = []
        self.handlers: dict[str, Callable[[dict[str, str]], None]] = {
            "vertex": self._vertex,
            "triangle": self._triangle,
            "object": self._object,
            "component": lambda fields: self.object.components.append(self._placed(fields)),
            "item": self._item,
            "basematerials": self._materials,
            "base": self._base,
            "colorgroup": self._colours,
            "color": self._colour,
        }

    def start(self, name: str, fields: dict[str, str]) -> None:
        """Take an element by its name and attributes."""
        handler = self.handlers.get(name)
        if handler is not None:
            try:
                handler(fields)
            except KeyError as error:
                raise MeshError(f"a {name} has no {error.args[0]}") from None
            except (ValueError, OverflowError) as error:
                raise MeshError(f"a {name} is not readable: {error}") from None
        elif name == "model" and self.is_root:
            self.model.unit = fields.get("unit", "millimeter")
        elif name in ("metadata", "metadatagroup"):
            self.model.lost["metadata"] = None
        elif name in _TEXTURES:
            self.model.lost["textures"] = None
        elif name not in _KNOWN:
            self.model.lost[f"{name[:40]} elements"] = None

    def _vertex(self, fields: dict[str, str]) -> None:
        point = (float(fields["x"]), float(fields["y"]), float(fields["z"]))
        self.object.coordinates.extend(point)

    def _triangle(self, fields: dict[str, str]) -> None:
        one = self.object
        one.corners.extend((int(fields["v1"]), int(fields["v2"]), int(fields["v3"])))
        pid, first = fields.get("pid", one.pid), fields.get("p1", one.pindex)
        if not pid or not first:
            one.properties.append(None)
            return
        rest = (int(fields.get("p2", first)), int(fields.get("p3", first)))
        one.properties.append((pid, int(first), *rest))

    def _object(self, fields: dict[str, str]) -> None:
        self.object = Object(
            fields.get("name", ""), fields.get("pid", ""), fields.get("pindex", "")
        )
        if self.model.objects.setdefault((self.path, fields["id"]), self.object) is not self.object:
            raise MeshError(f"two objects have the id {fields['id'][:40]}")
        if "partnumber" in fields:
            self.model.lost["part numbers"] = None

    def _item(self, fields: dict[str, str]) -> None:
        if self.is_root:
            self.model.build.append(self._placed(fields))
        if "partnumber" in fields:
            self.model.lost["part numbers"] = None

    def _placed(self, fields: dict[str, str]) -> Placement:
        other = next((fields[key] for key in fields if key.endswith(" path")), None)
        if other is not None:
            self.others.append(other)
        matrix = np.eye(4)
        if "transform" in fields:
            numbers = [float(word) for word in fields["transform"].split()]
            if len(numbers) != 12 or not np.isfinite(numbers).all():
                raise MeshError("a transform is not 12 numbers")
            matrix[:3] = np.array(numbers).reshape(4, 3).T
        return Placement((_canonical(other or self.path), fields["objectid"]), matrix)

    def _materials(self, fields: dict[str, str]) -> None:
        self.names = self.model.materials.setdefault((self.path, fields["id"]), [])

    def _base(self, fields: dict[str, str]) -> None:
        self.names.append(fields.get("name", ""))
        if fields.get("displaycolor", GREY) != GREY:
            self.model.lost["the look of materials"] = None

    def _colours(self, fields: dict[str, str]) -> None:
        self.rows = self.model.colours.setdefault((self.path, fields["id"]), [])

    def _colour(self, fields: dict[str, str]) -> None:
        digits = fields["color"].removeprefix("#")
        if len(digits) not in (6, 8):
            raise ValueError(f"{fields['color'][:40]!r} is not a colour")
        red, green, blue, alpha = bytes.fromhex(digits.ljust(8, "F"))
        self.rows.append((red, green, blue, alpha))


# The colour of materials in files that we write: the format asks for one.
GREY: Final = "#808080"


def _canonical(path: str) -> str:
    return path.lstrip("/").lower()
