"""Plugin of meshio: `meshio.Mesh` and `.dmesh`; `import deltamesh.plugins.meshio` registers it.

After that `meshio.read("x.dmesh")` and `mesh.write("x.dmesh")` work, with file objects too
(`file_format="dmesh"`). Points and cells stay in their order: a block of cells is a run of faces
of one size, "triangle", "quad" or "polygon".

Attributes of vertices are `point_data`, those of faces `cell_data`. The part of each face is the
cell array "material", "group", "object" and so on, and its names are in `field_data` in the manner
of Gmsh: `{"material:steel": [0, 2]}`, the number and the dimension. meshio has no place for
attributes of corners: those without seams become `point_data`, those with are named in a warning.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, BinaryIO, Final

import meshio
import numpy as np
from numpy.typing import NDArray

from deltamesh._files import load, save
from deltamesh.plugins._fields import (
    KINDS,
    Arrays,
    attributes_of,
    by_name,
    dense_arrays,
    keeping_order,
    point_arrays,
    taken_parts,
    warn_of_losses,
)
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh
from deltamesh_formats.polymesh.names import distinct_names
from deltamesh_formats.polymesh.texture_origin import with_origin
from deltamesh_formats.polymesh.validation import checked

_TYPES: Final = {3: "triangle", 4: "quad"}


def to_meshio(mesh: PolyMesh) -> meshio.Mesh:
    """Return a `meshio.Mesh`, its points and cells in the order of the mesh.

    Warns
    -----
    UserWarning
        Of attributes of corners that have seams, and of gaps in colours.
    """
    mesh = with_origin(mesh, top_left=False)
    points, lost = point_arrays(mesh)
    warn_of_losses(lost, "a mesh of meshio")
    ends = [*(np.flatnonzero(np.diff(mesh.sizes)) + 1).tolist(), len(mesh.sizes)]
    runs = [slice(a, b) for a, b in zip([0, *ends[:-1]], ends, strict=True)]
    faces: Arrays = [(parts.kind, parts.of_face) for parts in mesh.parts]
    faces += dense_arrays(mesh, "face")
    return meshio.Mesh(
        mesh.vertices,
        [_block(mesh, run) for run in runs],
        point_data=by_name(points),
        cell_data={name: [A[run] for run in runs] for name, A in by_name(faces).items()},
        field_data=_names(mesh),
    )


def from_meshio(mesh: meshio.Mesh) -> PolyMesh:
    """Return the triangles, quads and polygons of a `meshio.Mesh` with all its points.

    Two coordinates get a third, 0. Cells of other types, sets, and arrays that are not numbers,
    are named in `lost`.

    Raises
    ------
    MeshError
        If there is no such cell.
    """
    taken = [i for i, block in enumerate(mesh.cells) if _is_face(block.type)]
    lost = [f"cells of type {b.type}" for b in mesh.cells if not _is_face(b.type)]
    if not taken:
        there = ", ".join(dict.fromkeys(block.type for block in mesh.cells)) or "none"
        raise MeshError(f"no triangles, quads or polygons among the cells: {there}")
    V = np.asarray(mesh.points)
    if V.ndim == 2 and V.shape[1] == 2:
        V = np.pad(V, [(0, 0), (0, 1)])
    tables = [_table(mesh.cells[i]) for i in taken]
    sizes = np.concatenate([np.full(len(table), table.shape[1]) for table in tables])
    face = {}
    for name, blocks in mesh.cell_data.items():
        try:
            face[name] = np.concatenate([np.asarray(blocks[i]) for i in taken])
        except ValueError:  # blocks of different widths
            lost.append(f"the face array {name!r}")
    parts = _parts(face, mesh.field_data, len(sizes), lost)
    for what, names in (("point", mesh.point_sets), ("cell", mesh.cell_sets)):
        lost += [f"the {what} set {name!r}" for name in names]
    points = attributes_of("vertex", mesh.point_data, len(V), lost)
    found = PolyMesh(
        np.ascontiguousarray(V, dtype=np.float64),
        np.concatenate([table.ravel() for table in tables]),
        np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(sizes)]),
        (*points, *attributes_of("face", face, len(sizes), lost)),
        parts,
        lost=tuple(lost),
        precision="float32" if V.dtype == np.float32 else "float64",
    )
    return checked(found)


def read_dmesh(source: str | os.PathLike[str] | BinaryIO) -> meshio.Mesh:
    """Read a `.dmesh` file; the reader of the format "dmesh"."""
    return to_meshio(load(source))


def write_dmesh(
    target: str | os.PathLike[str] | BinaryIO, mesh: meshio.Mesh, **options: Any
) -> None:
    """Write a `.dmesh` file; the writer of the format "dmesh".

    The options are those of `deltamesh.encode`, of which `keep_order` is True unless given.
    """
    found = from_meshio(mesh)
    warn_of_losses(found.lost, "a .dmesh")
    save(target, found, **keeping_order(options))


def register() -> None:
    """Make `.dmesh` a format of meshio; importing this module does."""
    meshio.deregister_format("dmesh")
    meshio.register_format("dmesh", [".dmesh"], read_dmesh, {"dmesh": write_dmesh})


def _is_face(kind: str) -> bool:
    return kind in ("triangle", "quad") or kind.startswith("polygon")


def _block(mesh: PolyMesh, run: slice) -> meshio.CellBlock:
    size = int(mesh.sizes[run.start])
    corners = mesh.corners[mesh.offsets[run.start] : mesh.offsets[run.stop]]
    return meshio.CellBlock(_TYPES.get(size, "polygon"), corners.reshape(-1, size))


def _table(block: meshio.CellBlock) -> Ints:
    table = np.asarray(block.data)
    if table.ndim != 2 or table.dtype.kind not in "iu":
        what = f"{table.dtype} {table.shape}"
        raise MeshError(f"cells of type {block.type} must be a table of integers, not {what}")
    return table.astype(np.int64)


def _names(mesh: PolyMesh) -> dict[str, Ints]:
    """Return the names of all parts with their numbers and their dimension."""
    names = [f"{parts.kind}:{name}" for parts in mesh.parts for name in parts.names]
    numbers = [number for parts in mesh.parts for number in range(len(parts.names))]
    return {
        name: np.array([number, 2])
        for name, number in zip(distinct_names(names), numbers, strict=True)
    }


def _parts(
    face: dict[str, NDArray[Any]], field_data: Mapping[str, Any], faces: int, lost: list[str]
) -> tuple[Parts, ...]:
    """Take the parts out of the arrays of the faces."""
    numbered: dict[Kind, dict[int, str]] = {}
    for key, values in field_data.items():
        kind, _, name = str(key).partition(":")
        if kind in KINDS and kind in face and np.size(values) == 2:
            numbered.setdefault(kind, {})[int(np.ravel(values)[0])] = name
        else:
            lost.append(f"the field {key!r}")
    names = {
        kind: [name for _, name in sorted(some.items())]
        for kind, some in numbered.items()
        if set(some) == set(range(len(some)))
    }
    return taken_parts(face, names, faces)


register()
