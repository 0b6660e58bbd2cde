"""Reader of 3MF: each object that is built is an object, with its name and its transform.

Base materials are materials, and colours of the Materials Extension are colours of corners.
Textures, metadata, part numbers and the elements of other extensions are named as lost.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import placement
from deltamesh_formats.meshfiles.threemf.model import Key, Model, Object, Placement, read_model
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles

# Components may name an object any number of times: so many numbers and objects are placed at most.
_MOST: Final = 1 << 28
_MOST_PLACES: Final = 1 << 17
_DEEPEST: Final = 100


def read(data: bytes) -> PolyMesh:
    """Read a 3MF.

    Raises
    ------
    MeshError
        For a file that is not valid; the element at fault is named.
    """
    model = read_model(data)
    placed = list(_placed(model))
    if not placed:
        return from_triangles(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
    reached = {one.key for one in placed}
    if any(one.corners and key not in reached for key, one in model.objects.items()):
        model.lost["objects that are not built"] = None
    if len(reached) < len(placed):
        model.lost["the sharing of an object"] = None
    properties = _Properties(model)
    vertices, faces, start = [], [], 0
    for one in placed:
        found = model.objects[one.key]
        points = np.array(found.coordinates, dtype=np.float64).reshape(-1, 3)
        corners = np.array(found.corners, dtype=np.int64).reshape(-1, 3)
        if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
            at = next(x for x in found.corners if not 0 <= x < len(points))
            raise MeshError(f"object {one.key[1]} has a face with vertex {at}, of {len(points)}")
        mirrored = placement.is_mirror(one.matrix)
        properties.add(one.key, found, mirrored=mirrored)
        faces.append(start + (corners[:, ::-1] if mirrored else corners))
        with np.errstate(all="ignore"):
            vertices.append(placement.moved(points, one.matrix))
        start += len(points)
    mesh = from_triangles(np.concatenate(vertices), np.concatenate(faces))
    of_face = np.repeat(np.arange(len(placed)), [len(some) for some in faces])
    material = properties.materials()
    objects = _objects(model, placed, of_face)
    return PolyMesh(
        mesh.vertices,
        mesh.corners,
        mesh.offsets,
        properties.colours(),
        tuple(parts for parts in (objects, material) if parts is not None),
        {"units": (model.unit,)} if model.unit else {},
        tuple(model.lost),
    )


def _placed(model: Model) -> Iterator[Placement]:
    """Yield the objects with triangles, placed; of a file that builds none, all."""
    build = model.build or [Placement(key, np.eye(4)) for key in model.objects]
    stack = [(one, 0) for one in reversed(build)]
    places = numbers = 0
    while stack:
        (key, matrix), depth = stack.pop()
        if key not in model.objects:
            raise MeshError(f"there is no object {key[1][:40]!r}")
        one = model.objects[key]
        places += 1
        numbers += len(one.coordinates) + len(one.corners)
        if depth > _DEEPEST or places > _MOST_PLACES or numbers > _MOST:
            raise MeshError("its components repeat themselves, or are too many")
        if one.corners or one.coordinates:
            yield Placement(key, matrix)
        if one.components:
            model.lost["the hierarchy of components"] = None
        with np.errstate(all="ignore"):
            below = [Placement(inner, matrix @ own) for inner, own in one.components]
        stack += [(inner, depth + 1) for inner in reversed(below)]


def _objects(model: Model, placed: list[Placement], of_face: Ints) -> Parts | None:
    names = tuple(model.objects[one.key].name for one in placed)
    transforms = np.array([one.matrix for one in placed])
    plain = bool((transforms == np.eye(4)).all())
    if len(placed) == 1 and plain and not any(names):
        return None
    return Parts("object", names, of_face, None if plain else transforms)


class _Properties:
    """Materials and colours of triangles, as they are placed."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._names = [
            *((key, i) for key, all_ in model.materials.items() for i in range(len(all_)))
        ]
        self._number = {one: i for i, one in enumerate(self._names)}
        self._first: dict[Key, int] = {}
        self._rows = [row for rows in model.colours.values() for row in rows]
        count = 0
        for key, rows in model.colours.items():
            self._first[key] = count
            count += len(rows)
        self._of_face: list[int] = []
        self._of_corner: list[int] = []

    def add(self, key: Key, one: Object, *, mirrored: bool) -> None:
        """Add the triangles of an object."""
        for found in one.properties:
            material, colours = -1, (-1, -1, -1)
            if found is not None:
                group, numbers = (key[0], found[0]), found[1:]
                if group in self.model.materials:
                    if (group, numbers[0]) not in self._number:
                        raise MeshError(f"a triangle has base material {numbers[0]}: there is none")
                    material = self._number[group, numbers[0]]
                elif group in self._first:
                    count, first = len(self.model.colours[group]), self._first[group]
                    if not 0 <= min(numbers) <= max(numbers) < count:
                        raise MeshError(f"a triangle has colour {max(numbers)}, of {count}")
                    colours = (first + numbers[0], first + numbers[1], first + numbers[2])
                else:
                    self.model.lost["properties of triangles"] = None
                if material == -2:
                    raise MeshError(
                        f"a triangle has a base material {numbers[0]} that is not there"
                    )
            self._of_face.append(material)
            self._of_corner += reversed(colours) if mirrored else colours

    def materials(self) -> Parts | None:
        """Return the materials that faces have."""
        used, of_face = np.unique(np.array(self._of_face, dtype=np.int64), return_inverse=True)
        none = int(len(used) > 0 and used[0] == -1)
        if len(used) == none:
            return None
        keys = [self._names[i] for i in used[none:].tolist()]
        names = tuple(self.model.materials[key][i] or f"material_{i}" for key, i in keys)
        return Parts("material", names, of_face.astype(np.int64) - none)

    def colours(self) -> tuple[Attribute, ...]:
        """Return the colours of corners, if there are any."""
        index = np.array(self._of_corner, dtype=np.int64)
        if not (index >= 0).any():
            return ()
        values = np.array(self._rows, dtype=np.uint8)
        if (values[:, 3] == 255).all():
            values = np.ascontiguousarray(values[:, :3])
        return (Attribute("colour", "corner", values, "colour", index, normalized=True),)
