"""Everything of a mesh but its positions: any triangles to a manifold and back.

encode: weld -> cut -> connectivity -> stitching -> copies -> polygons; decode is the mirror.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh.complexes import Cut, cut
from deltamesh.connectivity import Connectivity, decode_connectivity, encode_connectivity
from deltamesh.corners import (
    Corners,
    copied_points,
    copies_of,
    corners_of,
    decode_copies,
    encode_copies,
)
from deltamesh.geometry import NO_EDGES, Surface, payload_of, surface_of
from deltamesh.gluing import (
    decode_polygons,
    encode_polygons,
    glued_halfedges,
    hidden_halfedges,
    partners,
)
from deltamesh.kernels import cutting
from deltamesh.limits import Counts
from deltamesh.mesh import Mesh
from deltamesh.polygons import Polygons, joined, plain
from deltamesh.stitching import (
    TURN,
    Stitching,
    complex_faces,
    decode_stitching,
    encode_stitching,
    stitched_counts,
    trivial,
)
from deltamesh.topology import build_topology, pair_halfedges, weld
from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import Container
from deltamesh_formats.triangles import Triangles

_Ints = NDArray[np.int64]

# The sections that are told by the half-edges of the manifold.
_NEED_MANIFOLD: Final = frozenset({"STCH", "COPY", "POLY", "ATTR"})


@dataclass(frozen=True)
class Structure:
    """A mesh without its positions, as both sides know it.

    Attributes
    ----------
    manifold : int64 (k, 3)
        The faces that CONN has, over vertices of its own.
    stitching : Stitching
        What makes a complex of them.
    used, isolated : int
        Points of these faces; further points, which come after them.
    faces : int64 (m, 3)
        Of the mesh, over its vertices.
    points : int64 (n,)
        The point of each vertex, ascending.
    glued : int64 (3 m,) or (0,)
        The half-edge of the mesh that each is glued to in a polygon, -1 for none; nothing if all
        polygons are triangles.
    """

    manifold: _Ints
    stitching: Stitching
    used: int
    isolated: int
    faces: _Ints
    points: _Ints
    glued: _Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @cached_property
    def surface(self) -> _Ints:
        """The faces of the manifold over points, (k, 3): what geometry is coded on."""
        return self.stitching.points[self.manifold]

    @cached_property
    def opposite(self) -> _Ints:
        """Of the half-edges of the manifold, (3 k,), as of `topology.pair_halfedges`."""
        return pair_halfedges(self.manifold, len(self.stitching.points))

    @cached_property
    def corners(self) -> Corners:
        """The corners of the complex, point by point."""
        count = self.used + self.isolated
        return corners_of(self.manifold, self.opposite, self.stitching, count)

    @cached_property
    def partners(self) -> _Ints:
        """The half-edge of the mesh that each may be glued to, (3 m,), or -1."""
        return partners(self.faces, self.opposite, self.stitching.turned)

    @cached_property
    def polygons(self) -> Polygons:
        """The polygons of the mesh."""
        return joined(self.glued) if len(self.glued) else plain(len(self.faces))

    @cached_property
    def hidden(self) -> NDArray[np.bool_]:
        """Half-edges of the manifold, (3 k,), within a polygon; (0,) if all are triangles."""
        if not len(self.glued):
            return NO_EDGES
        return hidden_halfedges(self.glued, self.opposite, self.stitching.turned)

    @property
    def quads(self) -> _Ints:
        """The polygons of four corners, (q, 4), over points."""
        corners, offsets = self.polygons.corners, self.polygons.offsets
        first = offsets[:-1][np.diff(offsets) == 4]
        quads: _Ints = corners[first[:, None] + np.arange(4)]
        return np.asarray(self.points[self.faces.ravel()[quads]])

    @property
    def glue(self) -> tuple[_Ints, ...]:
        """What the digest of a file covers of its polygons."""
        return (self.glued,) if len(self.glued) else ()

    @property
    def copied(self) -> _Ints:
        """The points where some have several vertices; else nothing."""
        return self.points[: 0 if len(self.points) == self.used + self.isolated else None]


@dataclass(frozen=True)
class Origin:
    """Where in the input everything comes from.

    Attributes
    ----------
    points : int64 (p,)
        A vertex at each point.
    vertices : int64 (n,)
        The vertex that each vertex was.
    corners : int64 (m, 3)
        The corner, 3 * face + 0, 1 or 2, that each corner was.
    """

    points: _Ints
    vertices: _Ints
    corners: _Ints


def encode_structure(
    mesh: Mesh, drop_isolated: bool, exact: bool, progress: Callable[[str], None]
) -> tuple[dict[str, bytes], Structure, Origin]:
    """Code all but the positions.

    Parameters
    ----------
    mesh : Mesh
    drop_isolated : bool
        Leave out the vertices that are in no face.
    exact : bool
        Whether 0.0 and -0.0 are different positions.
    progress : callable
        Called with the name of each stage as it begins.

    Returns
    -------
    payloads : dict of section id to bytes
    structure : Structure
    origin : Origin
    """
    progress("topology")
    keep, welded = weld(mesh.vertices, exact=exact)
    faces = welded[mesh.faces]
    manifold = cut(faces, len(keep))
    topology = build_topology(manifold.faces, manifold.opposite, len(manifold.points))
    progress("connectivity")
    payload, coded = encode_connectivity(topology)
    payloads = {"CONN": payload}

    in_face = np.zeros(len(welded), dtype=bool)
    in_face[mesh.faces] = True
    kept = in_face | (not drop_isolated)
    stitching_points, used = _first_appearances(manifold.points[coded.order], len(keep))
    number = np.full(len(keep), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    others = np.unique(welded[kept])
    others = others[number[others] < 0]
    others = others[np.lexsort(mesh.vertices[keep[others]].T[::-1])]
    number[others] = np.arange(len(used), len(used) + len(others))

    stitching, corners = _stitching(faces, manifold, coded, stitching_points, number)
    structure = Structure(
        manifold=coded.faces,
        stitching=stitching,
        used=len(used),
        isolated=len(others),
        faces=complex_faces(coded.faces, stitching),
        points=np.arange(len(used) + len(others)),
    )
    last = np.flatnonzero(kept)[::-1]
    places = np.empty(len(used) + len(others), dtype=np.int64)
    places[number[welded[last]]] = last  # the first vertex at each point is assigned last
    origin = Origin(points=places, vertices=places, corners=corners)
    has_copies = len(last) > len(places)
    if stitching.is_trivial and not has_copies:
        return payloads, structure, origin
    if not stitching.is_trivial:
        payloads["STCH"] = encode_stitching(coded.faces, structure.opposite, stitching, len(places))
    if not has_copies:
        return payloads, structure, origin
    all_corners = structure.corners
    source = mesh.faces.ravel()[corners.ravel()]
    loose = np.flatnonzero(kept & ~in_face)
    count = np.bincount(number[welded[loose]], minlength=len(places))
    count -= np.bincount(all_corners.points, minlength=len(places)) == 0
    payloads["COPY"], classes = encode_copies(all_corners, source, count)
    copies = copies_of(all_corners, classes, count)
    vertices = np.full(len(copies.points), -1, dtype=np.int64)
    vertices[copies.faces.ravel()] = source
    vertices[vertices < 0] = loose[np.argsort(number[welded[loose]], kind="stable")]
    structure = replace(structure, faces=copies.faces, points=copies.points)
    return payloads, structure, Origin(places, vertices, corners)


def coded_surface(structure: Structure) -> Surface:
    """Return what the geometry of a mesh is coded on."""
    s = structure
    return surface_of(s.surface, s.used, s.isolated, s.hidden, s.quads)


def encode_gluing(
    structure: Structure, origin: Origin, triangles: Triangles
) -> tuple[dict[str, bytes], Structure]:
    """Code which triangles make a polygon; return the payload, if any, and the structure with it.

    Parameters
    ----------
    structure : Structure
    origin : Origin
    triangles : Triangles
        Of the input; fans.
    """
    sizes = np.bincount(triangles.polygon) + 2
    if len(sizes) == len(structure.faces):
        return {}, structure
    glued = glued_halfedges(triangles, origin.corners)
    payload = encode_polygons(structure.faces, structure.partners, glued, sizes)
    return {"POLY": payload}, replace(structure, glued=glued)


def _first_appearances(points: _Ints, n: int) -> tuple[_Ints, _Ints]:
    """Return points renumbered in the order of their first appearance, and the points so."""
    at = np.arange(len(points))
    first = np.empty(n, dtype=np.int64)
    first[points[::-1]] = at[::-1]  # the last one assigned stays: the first there is
    is_first = first[points] == at
    return (np.cumsum(is_first) - 1)[first[points]], points[is_first]


def _stitching(
    faces: _Ints, manifold: Cut, coded: Connectivity, points: _Ints, number: _Ints
) -> tuple[Stitching, _Ints]:
    """Return the stitching, and the input corner of each corner of the complex.

    faces : int64 (m, 3), of the input, welded; number : of its points.
    """
    face, turn = np.divmod(coded.starts, 3)
    turned = manifold.turned[face]
    # A face begins with that corner of the face of the cut; either has its winding turned.
    at = (turn[:, None] + np.where(turned[:, None], TURN, np.arange(3))) % 3
    at = np.where(turned[:, None], TURN[at], at)
    corners = 3 * manifold.sources[face][:, None] + at
    rank = np.empty(len(face), dtype=np.int64)
    rank[face] = np.arange(len(face))

    repeated = rank[manifold.repeated]
    order = np.lexsort((manifold.against, repeated))
    repeats, repeated = manifold.repeats[order], repeated[order]
    begin = faces.ravel()[corners[repeated, 0]]
    turn = np.argmax(faces[repeats] == begin[:, None], axis=1)
    again = 3 * repeats[:, None] + (turn[:, None] + np.arange(3)) % 3

    F = faces[manifold.degenerate]
    # Begin with the first of two equal corners.
    turn = np.argmax(np.roll(F, -1, axis=1) == F, axis=1)
    flat = 3 * manifold.degenerate[:, None] + (turn[:, None] + np.arange(3)) % 3
    pairs = number[faces.ravel()[flat[:, [0, 2]]]]
    by = np.lexsort((pairs[:, 1], pairs[:, 0]))
    stitching = Stitching(points, turned, repeated, manifold.against[order], pairs[by])
    return stitching, np.concatenate([corners, again, flat[by]])


def announced(container: Container) -> Counts:
    """Return what a file announces.

    Raises
    ------
    FormatError
        For counts that contradict each other.
    """
    sections, isolated = container.sections, container.parameters.isolated
    points, faces = container.vertices, container.faces
    if "COPY" in sections:
        with payload_of(sections["COPY"]) as payload:
            points = copied_points(payload, container.vertices, isolated)
    vertices = points - isolated
    if "STCH" in sections:
        with payload_of(sections["STCH"]) as payload:
            vertices, faces = stitched_counts(payload, points - isolated, container.faces)
    return Counts(points, isolated, vertices, faces)


def decode_structure(container: Container, counts: Counts) -> Structure:
    """Return all but the positions: the mirror of `encode_structure`.

    Raises
    ------
    FormatError
    """
    sections, used = container.sections, counts.points - counts.isolated
    with payload_of(sections["CONN"]) as payload:
        faces = decode_connectivity(payload, counts.vertices, counts.faces)
    points, stitching = np.arange(counts.points), trivial(counts.vertices, counts.faces)
    structure = Structure(faces, stitching, used, counts.isolated, faces, points)
    if not _NEED_MANIFOLD & sections.keys():
        return structure
    if not _is_manifold(faces, structure.opposite, counts.vertices):
        raise FormatError("the connectivity is no manifold", sections["CONN"].offset)
    if "STCH" in sections:
        with payload_of(sections["STCH"]) as payload:
            stitching = decode_stitching(
                payload, faces, structure.opposite, used, counts.points, container.faces
            )
        final = complex_faces(faces, stitching)
        structure = Structure(faces, stitching, used, counts.isolated, final, points)
    if "COPY" in sections:
        with payload_of(sections["COPY"]) as payload:
            copies = decode_copies(payload, structure.corners, container.vertices)
        structure = replace(structure, faces=copies.faces, points=copies.points)
    if "POLY" in sections:
        with payload_of(sections["POLY"]) as payload:
            glued = decode_polygons(payload, structure.faces, structure.partners)
        structure = replace(structure, glued=glued)
    return structure


def _is_manifold(faces: _Ints, opposite: _Ints, n: int) -> bool:
    """Tell whether faces that meet agree in winding, and each vertex has one fan of faces."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    inner = np.flatnonzero(opposite >= 0)
    if (start[opposite[inner]] != end[inner]).any() or (end[opposite[inner]] != start[inner]).any():
        return False
    return bool(cutting.label_fans(opposite, np.empty(len(opposite), dtype=np.int64)) == n)
