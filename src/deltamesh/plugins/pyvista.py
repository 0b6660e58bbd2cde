"""Plugin of PyVista: `PolyData` and `.dmesh`; PyVista finds the reader and writer by itself.

With deltamesh installed `pyvista.read("x.dmesh")` and `mesh.save("x.dmesh")` work, without an
import. Points and faces stay in their order, polygons are polygons.

Attributes of vertices are `point_data`, normals and texture coordinates the active ones; those of
faces are `cell_data`. The part of each face is the cell array "material", "group", "object" and so
on, with names in `user_dict["material_names"]`. VTK has no place for attributes of corners: those
without seams become `point_data`, those with are named in a warning.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
import pyvista
from numpy.typing import NDArray

from deltamesh._files import load, save
from deltamesh.plugins._fields import (
    KINDS,
    Arrays,
    attributes_of,
    by_name,
    dense_arrays,
    keeping_order,
    names_key,
    point_arrays,
    taken_parts,
    warn_of_losses,
)
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.float32 import stored_positions
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, Role
from deltamesh_formats.polymesh.texture_origin import with_origin
from deltamesh_formats.polymesh.validation import checked

_WIDTHS: Final[dict[Role, tuple[int, ...]]] = {"normal": (3,), "uv": (2, 3)}

_ACTIVE: Final[dict[Role, str]] = {
    "normal": "active_normals_name",
    "uv": "active_texture_coordinates_name",
}

_DICTIONARY: Final = "_PYVISTA_USER_DICT"


def to_pyvista(mesh: PolyMesh) -> pyvista.PolyData:
    """Return a `PolyData`, its points and faces in the order of the mesh.

    Points are float32 where those of the source were, and float32 holds them.

    Warns
    -----
    UserWarning
        Of attributes of corners that have seams, and of gaps in colours.
    """
    mesh = with_origin(mesh, top_left=False)
    points, lost = point_arrays(mesh)
    warn_of_losses(lost, "a PolyData")
    roles = {a.name: a.role for a in reversed(mesh.attributes) if a.domain != "face"}
    faces = np.insert(mesh.corners, mesh.offsets[:-1], mesh.sizes)
    made = pyvista.PolyData(stored_positions(mesh), faces=faces)
    for name, values in by_name(points).items():
        made.point_data.set_array(_known(values), name)
    cells: Arrays = [(parts.kind, parts.of_face) for parts in mesh.parts]
    for name, values in by_name(cells + dense_arrays(mesh, "face")).items():
        made.cell_data.set_array(_known(values), name)
    _activate(made, roles)
    names = {names_key(parts.kind): parts.names for parts in mesh.parts}
    for key, texts in {**mesh.metadata, **names}.items():
        if texts:
            made.user_dict[key] = list(texts)
    return made


def from_pyvista(mesh: pyvista.PolyData) -> PolyMesh:
    """Return the faces of a `PolyData` with all its points.

    Lines and cells of single vertices, and arrays that are not numbers, are named in `lost`.

    Raises
    ------
    MeshError
        For anything but a `PolyData`, for strips of triangles, and if there are no faces.
    """
    if not isinstance(mesh, pyvista.PolyData):
        what = type(mesh).__name__
        raise MeshError(f"{what} is not a mesh of faces alone; its extract_surface() is one")
    if mesh.n_strips:
        raise MeshError("strips of triangles; triangulate() makes faces of them")
    lost = [
        f"{count} {what}"
        for count, what in ((mesh.n_verts, "cells of single vertices"), (mesh.n_lines, "lines"))
        if count
    ]
    cells = mesh.GetPolys()
    corners = _integers(cells.GetConnectivityArray())
    offsets = _integers(cells.GetOffsetsArray())
    n, m = mesh.n_points, len(offsets) - 1
    # Cells are numbered by their kind: single vertices, lines, faces.
    face = {name: A[-m:] if m else A[:0] for name, A in mesh.cell_data.items()}
    parts, metadata = _named_parts(face, mesh, lost)
    point_data = mesh.point_data
    active = {getattr(point_data, what): role for role, what in _ACTIVE.items()}
    points = attributes_of("vertex", dict(point_data.items()), n, lost)
    faces = attributes_of("face", face, m, lost)
    found = PolyMesh(
        np.array(mesh.points, dtype=np.float64),
        corners,
        offsets,
        (*(_with_role(a, active.get(a.name)) for a in points), *faces),
        parts,
        metadata,
        tuple(lost),
        "float32" if mesh.points.dtype == np.float32 else "float64",
    )
    return checked(found)


def read_dmesh(path: str, **options: Any) -> pyvista.PolyData:
    """Read a `.dmesh` file; the options are those of `deltamesh.decode`.

    PyVista fetches what is not on this machine.
    """
    if "://" in path:
        raise pyvista.LocalFileRequiredError
    return to_pyvista(load(path, **options))


def write_dmesh(mesh: pyvista.PolyData, path: str, **options: Any) -> None:
    """Write a `.dmesh` file.

    The options are those of `deltamesh.encode`, of which `keep_order` is True unless given.
    """
    found = from_pyvista(mesh)
    warn_of_losses(found.lost, "a .dmesh")
    save(path, found, **keeping_order(options))


def _activate(made: pyvista.PolyData, roles: dict[str, Role]) -> None:
    """Make the first normals and texture coordinates the active ones."""
    for role, what in (
        ("normal", "active_normals_name"),
        ("uv", "active_texture_coordinates_name"),
    ):
        fitting = (
            name
            for name, values in made.point_data.items()
            if roles.get(name) == role and values.ndim == 2 and values.shape[1] in _WIDTHS[role]
        )
        name = next(fitting, None)
        if name is not None:
            setattr(made.point_data, what, name)


def _with_role(attribute: Attribute, role: Role | None) -> Attribute:
    fits = role is not None and attribute.width in _WIDTHS[role]
    return replace(attribute, role=role) if fits and role is not None else attribute


def _named_parts(
    face: dict[str, NDArray[Any]], mesh: pyvista.PolyData, lost: list[str]
) -> tuple[tuple[Parts, ...], dict[str, tuple[str, ...]]]:
    """Take the parts out of the arrays of faces, and metadata and names out of the dictionary."""
    texts = {}
    lost += [f"the field array {key!r}" for key in mesh.field_data if not key.startswith("_")]
    # Looking at the dictionary of a mesh without one would give it one.
    for key, values in mesh.user_dict.items() if _DICTIONARY in mesh.field_data else ():
        if isinstance(values, list) and values and all(isinstance(word, str) for word in values):
            texts[key] = tuple(values)
        else:
            lost.append(f"the entry {key!r} of user_dict")
    names = {kind: texts[names_key(kind)] for kind in KINDS if names_key(kind) in texts}
    found = taken_parts(face, names, mesh.n_cells)
    for parts in found:
        del texts[names_key(parts.kind)]
    return found, texts


def _known(values: NDArray[Any]) -> NDArray[Any]:
    """Return numbers in a type of VTK, which has no float16."""
    return values.astype(np.float32) if values.dtype == np.float16 else values


def _integers(array: Any) -> Ints:
    return np.array(pyvista.convert_array(array), dtype=np.int64)
