"""Any triangles to a manifold and what makes them of it; the mirror is `structure_decoding`.

weld -> cut -> connectivity -> stitching -> copies -> polygons
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.halfedges import weld
from deltamesh._mesh import TriangleMesh
from deltamesh._shape.complexes import Cut, cut
from deltamesh._shape.connectivity import Connectivity, encode_connectivity
from deltamesh._shape.corners import copies_of, encode_copies
from deltamesh._shape.merging import encode_polygons, glued_halfedges
from deltamesh._shape.stitching import TURN, Stitching, complex_faces, encode_stitching
from deltamesh._shape.structure import Structure
from deltamesh._shape.topology import build_topology
from deltamesh_formats.polymesh.triangles import Triangles

_Ints = NDArray[np.int64]


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
    mesh: TriangleMesh, drop_isolated: bool, exact: bool, progress: Callable[[str], None]
) -> tuple[dict[str, bytes], Structure, Origin]:
    """Code all but the positions.

    Parameters
    ----------
    mesh : TriangleMesh
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
