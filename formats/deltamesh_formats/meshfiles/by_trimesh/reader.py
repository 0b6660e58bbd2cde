"""Reader of COLLADA by way of trimesh, which is imported when such a file is met.

trimesh gives each triangle vertices of its own. They are merged by their positions, as in an STL;
normals, texture coordinates and colours become those of corners, which COLLADA has them for.
"""

from __future__ import annotations

import importlib
import io
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

import numpy as np

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import placement
from deltamesh_formats.meshfiles.plain_text import utf8
from deltamesh_formats.meshfiles.welding import welded
from deltamesh_formats.polymesh.concatenation import concatenate
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles
from deltamesh_formats.polymesh.units import METRES

# Beginnings of elements that trimesh leaves out, or changes, and what is lost with them.
_LEFT_OUT: Final = {
    b"polylist": "polygons of more than three corners",
    b"polygons": "polygons of more than three corners",
    b"trifans": "triangle fans",
    b"tristrips": "triangle strips",
    b"lines": "lines",
    b"linestrips": "lines",
    b"animation": "animations",
    b"controller": "skins",
    b"camera": "cameras",
    b"light": "lights",
    b"image": "textures",
    b"profile_COMMON": "the look of materials",
}
# Elements of triangles and polygons, whose inputs come before their first index.
_PRIMITIVES: Final = re.compile(rb"<(?:\w+:)?(?:triangles|polylist|polygons)[\s>]")
_INDICES: Final = re.compile(rb"<(?:\w+:)?(?:p|vcount)[\s>]")
_NODE_NAME: Final = re.compile(rb"<(?:\w+:)?node\s[^>]*\bname=")
_UP_AXIS: Final = re.compile(rb"<(?:\w+:)?up_axis>\s*([XZ])_UP\s*<")
_TRIANGLES: Final = re.compile(rb"<vcount>[\s3]*</vcount>")
_UNITS: Final = {length: name for name, length in METRES.items()}
_UNIT: Final = re.compile(r"(?:([0-9.e+-]+) \* )?meters")


