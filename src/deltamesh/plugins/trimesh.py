"""Plugin of trimesh: `Trimesh` and `.dmesh`; `import deltamesh.plugins.trimesh` registers it.

After that `trimesh.load_mesh("x.dmesh")`, `trimesh.load` and `mesh.export("x.dmesh")` work, with
file objects too (`file_type="dmesh"`). Vertices and faces stay as they are: nothing is merged
unless `process=True` is given. Polygons are cut into triangles.

What has a place of its own in trimesh is put there: 8-bit colours, texture coordinates of
vertices, vertex normals. Everything else is in `vertex_attributes` and `face_attributes`:
attributes of corners as "corner_NAME", a row of 3 * width numbers for each triangle, and the part
of each face as "material", "group", "object" and so on, with names in `metadata["material_names"]`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, BinaryIO, Final

import numpy as np
import trimesh
from numpy.typing import NDArray

from deltamesh._codec.encoding import encode
from deltamesh._files import load
from deltamesh.plugins._fields import (
    KINDS,
    Arrays,
    attributes_of,
    by_name,
    dense_arrays,
    gaps_in_colours,
    keeping_order,
    names_key,
    taken_parts,
    warn_of_losses,
)
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.arrays import from_arrays, role_of
from deltamesh_formats.polymesh.colours import as_fractions
from deltamesh_formats.polymesh.concatenation import concatenate
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh
from deltamesh_formats.polymesh.seams import at_vertices, split_at_seams
from deltamesh_formats.polymesh.texture_origin import with_origin
from deltamesh_formats.polymesh.triangles import Triangles

_CORNER: Final = "corner_"
_DECODING: Final = ("max_vertices", "memory", "solver", "threads")


def to_trimesh(mesh: PolyMesh, *, split_seams: bool = False) -> trimesh.Trimesh:
    """Return a `Trimesh`, its vertices and triangles in the order of the mesh.

    trimesh forgets vertex normals in copies, and `load_mesh` copies; so they are also the vertex
    attribute "normal". Colours that are not of 8 bits are shown rounded and kept as they are.

    Parameters
    ----------
    mesh : PolyMesh
    split_seams : bool
        Repeat vertices where texture coordinates have seams, as trimesh does for OBJ, so that they
        are those of vertices and a texture is shown. Without it they are "corner_uv".

    Warns
    -----
    UserWarning
        Of gaps in colours, which are shown white.
    """
    # It takes the range of the normals that it is given, which may be any numbers.
    with np.errstate(over="ignore", invalid="ignore"):
        return trimesh.Trimesh(**_arguments(mesh, split_seams))


def from_trimesh(mesh: trimesh.Trimesh | trimesh.Scene) -> PolyMesh:
    """Return what a `Trimesh` holds; of a `Scene` all its meshes, placed, each an object.

    Vertex normals are taken unless trimesh would compute the same. Arrays that are not numbers and
    pictures of textures are named in `lost`.

    Raises
    ------
    MeshError
        For what has no faces.
    """
    if isinstance(mesh, trimesh.Scene):
        return _from_scene(mesh)
    if not isinstance(mesh, trimesh.Trimesh):
        raise MeshError(f"{type(mesh).__name__} is not a mesh of faces")
    lost: list[str] = []
    plain = from_arrays(np.array(mesh.vertices), np.array(mesh.faces))
    n, m = len(plain.vertices), len(plain.offsets) - 1
    vertex, face = dict(mesh.vertex_attributes), dict(mesh.face_attributes)
    corner = {name: face.pop(name) for name in list(face) if _of_corners(name, face[name], m)}
    names = {kind: mesh.metadata.get(names_key(kind)) for kind in KINDS}
    parts = taken_parts(face, {kind: some for kind, some in names.items() if some is not None}, m)
    _add_visual(mesh, vertex, face, lost)
    _add_normals(mesh, vertex)
    rows = {name.removeprefix(_CORNER): np.reshape(A, (3 * m, -1)) for name, A in corner.items()}
    return replace(
        plain,
        attributes=(
            *attributes_of("vertex", vertex, n, lost),
            *attributes_of("corner", rows, 3 * m, lost),
            *attributes_of("face", face, m, lost),
        ),
        parts=parts,
        metadata=_metadata(mesh.metadata, {names_key(one.kind) for one in parts}),
        lost=tuple(lost),
    )


def load_dmesh(file_obj: BinaryIO, file_type: str | None = None, **options: Any) -> dict[str, Any]:
    """Return what `Trimesh` is made of; a loader of `trimesh.exchange.load.mesh_loaders`.

    `split_seams` is that of `to_trimesh`; `process` is False unless it is given; `max_vertices`,
    `memory`, `solver` and `threads` are those of `deltamesh.decode`.
    """
    mesh = load(file_obj, **{name: options[name] for name in _DECODING if name in options})
    made = _arguments(mesh, options.get("split_seams", False))
    made["metadata"] |= options.get("metadata") or {}
    return {**made, "process": options.get("process", False)}


def export_dmesh(mesh: trimesh.Trimesh, **options: Any) -> bytes:
    """Return a `.dmesh` file; an exporter of `trimesh.exchange.export`.

    The options are those of `deltamesh.encode`, of which `keep_order` is True unless given.
    """
    found = from_trimesh(mesh)
    warn_of_losses(found.lost, "a .dmesh")
    return encode(found, **keeping_order(options))


def register() -> None:
    """Make `.dmesh` a format of trimesh; importing this module does."""
    trimesh.exchange.load.mesh_loaders["dmesh"] = load_dmesh
    trimesh.exchange.export._mesh_exporters["dmesh"] = export_dmesh


def _arguments(mesh: PolyMesh, split_seams: bool) -> dict[str, Any]:
    mesh = with_origin(mesh, top_left=False)
    warn_of_losses(gaps_in_colours(mesh), "a Trimesh")
    uv = mesh.attribute("uv", "corner")
    if split_seams and uv is not None:
        mesh = split_at_seams(mesh, uv)
    cut = mesh.triangulation()
    found, shown = _visual(mesh, cut)
    normal = mesh.attribute("normal", "vertex")
    if normal is not None and np.isfinite(N := normal.dense()).all():
        found["vertex_normals"] = N
    face: Arrays = [(parts.kind, parts.of_face[cut.polygon]) for parts in mesh.parts]
    face += [(name, A[cut.polygon]) for name, A in dense_arrays(mesh, "face", shown)]
    corners = dense_arrays(mesh, "corner", shown)
    face += [(_CORNER + name, A[cut.corners].reshape(len(cut.faces), -1)) for name, A in corners]
    names = {names_key(parts.kind): list(parts.names) for parts in mesh.parts}
    metadata: dict[str, Any] = {key: list(some) for key, some in mesh.metadata.items()}
    if metadata.get("units"):
        metadata["units"] = metadata["units"][0]  # trimesh has one text, not a list
    return {
        "vertices": mesh.vertices,
        "faces": cut.faces,
        "vertex_attributes": by_name(dense_arrays(mesh, "vertex", shown)),
        "face_attributes": by_name(face),
        "metadata": {**metadata, **names},
        "process": False,
        **found,
    }


def _visual(mesh: PolyMesh, cut: Triangles) -> tuple[dict[str, Any], list[Attribute]]:
    """Return arguments for what trimesh shows, of which it has one, and what is whole in them."""
    for attribute in mesh.attributes:
        if attribute.role == "uv" and attribute.width == 2 and attribute.domain != "face":
            of_corners = attribute.domain == "corner"
            uv = at_vertices(mesh, attribute) if of_corners else attribute.dense()
            if uv is not None:
                return {"visual": trimesh.visual.TextureVisuals(uv=uv)}, [attribute]
    for domain in ("vertex", "face"):
        colour = mesh.attribute("colour", domain)
        if colour is not None and colour.width in (3, 4):
            colours = _rgba(colour)
            rows = colours if domain == "vertex" else colours[cut.polygon]
            exact = colour.values.dtype == np.uint8 and colour.normalized
            return {f"{domain}_colors": rows}, [colour] if exact else []
    return {}, []


def _rgba(colour: Attribute) -> NDArray[np.uint8]:
    """Return colours as trimesh has them, uint8 (count, 4)."""
    found = np.full((len(colour.rows()), 4), 255, dtype=np.uint8)
    values = np.nan_to_num(as_fractions(colour.dense(), normalized=colour.normalized))
    found[:, : colour.width] = np.rint(255 * np.clip(values, 0, 1))
    return found


def _add_visual(
    mesh: trimesh.Trimesh, vertex: dict[str, Any], face: dict[str, Any], lost: list[str]
) -> None:
    """Add what trimesh shows to the arrays, and what of it cannot be kept to `lost`."""
    visual = mesh.visual
    if isinstance(visual, trimesh.visual.TextureVisuals):
        if visual.uv is not None:
            vertex.setdefault("uv", visual.uv)
        names = ("image", "baseColorTexture")
        pictures = (getattr(visual.material, name, None) for name in names)
        # Without a picture trimesh has one of a single colour, of four pixels.
        if any(picture is not None and max(picture.size) > 2 for picture in pictures):
            lost.append("the picture of the texture")
    elif visual.kind == "vertex" and not _is_there(visual.vertex_colors, vertex):
        vertex["colour"] = visual.vertex_colors
    elif visual.kind == "face" and not _is_there(visual.face_colors, face):
        face["colour"] = visual.face_colors


def _is_there(colours: NDArray[np.uint8], arrays: Mapping[str, Any]) -> bool:
    """Return whether these colours are the rounded ones of an attribute."""
    for name, values in arrays.items():
        A = np.asarray(values)
        if A.ndim == 2 and len(A) == len(colours) and role_of(name, A) == "colour":
            attribute = Attribute(name, "vertex", A, normalized=A.dtype.kind == "u")
            if (_rgba(attribute) == colours).all():
                return True
    return False


def _add_normals(mesh: trimesh.Trimesh, vertex: dict[str, Any]) -> None:
    """Add the normals of vertices that were given, and not computed from the faces."""
    if "vertex_normals" not in mesh._cache:
        return
    normals = np.asarray(mesh.vertex_normals)
    known = [name for name, values in vertex.items() if _is_normal(name, np.asarray(values))]
    if any(np.array_equal(normals, vertex[name]) for name in known):
        return
    computed = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).vertex_normals
    if not np.array_equal(normals, computed):
        vertex[known[0] if known else "normal"] = normals


def _is_normal(name: str, values: NDArray[Any]) -> bool:
    return values.ndim == 2 and role_of(name, values) == "normal"


def _of_corners(name: str, values: Any, faces: int) -> bool:
    shape = np.shape(values)
    fits = len(shape) == 2 and shape[0] == faces and shape[1] % 3 == 0
    return name.startswith(_CORNER) and fits


def _metadata(metadata: Mapping[str, Any], without: set[str]) -> dict[str, tuple[str, ...]]:
    """Return the units, and what is a list of texts, as `_arguments` has written it."""
    found = {
        key: tuple(texts)
        for key, texts in metadata.items()
        if isinstance(texts, list | tuple) and texts and all(isinstance(w, str) for w in texts)
    }
    if isinstance(units := metadata.get("units"), str):
        found["units"] = (units,)
    return {key: texts for key, texts in found.items() if key not in without}


def _from_scene(scene: trimesh.Scene) -> PolyMesh:
    placed = [one for one in scene.dump() if isinstance(one, trimesh.Trimesh)]
    if not placed:
        raise MeshError("a scene without meshes")
    meshes = [from_trimesh(one) for one in placed]
    mesh = concatenate(meshes)
    if len(placed) == 1 and mesh.parts_of("object") is not None:
        return mesh
    names = tuple(str(one.metadata.get("node", "")) for one in placed)
    of_face = np.repeat(np.arange(len(placed)), [len(one.offsets) - 1 for one in meshes])
    others = tuple(parts for parts in mesh.parts if parts.kind != "object")
    return replace(mesh, parts=(Parts("object", names, of_face), *others))


register()
