"""Mesh as files have it: polygons, attributes, parts, and names of what a reader left out.

It is plain arrays in frozen dataclasses, which readers of `deltamesh_formats.meshfiles` return and
writers take. Polygons are rows of a compressed table, corner after corner; an attribute has a row
for each vertex, corner or face, or a table of rows and an index into it, so that the separate
indices of OBJ (`f v/vt/vn`) survive. Positions are where the file puts them in space: the
transforms of a scene are applied, and kept beside to be undone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.polymesh.kinds import Kind
from deltamesh_formats.polymesh.triangles import Triangles, triangulate

Domain: TypeAlias = Literal["vertex", "corner", "face"]
Role: TypeAlias = Literal["normal", "uv", "colour", "other"]
Precision: TypeAlias = Literal["float32", "float64"]


@dataclass(frozen=True)
class Attribute:
    """Attribute: numbers of the vertices, corners or faces.

    Attributes
    ----------
    name : str
        "normal", "uv", "colour", and "uv1", "colour1" and so on for further sets; otherwise the
        name that the file has. Sets of different type may share a name.
    domain : {"vertex", "corner", "face"}
    values : (rows, width), any numpy scalar type, in the byte order of the machine
    role : {"normal", "uv", "colour", "other"}
    index : int64 (count of the domain,) or None
        The row of each element, -1 for an element that has none; None when row i is element i's.
    normalized : bool
        Whether integers stand for fractions of the largest value of their type.
    margin : float
        How far a writer may round each number: a small share of the error that the numbers have;
        0 for numbers that have none.
    """

    name: str
    domain: Domain
    values: NDArray[Any]
    role: Role = "other"
    index: Ints | None = None
    normalized: bool = False
    margin: float = 0.0

    @property
    def width(self) -> int:
        """Numbers a row."""
        return int(self.values.shape[1])

    def rows(self) -> Ints:
        """Return the row of each element, int64, -1 for none."""
        if self.index is not None:
            return self.index
        return np.arange(len(self.values), dtype=np.int64)

    @property
    def filler(self) -> float:
        """The number that stands for no number: white for colours, else NaN, or 0 of integers."""
        kind = self.values.dtype.kind
        if self.role != "colour" or kind not in "iuf":
            return np.nan if kind == "f" else 0
        if kind == "f":
            return 1.0
        largest = int(np.iinfo(self.values.dtype).max)
        return largest if self.normalized else min(255, largest)

    def dense(self) -> NDArray[Any]:
        """Return a row for each element, (count, width); one that has none gets `filler`."""
        if self.index is None:
            return self.values
        found = np.full((len(self.index), self.width), self.filler, dtype=self.values.dtype)
        has = self.index >= 0
        found[has] = self.values[self.index[has]]
        return found


@dataclass(frozen=True)
class Parts:
    """Division of the faces into parts with names.

    Attributes
    ----------
    kind : {"object", "mesh", "group", "material", "smoothing"}
        "object" are the OBJ objects, STL solids and the placed meshes of a scene; "mesh" are the
        names of a scene's meshes where they differ from those of its nodes.
    names : tuple of str
        One a part; objects may share a name, or have none ("").
    of_face : int64 (p,)
        The part of each face, -1 for none.
    transforms : float64 (parts, 4, 4) or None
        From the part's own coordinates, which a GLB stores, to those of the vertices.
    """

    kind: Kind
    names: tuple[str, ...]
    of_face: Ints
    transforms: Floats | None = None


@dataclass(frozen=True, repr=False, eq=False)
class PolyMesh:
    """Mesh of polygons, with everything that a mesh file holds.

    Attributes
    ----------
    vertices : float64 (n, 3)
        Every vertex of the file, in its order and unit; of an STL, every position once.
    corners : int64 (c,)
        Vertex indices from 0, polygon after polygon, in the file's winding.
    offsets : int64 (p + 1,)
        Polygon i has the corners offsets[i] up to offsets[i + 1], at least three.
    attributes : tuple of Attribute
    parts : tuple of Parts, at most one of each kind
    metadata : mapping of str to tuple of str
        "comments" (those above the first element), "obj_info", "mtllib", "header", "copyright",
        "texture_origin" ("top left" of a GLB; that of others is at the bottom left).
    lost : tuple of str
        Descriptions of what the file has and this class has no place for.
    precision : {"float32", "float64"}
        Type of the positions in the source; that of text is float64.
    format : str
        Name of the format of the file; "" for a mesh from elsewhere.
    margin : float
        How far a writer may round each coordinate: a small share of the error that the positions
        of a decoded mesh have; 0 for positions that have none.
    """

    vertices: Floats
    corners: Ints
    offsets: Ints
    attributes: tuple[Attribute, ...] = ()
    parts: tuple[Parts, ...] = ()
    metadata: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    lost: tuple[str, ...] = ()
    precision: Precision = "float64"
    format: str = ""
    margin: float = 0.0

    @property
    def sizes(self) -> Ints:
        """Corners of each polygon, int64 (p,)."""
        return np.diff(self.offsets)

    @property
    def vertex_data(self) -> dict[str, NDArray[Any]]:
        """The attributes of the vertices by name; `arrays.to_arrays` says how."""
        return _arrays(self, "vertex")

    @property
    def corner_data(self) -> dict[str, NDArray[Any]]:
        """Those of the corners, in the order of `corners`."""
        return _arrays(self, "corner")

    @property
    def face_data(self) -> dict[str, NDArray[Any]]:
        """Those of the polygons."""
        return _arrays(self, "face")

    def __repr__(self) -> str:
        from deltamesh_formats.polymesh.summary import mesh_text

        return mesh_text(self)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        from deltamesh_formats.polymesh.summary import mesh_html

        return mesh_html(self)

    @property
    def faces(self) -> Ints | list[Ints]:
        """The polygons as `from_arrays` takes them: an array (p, k) if all have k corners."""
        sizes = self.sizes
        if (sizes == sizes[:1]).all():
            return self.corners.reshape(len(sizes), int(sizes[0]) if len(sizes) else 3)
        return np.split(self.corners, self.offsets[1:-1])

    @property
    def triangles(self) -> Ints:
        """The vertices of the triangles that the polygons are cut into, int64 (t, 3)."""
        return self.triangulation().faces

    def triangulation(self) -> Triangles:
        """Cut the polygons into triangles; `deltamesh_formats.polymesh.triangles` says how."""
        return triangulate(self.vertices, self.corners, self.offsets)

    def attribute(self, role: Role, *domains: Domain) -> Attribute | None:
        """Return the first attribute of a role on one of these domains."""
        fitting = (a for a in self.attributes if a.role == role and a.domain in domains)
        return next(fitting, None)

    def parts_of(self, kind: Kind) -> Parts | None:
        """Return the parts of a kind."""
        return next((parts for parts in self.parts if parts.kind == kind), None)


def _arrays(mesh: PolyMesh, domain: Domain) -> dict[str, NDArray[Any]]:
    from deltamesh_formats.polymesh.arrays import to_arrays

    return to_arrays(mesh, domain)


def from_triangles(vertices: Floats, faces: Ints) -> PolyMesh:
    """Return a mesh of vertices, float64 (n, 3), and triangles, int64 (m, 3), and nothing else."""
    offsets = np.arange(len(faces) + 1, dtype=np.int64) * 3
    return PolyMesh(vertices, np.ascontiguousarray(faces, dtype=np.int64).ravel(), offsets)


def keep_faces(mesh: PolyMesh, keep: Bools) -> PolyMesh:
    """Return the mesh with only those faces where `keep`, bool (p,), is true."""
    if keep.all():
        return mesh
    kept_corners = np.repeat(keep, mesh.sizes)
    masks = {"corner": kept_corners, "face": keep}
    offsets = np.concatenate(([0], np.cumsum(mesh.sizes[keep]))).astype(np.int64)
    parts = tuple(replace(p, of_face=p.of_face[keep]) for p in mesh.parts)
    attributes = tuple(
        a if a.domain == "vertex" else _keep_rows(a, masks[a.domain]) for a in mesh.attributes
    )
    corners = mesh.corners[kept_corners]
    return replace(mesh, corners=corners, offsets=offsets, attributes=attributes, parts=parts)


def _keep_rows(attribute: Attribute, keep: Bools) -> Attribute:
    if attribute.index is None:
        return replace(attribute, values=attribute.values[keep])
    return replace(attribute, index=attribute.index[keep])
