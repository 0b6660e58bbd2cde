"""Writer of GLB and glTF.

Each object is a node with a mesh, and so are the faces without an object. Positions are float32,
relative to the node: the transform that a scene had is undone, and where float32 would lose much,
as it does far from the origin, the node is moved.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.meshfiles import placement
from deltamesh_formats.meshfiles.file_format import FileFormat
from deltamesh_formats.meshfiles.float32 import (
    bounding_diagonal,
    rounding_error,
    rounding_losses,
    single_positions,
)
from deltamesh_formats.meshfiles.glb.accessors import COMPONENTS
from deltamesh_formats.meshfiles.glb.chunks import BINARY_CHUNK, JSON_CHUNK, MAGIC
from deltamesh_formats.meshfiles.glb.extensions import QUANTIZED
from deltamesh_formats.meshfiles.glb.semantics import is_quantized, semantic_of
from deltamesh_formats.meshfiles.glb.vertex_groups import Groups, grouped
from deltamesh_formats.polymesh.descriptions import describe_attribute
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

_CODES: Final = {kind: code for code, kind in COMPONENTS.items()}
_TYPES: Final = ("", "SCALAR", "VEC2", "VEC3", "VEC4")
_VERTICES, _INDICES = 34962, 34963
# As a fraction of the diagonal of a mesh: rounding up to it is that of float32 at the size of the
# mesh, of which moving the node takes nothing.
_UNSEEN: Final = 2.0**-22


def made(mesh: PolyMesh, form: FileFormat) -> tuple[dict[str, Any], bytes, tuple[str, ...]]:
    """Make a glTF; polygons become triangles, and vertices whose corners differ are repeated.

    Parameters
    ----------
    mesh : PolyMesh
    form : FileFormat
        GLB or glTF.

    Returns
    -------
    tree : dict
        Its JSON, with one buffer.
    buffer : bytes
    lost : tuple of str
        Descriptions of what they do not hold.
    """
    objects = mesh.parts_of("object")
    of_face = np.full(len(mesh.sizes), -1) if objects is None else objects.of_face
    kept = _kept(mesh)
    groups = grouped(mesh, [attribute for attribute, _, _ in kept], of_face)
    writer = _Writer(mesh, groups, kept, form.title)
    order = np.argsort(groups.objects, kind="stable")
    numbers, starts = np.unique(groups.objects[order], return_index=True)
    for number, mine in zip(numbers.tolist(), np.split(order, starts[1:]), strict=True):
        writer.add_object(number, mine)
    lost = form.losses(mesh, [attribute for attribute, _, _ in kept])
    return writer.tree(), b"".join(writer.buffer), (*lost, *writer.losses())


def glb_bytes(tree: dict[str, Any], buffer: bytes) -> bytes:
    """Return the GLB of a JSON and its buffer."""
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(JSON_CHUNK, text), (BINARY_CHUNK, buffer)]
    body = b"".join(len(raw).to_bytes(4, "little") + kind + raw for kind, raw in chunks)
    return MAGIC + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


_Kept = tuple[Attribute, str, NDArray[Any]]


def _kept(mesh: PolyMesh) -> list[_Kept]:
    """Return the attributes that glTF holds, with semantics and values in its types.

    Two of one name are kept when no vertex has both.
    """
    found: list[_Kept] = []
    taken: dict[str, Ints] = {}
    for attribute in mesh.attributes:
        values = _single(attribute.values)
        if attribute.domain == "face" or attribute.width > 4 or values is None:
            continue
        semantic = semantic_of(attribute)
        has = attribute.rows() >= 0
        if attribute.domain == "corner":
            corners, has = mesh.corners[has], np.zeros(len(mesh.vertices), dtype=bool)
            has[corners] = True
        others = taken.get(semantic, np.empty(0, dtype=np.int64))
        if not has[others].any():
            taken[semantic] = np.append(others, np.flatnonzero(has))
            found.append((attribute, semantic, values))
    return found


def _single(values: NDArray[Any]) -> NDArray[Any] | None:
    """Return numbers in a type of glTF, None if there is none that holds these integers exactly."""
    kind = values.dtype.str[1:]
    if kind in _CODES and kind != "u4":
        return values.astype("<" + kind)
    if values.dtype.kind in "iu" and int(np.abs(values).max(initial=0)) > 1 << 24:
        return None
    if values.dtype.kind not in "fiub":
        return None
    with np.errstate(over="ignore"):
        return values.astype("<f4")


class _Writer:
    """JSON and buffer of a file as they grow."""

    def __init__(self, mesh: PolyMesh, groups: Groups, kept: list[_Kept], title: str) -> None:
        self.mesh, self.groups, self.kept, self.title = mesh, groups, kept, title
        self.rounding, self.has_moved = 0.0, False
        self.mesh_of_object = _meshes_of_objects(mesh)
        self.buffer: list[bytes] = []
        self.size = 0
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        materials = mesh.parts_of("material")
        self.materials = () if materials is None else materials.names
        of_face = np.full(len(mesh.sizes), -1) if materials is None else materials.of_face
        # Triangles by group and material: those of one pair are a primitive.
        group = np.searchsorted(groups.starts, groups.faces[:, 0], side="right") - 1
        self.order = np.lexsort([of_face[groups.polygon], group])
        self.sorted = np.stack([group, of_face[groups.polygon]], axis=1)[self.order]

    def add_object(self, number: int, mine: Ints) -> None:
        """Add a node, and its mesh of these groups."""
        vertices = np.concatenate([self._vertices(group) for group in mine.tolist()])
        matrix, node = self._transform(number, self.mesh.vertices[vertices])
        primitives = []
        for group in mine.tolist():
            primitives += self._group(group, matrix)
        name, mesh_name = self._names(number)
        named = {"name": mesh_name} if mesh_name else {}
        node |= {"mesh": len(self.meshes)} | ({"name": name} if name else {})
        self.nodes.append(node)
        self.meshes.append({"primitives": primitives} | named)

    def _vertices(self, group: int) -> Ints:
        return self.groups.vertex[self._slice(group)]

    def _slice(self, group: int) -> slice:
        return slice(int(self.groups.starts[group]), int(self.groups.starts[group + 1]))

    def _names(self, number: int) -> tuple[str, str]:
        """Return the names of the node and of the mesh of an object."""
        objects, meshes = self.mesh.parts_of("object"), self.mesh.parts_of("mesh")
        if objects is None or number < 0:
            return "", ""
        name = _valid(objects.names[number])
        if meshes is not None and self.mesh_of_object[number] >= 0:
            return name, _valid(meshes.names[self.mesh_of_object[number]])
        return name, name

    def _transform(self, number: int, points: Floats) -> tuple[Floats, dict[str, Any]]:
        """Return the transform of an object, and its node."""
        objects = self.mesh.parts_of("object")
        matrix = np.eye(4)
        if objects is not None and objects.transforms is not None and number >= 0:
            matrix = objects.transforms[number]
            with np.errstate(all="ignore"):
                condition = np.linalg.cond(matrix[:3, :3])
            if not condition < 1e12:
                matrix = np.eye(4)  # it has no inverse: the vertices are where it put them
        local = placement.moved_back(points, matrix)
        diagonal = bounding_diagonal(local)
        if _error(local, points, matrix) > (self.mesh.margin or _UNSEEN * diagonal):
            # Coarse numbers, so that taking them off rounds little.
            grid = 2.0 ** np.ceil(np.log2(diagonal)) if 0 < diagonal < np.inf else 1.0
            centre = np.round((local.min(axis=0) + local.max(axis=0)) / 2 / grid) * grid
            self.has_moved |= bool(centre.any()) and not placement.is_identity(matrix)
            shift = np.eye(4)
            shift[:3, 3] = centre
            matrix = matrix @ shift
        if placement.is_identity(matrix):
            return matrix, {}
        if placement.is_identity(matrix[:3, :3]):
            return matrix, {"translation": matrix[:3, 3].tolist()}
        return matrix, {"matrix": matrix.T.ravel().tolist()}

    def _group(self, group: int, matrix: Floats) -> list[dict[str, Any]]:
        """Add the vertices of a group; return its primitives, one for each material."""
        some = self._slice(group)
        points = placement.moved_back(self.mesh.vertices[self._vertices(group)], matrix)
        local = single_positions(points, self.title)
        here = self.mesh.vertices[self._vertices(group)]
        self.rounding = max(
            self.rounding, rounding_error(placement.moved(local.astype(np.float64), matrix), here)
        )
        bounds = {"min": local.min(axis=0).tolist(), "max": local.max(axis=0).tolist()}
        attributes = {"POSITION": self._add(self._accessor(local, _VERTICES) | bounds)}
        back = np.linalg.inv(matrix).astype(np.float64)
        for number, rows in self.groups.rows[group].items():
            attribute, semantic, values = self.kept[number]
            accessor = self._accessor(
                placement.turned(attribute.name, values[rows], back), _VERTICES
            )
            if attribute.normalized and values.dtype.kind in "iu":
                accessor["normalized"] = True
            attributes[semantic] = self._add(accessor)
        begin, end = np.searchsorted(self.sorted[:, 0], [group, group + 1]).tolist()
        cuts = begin + np.flatnonzero(np.diff(self.sorted[begin:end, 1], prepend=-2))
        primitives = []
        for first, last in zip(cuts.tolist(), [*cuts[1:].tolist(), end], strict=True):
            faces = self.groups.faces[self.order[first:last]] - some.start
            if placement.is_mirror(matrix):
                faces = faces[:, ::-1]
            kind = "<u2" if some.stop - some.start < 1 << 16 else "<u4"
            indices = self._add(self._accessor(faces.reshape(-1, 1).astype(kind), _INDICES))
            material = int(self.sorted[first, 1])
            own = {"material": material} if material >= 0 else {}
            primitives.append({"attributes": attributes, "indices": indices} | own)
        return primitives

    def _add(self, accessor: dict[str, Any]) -> int:
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _accessor(self, values: NDArray[Any], target: int) -> dict[str, Any]:
        """Put a table into the buffer, its rows padded to four bytes for vertices."""
        row = values.shape[1] * values.dtype.itemsize
        raw = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), row)
        view: dict[str, int] = {"buffer": 0, "byteOffset": self.size, "target": target}
        if target == _VERTICES and row % 4:
            raw = np.pad(raw, ((0, 0), (0, -row % 4)))
            view["byteStride"] = raw.shape[1]
        data = raw.tobytes()
        view["byteLength"] = len(data)
        self.buffer += [data, bytes(-len(data) % 4)]
        self.size += len(data) + -len(data) % 4
        self.views.append(view)
        return {
            "bufferView": len(self.views) - 1,
            "componentType": _CODES[values.dtype.str[1:]],
            "count": len(values),
            "type": _TYPES[values.shape[1]],
        }

    def losses(self) -> Iterator[str]:
        """Yield descriptions of what the nodes and the tables do not hold."""
        yield from self.groups.lost
        largest = float(np.abs(self.mesh.vertices).max(initial=0))
        yield from rounding_losses("positions", self.rounding, self.mesh.margin, largest)
        for attribute, _, values in self.kept:
            error = rounding_error(values, attribute.values)
            yield from rounding_losses(describe_attribute(attribute), error, attribute.margin)
        if self.has_moved:
            yield "transforms, which are moved to where float32 holds the positions"

    def tree(self) -> dict[str, Any]:
        """Return the JSON of the file."""
        said = self.mesh.metadata.get("copyright", ())
        copyright_ = {"copyright": said[0]} if said else {}
        tree: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "deltamesh"} | copyright_,
            "scene": 0,
            "scenes": [{"nodes": list(range(len(self.nodes)))}],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.size}],
        }
        if any(is_quantized(semantic, values) for _, semantic, values in self.kept):
            tree |= {"extensionsUsed": [QUANTIZED], "extensionsRequired": [QUANTIZED]}
        if self.materials:
            tree["materials"] = [{"name": _valid(name)} for name in self.materials]
        return tree


def _error(local: Floats, points: Floats, matrix: Floats) -> float:
    """Return how far points move at most when their local coordinates are rounded to float32."""
    with np.errstate(all="ignore"):
        single = local.astype(np.float32).astype(np.float64)
        return rounding_error(placement.moved(single, matrix), points)


def _meshes_of_objects(mesh: PolyMesh) -> Ints:
    """Return the "mesh" part that all faces of each object are in, -1 if there is not just one."""
    objects, meshes = mesh.parts_of("object"), mesh.parts_of("mesh")
    if objects is None or meshes is None:
        return np.empty(0, dtype=np.int64)
    least = np.full(len(objects.names), len(meshes.names))
    most = np.full(len(objects.names), -1)
    named = objects.of_face >= 0
    np.minimum.at(least, objects.of_face[named], meshes.of_face[named])
    np.maximum.at(most, objects.of_face[named], meshes.of_face[named])
    return np.where(least == most, most, -1)


def _valid(name: str) -> str:
    """Return a name with "?" for bytes that are not UTF-8."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
