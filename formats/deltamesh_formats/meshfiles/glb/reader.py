"""Reader of GLB and glTF: each placed mesh of the scene is an object, with name and transform.

It keeps all attributes of vertices, and names of nodes, meshes and materials. Strips and fans
become triangles. Points, lines, textures, the look of materials, animations, skins, extensions and
so on are named as lost. Files that need an extension that is not read are refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import placement
from deltamesh_formats.meshfiles.glb.accessors import Gltf
from deltamesh_formats.meshfiles.glb.compression import DRACO
from deltamesh_formats.meshfiles.glb.scene import Placed, placed_meshes, scene_losses
from deltamesh_formats.meshfiles.glb.schema import Tree, items, shown
from deltamesh_formats.meshfiles.glb.semantics import name_of
from deltamesh_formats.meshfiles.triangle_strips import triangles_of_strips
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_MODES: Final = {0: "points", 1: "lines", 2: "lines", 3: "lines"}
# Nodes may show a mesh, and primitives name an accessor, any number of times: a small file can ask
# for any amount of memory. This many numbers are read at most; with all that belongs to them they
# take up to 4 GiB, measured as the peak of a process.
_MOST: Final = 1 << 28


@dataclass
class _Block:
    """Vertices that primitives share: their accessors, and their last place in the scene."""

    accessors: dict[str, int]
    start: int = 0
    count: int = 0


@dataclass
class _Primitive:
    block: _Block
    faces: Ints
    material: int


@dataclass
class _Scene:
    """Mesh of the scene as it grows."""

    vertices: list[Floats] = field(default_factory=list)
    # By name, type and so on: where the values of each block begin, and the values.
    attributes: dict[tuple[Any, ...], list[tuple[int, NDArray[Any]]]] = field(default_factory=dict)
    faces: list[Ints] = field(default_factory=list)
    objects: list[int] = field(default_factory=list)
    materials: list[int] = field(default_factory=list)
    count: int = 0
    numbers: int = 0

    def add(self, numbers: int) -> None:
        """Count numbers that are read; too many are refused."""
        self.numbers += numbers
        if self.numbers > _MOST:
            raise MeshError(
                f"its scene has more than {_MOST} numbers: it repeats meshes, or has many"
                " attributes of few vertices"
            )


def read(gltf: Gltf) -> PolyMesh:
    """Read the scene of a GLB or a glTF.

    Raises
    ------
    MeshError
        For a file that is not valid; the element at fault is named.
    """
    placed, lost = placed_meshes(gltf), dict.fromkeys(scene_losses(gltf))
    if any(one.depth for one in placed):
        lost["the hierarchy of nodes"] = None
    if len({one.mesh for one in placed}) < len(placed):
        lost["the sharing of a mesh by nodes"] = None
    scene, read_meshes = _Scene(), {}
    for number, one in enumerate(placed):
        if one.mesh not in read_meshes:
            read_meshes[one.mesh] = list(_primitives(gltf, scene, one.mesh, lost))
        _place(gltf, scene, read_meshes[one.mesh], one, number)
    sizes = np.array([len(faces) for faces in scene.faces], dtype=np.int64)
    faces = np.concatenate([np.empty((0, 3), dtype=np.int64), *scene.faces])
    scene.faces.clear()  # a scene may take gigabytes: nothing is held twice for long
    asset = gltf.tree.get("asset", {})
    said = str(asset.get("copyright", "")) if isinstance(asset, dict) else ""
    vertices = np.concatenate([np.empty((0, 3)), *scene.vertices])
    scene.vertices.clear()
    with np.errstate(over="ignore"):  # transforms, and fractions, need not be in float32
        single = bool((vertices.astype(np.float32) == vertices).all())
    return PolyMesh(
        vertices,
        faces.ravel(),
        3 * np.arange(len(faces) + 1, dtype=np.int64),
        tuple(_attributes(scene)),
        tuple(_parts(gltf, placed, scene, sizes)),
        {"copyright": (said,)} if said else {},
        tuple(lost),
        "float32" if single else "float64",
    )


def _primitives(
    gltf: Gltf, scene: _Scene, mesh: int, lost: dict[str, None]
) -> Iterator[_Primitive]:
    """Yield the primitives of a mesh that have faces; the same accessors are the same vertices."""
    blocks: dict[tuple[tuple[str, int], ...], _Block] = {}
    for primitive in items(gltf.item("meshes", mesh), "primitives"):
        if "attributes" not in primitive:
            raise MeshError(f"a primitive of mesh {mesh} has no attributes")
        mode = primitive.get("mode", _TRIANGLES)
        if mode in _MODES:
            lost[_MODES[mode]] = None
            continue
        if mode not in (_TRIANGLES, _STRIP, _FAN):
            raise MeshError(f"a primitive of mesh {mesh} has mode {shown(mode)}")
        if "targets" in primitive:
            lost["morph targets"] = None
        accessors = primitive["attributes"]
        if "POSITION" not in accessors:
            raise MeshError(f"a primitive of mesh {mesh} has no POSITION")
        material = primitive.get("material", -1)
        if material != -1:
            gltf.item("materials", material)
        gltf.decode_draco(primitive)
        if mode != _TRIANGLES and DRACO in primitive.get("extensions", {}):
            raise MeshError(f"a primitive of mesh {mesh} has mode {mode} with Draco data")
        faces = _faces(gltf, primitive, mode)
        scene.add(faces.size)
        block = blocks.setdefault(tuple(sorted(accessors.items())), _Block(dict(accessors)))
        yield _Primitive(block, faces, material)


def _faces(gltf: Gltf, primitive: Tree, mode: int) -> Ints:
    """Return the triangles of a primitive, int64 (t, 3), over the vertices of its block."""
    if "indices" in primitive:
        values = gltf.accessor(primitive["indices"])
        if values.shape[1] != 1 or values.dtype.kind != "u":
            raise MeshError("the indices of a primitive are not unsigned whole numbers")
        indices = values.ravel().astype(np.int64)
    else:
        count = len(gltf.accessor(primitive["attributes"]["POSITION"]))
        indices = np.arange(count, dtype=np.int64)
    if mode == _STRIP:
        return triangles_of_strips(indices)
    if mode == _FAN:
        rim = np.stack([indices[1:-1], indices[2:]], axis=1)
        return np.concatenate([np.broadcast_to(indices[:1, None], (len(rim), 1)), rim], axis=1)
    if len(indices) % 3:
        raise MeshError(f"a primitive of triangles has {len(indices)} indices")
    return indices.reshape(-1, 3)


def _place(
    gltf: Gltf, scene: _Scene, primitives: list[_Primitive], one: Placed, number: int
) -> None:
    """Add a mesh to the scene, at its place."""
    done: set[int] = set()
    for primitive in primitives:
        block = primitive.block
        if id(block) not in done:
            done.add(id(block))
            _place_vertices(gltf, scene, block, one.matrix)
        highest = int(primitive.faces.max(initial=-1))
        if highest >= block.count:
            raise MeshError(f"mesh {one.mesh} has a face with vertex {highest}, of {block.count}")
        scene.add(primitive.faces.size)
        faces = primitive.faces[:, ::-1] if placement.is_mirror(one.matrix) else primitive.faces
        scene.faces.append(faces + block.start)
        scene.objects.append(number)
        scene.materials.append(primitive.material)


def _place_vertices(gltf: Gltf, scene: _Scene, block: _Block, matrix: Floats) -> None:
    points = _fractions(gltf, block.accessors["POSITION"])
    if points.shape[1] != 3:
        raise MeshError("positions of a mesh do not have three coordinates")
    block.start, block.count = scene.count, len(points)
    scene.count += block.count
    scene.add(points.size)
    with np.errstate(all="ignore"):
        scene.vertices.append(placement.moved(points, matrix))
    for semantic, accessor in block.accessors.items():
        if semantic == "POSITION":
            continue
        values = gltf.accessor(accessor)
        if len(values) != block.count:
            raise MeshError(f"{semantic} has {len(values)} rows for {block.count} vertices")
        scene.add(values.size)
        name, role = name_of(semantic)
        values = placement.turned(name, values, matrix)
        normalized = gltf.item("accessors", accessor).get("normalized") is True
        key = (name, role, values.dtype.str, values.shape[1], normalized)
        scene.attributes.setdefault(key, []).append((block.start, values))


def _fractions(gltf: Gltf, accessor: int) -> Floats:
    """Return positions as float64, those of normalized integers as fractions."""
    values = gltf.accessor(accessor)
    found = values.astype(np.float64)
    if gltf.item("accessors", accessor).get("normalized") is True and values.dtype.kind in "iu":
        found = np.maximum(found / np.iinfo(values.dtype).max, -1)
    return found


def _attributes(scene: _Scene) -> Iterator[Attribute]:
    for (name, role, _, _, normalized), blocks in scene.attributes.items():
        values, index = np.concatenate([rows for _, rows in blocks]), None
        if len(values) < scene.count:
            scene.add(scene.count)
            index, row = np.full(scene.count, -1, dtype=np.int64), 0
            for start, rows in blocks:
                index[start : start + len(rows)] = np.arange(row, row + len(rows))
                row += len(rows)
        native = values.astype(values.dtype.newbyteorder("="), copy=False)
        yield Attribute(name, "vertex", native, role, index, normalized)


def _parts(gltf: Gltf, placed: list[Placed], scene: _Scene, sizes: Ints) -> Iterator[Parts]:
    """Yield the objects, meshes and materials of the faces; `sizes` are the faces of primitives."""
    used, of_face = _numbered(scene.objects, sizes)
    kept = [placed[i] for i in used.tolist()]
    meshes = [str(gltf.item("meshes", one.mesh).get("name", "")) for one in kept]
    names = [one.name or mesh for one, mesh in zip(kept, meshes, strict=True)]
    transforms = np.array([one.matrix for one in kept]).reshape(-1, 4, 4)
    plain = bool((transforms == np.eye(4)).all())
    if len(kept) > 1 or any(names) or not plain:
        moves = None if plain else transforms
        yield Parts("object", tuple(names), of_face, moves)
    if any(mesh and mesh != name for mesh, name in zip(meshes, names, strict=True)):
        yield Parts("mesh", tuple(meshes), of_face)
    used, of_face = _numbered(scene.materials, sizes)
    none = int(len(used) > 0 and used[0] == -1)
    if len(used) > none:
        numbers = used[none:].tolist()
        names = [str(gltf.item("materials", i).get("name", "")) for i in numbers]
        called = [name or f"material_{i}" for i, name in zip(numbers, names, strict=True)]
        yield Parts("material", tuple(called), of_face - none)


def _numbered(values: list[int], sizes: Ints) -> tuple[Ints, Ints]:
    """Return the distinct values of primitives that have faces, and the number of each face's."""
    has_faces = sizes > 0
    used, number = np.unique(np.array(values, dtype=np.int64)[has_faces], return_inverse=True)
    return used, np.repeat(number.astype(np.int64), sizes[has_faces])