def read_collada(data: bytes) -> PolyMesh:
    """Read a COLLADA file; what trimesh leaves out is named as lost.

    Raises
    ------
    MeshError
        For a file that is not readable, and without the package pycollada.
    """
    trimesh = _package("trimesh", "trimesh")
    _package("collada", "pycollada")
    text = utf8(data)
    if b"<!DOCTYPE" in text:
        raise MeshError("its XML has a document type, which COLLADA has no use for")
    broken: tuple[str, ...] = ()
    try:
        scene = _scene(trimesh, data, strict=True)
    except Exception as fault:
        # Parts of such a file may be sound; trimesh leaves the others out.
        broken = (f"parts that are not readable ({_reason(fault)[:80]})",)
        try:
            scene = _scene(trimesh, data, strict=False)
        except Exception as error:
            raise MeshError(f"trimesh cannot read it: {_reason(error)}") from None
    placed = [(*scene.graph[node], node) for node in scene.graph.nodes_geometry]
    meshes = [_placed(scene.geometry[name], matrix) for matrix, name, _ in placed]
    if not meshes:
        if broken:
            raise MeshError(f"trimesh reads no mesh of it: it has {broken[0]}")
        nothing = from_triangles(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
        return replace(nothing, lost=tuple(dict.fromkeys(_left_out(text))))
    mesh = concatenate(meshes)
    of_face = np.repeat(np.arange(len(meshes)), [len(one.sizes) for one in meshes])
    transforms = np.array([matrix for matrix, _, _ in placed], dtype=np.float64)
    plain = bool((transforms == np.eye(4)).all())
    names = tuple(name for _, name, _ in placed)
    objects = Parts("object", names, of_face, None if plain else transforms)
    materials = _materials([scene.geometry[name] for name in names])
    return replace(
        mesh,
        parts=(objects, *(replace(one, of_face=one.of_face[of_face]) for one in materials)),
        metadata=_units(scene),
        lost=tuple(dict.fromkeys([*broken, *_left_out(text), *_left_out_of_inputs(text, scene)])),
    )


def _scene(trimesh: Any, data: bytes, *, strict: bool) -> Any:
    """Return the scene of a file; `strict` refuses one of which anything cannot be read."""
    return trimesh.load_scene(
        io.BytesIO(data), file_type="dae", process=False, ignore_broken=not strict
    )


def _reason(error: Exception) -> str:
    return str(error).rpartition("Error: ")[2] or type(error).__name__


def _package(module: str, package: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        raise MeshError(
            f"COLLADA is read by the package {package}: python -m pip install {package}"
        ) from None


def _placed(mesh: Any, matrix: Floats) -> PolyMesh:
    """Return a mesh of trimesh at its place, its vertices merged by their positions."""
    faces = np.array(mesh.faces, dtype=np.int64)
    mirrored = placement.is_mirror(matrix)
    corners = (faces[:, ::-1] if mirrored else faces).ravel()
    points, index = welded(np.array(mesh.vertices, dtype=np.float64))
    with np.errstate(all="ignore"):
        found = from_triangles(placement.moved(points, matrix), index[corners].reshape(-1, 3))
    attributes = []
    if "vertex_normals" in mesh._cache:  # else trimesh would compute them
        normals = np.array(mesh.vertex_normals, dtype=np.float64)
        turned = placement.turned("normal", normals, matrix)
        attributes.append(Attribute("normal", "corner", turned[corners], "normal"))
    uv = getattr(mesh.visual, "uv", None)
    if uv is not None and len(uv) == len(mesh.vertices):
        values = np.array(uv, dtype=np.float64)[corners]
        attributes.append(Attribute("uv", "corner", values, "uv"))
    if mesh.visual.kind == "vertex":
        rgba = np.array(mesh.visual.vertex_colors, dtype=np.uint8)[corners]
        attributes.append(Attribute("colour", "corner", rgba, "colour", normalized=True))
    return replace(found, attributes=tuple(attributes))


def _materials(meshes: list[Any]) -> Iterator[Parts]:
    """Yield the materials, a number for each mesh, if any has a name."""
    materials = [getattr(mesh.visual, "material", None) for mesh in meshes]
    names = [str(getattr(one, "name", None) or "") for one in materials]
    distinct = [*dict.fromkeys(name for name in names if name)]
    if distinct:
        numbers = [distinct.index(name) if name else -1 for name in names]
        yield Parts("material", tuple(distinct), np.array(numbers, dtype=np.int64))


def _units(scene: Any) -> dict[str, tuple[str, ...]]:
    """Return the unit, by its name or, such as "0.3 meter", by its length."""
    found = _UNIT.fullmatch(str(scene.units or ""))
    if found is None:
        return {}
    length = found[1] or "1.0"
    return {"units": (_UNITS.get(float(length), f"{length} meter"),)}


def _left_out(data: bytes) -> Iterator[str]:
    for name, lost in _LEFT_OUT.items():
        if re.search(rb"<(?:\w+:)?" + name + rb"[\s>/]", data) is None:
            continue
        if name == b"polylist" and data.count(b"<vcount>") == len(_TRIANGLES.findall(data)):
            continue
        yield lost
    if _NODE_NAME.search(data):
        yield "names of nodes"
    axis = _UP_AXIS.search(data)
    if axis is not None:
        yield f"the axis that points up ({axis[1].decode()})"


def _left_out_of_inputs(data: bytes, scene: Any) -> Iterator[str]:
    """Yield descriptions of numbers of corners that trimesh leaves out.

    It takes the first texture coordinates alone, those of meshes with a material, and colours of
    meshes without one.
    """
    uvs, colours = 0, 0
    for primitive in _PRIMITIVES.finditer(data):
        end = _INDICES.search(data, primitive.end())
        inputs = data[primitive.end() : len(data) if end is None else end.start()]
        uvs = max(uvs, inputs.count(b'semantic="TEXCOORD"'))
        colours = max(colours, inputs.count(b'semantic="COLOR"'))
    has_look = [mesh.visual.kind == "texture" for mesh in scene.geometry.values()]
    if uvs > 1:
        yield "further texture coordinates"
    if uvs and not all(has_look):
        yield "texture coordinates of meshes without a material"
    if colours > 1:
        yield "further colours"
    if colours and any(has_look):
        yield "colours of meshes with a material"
    if colours and not all(has_look):
        yield "colours beyond 8 bits"
