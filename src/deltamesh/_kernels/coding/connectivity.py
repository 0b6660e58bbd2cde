"""Region growing over a closed triangle mesh, one valence a vertex.

Touma & Gotsman, *Triangle Mesh Compression*, Graphics Interface 1998, with the choice of pivot of
Alliez & Desbrun, *Valence-Driven Connectivity Encoding for 3D Meshes*, Eurographics 2001: the
front vertex with the fewest free edges grows next, the oldest of several, which keeps fronts convex
and joins rare. Unlike both, joins need no stack of fronts: linking a pivot to any live node splits
its front in two or, if the node is on another front, merges the two (a handle).

The same functions encode and decode. Where the encoder looks at the mesh, the decoder reads.
Each step adds one face, so that any stream ends after as many steps as there are faces.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from deltamesh._kernels.coding.coder import DECODING, Coder
from deltamesh._kernels.coding.front import (
    FACES,
    JOINS,
    VERTICES,
    Front,
    add_node,
    choose_pivot,
    link,
    remove_node,
    set_free,
)
from deltamesh._kernels.coding.valence import (
    OF_LOOP,
    RECENT,
    VALENCE_CAP,
    code_count,
    code_join_flag,
    code_loop_flag,
    code_side,
    code_target,
    code_valence,
    gate_contexts,
    seed_contexts,
)
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh_formats.array_types import Ints

OK, CORRUPT = 0, 1
DONE = -2


HALFEDGE = np.dtype([("start", np.int64), ("opposite", np.int64), ("node", np.int64)])
OLD_VERTEX = np.dtype([("degree", np.int64), ("new", np.int64)])
NEW_VERTEX = np.dtype([("valence", np.int64), ("old", np.int64), ("is_loop", np.bool_)])


class Region(NamedTuple):
    """The mesh that is visited (empty arrays when decoding), and what is found.

    Attributes
    ----------
    halfedges : HALFEDGE (3 f,)
        Of the closed mesh: the vertex at which each starts; its opposite; the node whose gate it
        is, or DONE in the first of a visited face.
    old : OLD_VERTEX (n,)
        Valence of each vertex; its new index, -1 before its visit.
    faces : int64 (f, 3), vertices : NEW_VERTEX (n,)
        The closed mesh in the order of the visit.
    model : int64 (MODEL_SIZE,)
        What the valence model remembers.
    starts : int64 (f,)
        The half-edge with which each face begins; empty when decoding.
    """

    halfedges: Any
    old: Any
    faces: Ints
    vertices: Any
    model: Ints
    starts: Ints


@kernel
def grow(c: Coder, front: Front, r: Region, loops: Int, loop_start: Int) -> Int:
    """Visit all faces; return OK, or CORRUPT for a stream that no encoder has written."""
    counts = front.counts
    seed = 0
    encoding = c.state[DECODING] == 0
    remaining = loops
    while counts[FACES] < len(r.faces):
        pivot = choose_pivot(front)
        if pivot < 0:
            while encoding and r.halfedges[3 * seed].node == DONE:
                seed += 1
            status = _begin(c, front, r, seed)
        elif front.nodes[pivot].free == 0:
            status = _close(c, front, r, pivot)
        else:
            remaining = _expand(c, front, r, pivot, remaining, loop_start)
            status = OK if remaining >= 0 else CORRUPT
        if status != OK:
            return status
    complete = choose_pivot(front) < 0 and counts[VERTICES] == len(r.vertices)
    return OK if complete and remaining == 0 else CORRUPT


@inlined
def _is_done(r: Region, h: Int) -> Flag:
    return r.halfedges[h - h % 3].node == DONE


@inlined
def _add_face(front: Front, r: Region, start: Int, a: Int, b: Int, c: Int) -> None:
    """Add the face (a, b, c), which begins with the half-edge `start`."""
    counts = front.counts
    f = counts[FACES]
    counts[FACES] = f + 1
    r.faces[f, 0], r.faces[f, 1], r.faces[f, 2] = a, b, c
    if f < r.starts.size:
        r.starts[f] = start


@inlined
def _set_gate(c: Coder, front: Front, r: Region, a: Int, b: Int, behind: Int, inner: Int) -> None:
    """Link a to b across the half-edge `inner` (b to a) of the visited face."""
    halfedges = r.halfedges
    gate = -1
    if c.state[DECODING] == 0:
        gate = halfedges[inner].opposite
        halfedges[gate].node = a
    link(front, a, b, behind, gate)


@kernel
def _add_vertex(c: Coder, front: Front, r: Region, vertex: Int, mixer: Int) -> Int:
    """Code a vertex that is no loop's; return its node."""
    counts = front.counts
    state = c.state
    new = counts[VERTICES]
    counts[VERTICES] = new + 1
    degree = r.old[vertex].degree if state[DECODING] == 0 else 0
    r.vertices[new].valence = code_valence(c, degree, r.model, mixer)
    r.vertices[new].is_loop = False
    if state[DECODING] == 0:
        r.old[vertex].new = new
        r.vertices[new].old = vertex
    return add_node(front, new, r.vertices[new].valence - 2)


@kernel
def _add_loop(c: Coder, front: Front, r: Region, vertex: Int) -> Int:
    """Code a vertex that closes a boundary loop; return its node."""
    counts = front.counts
    state = c.state
    new = counts[VERTICES]
    counts[VERTICES] = new + 1
    degree = r.old[vertex].degree if state[DECODING] == 0 else 1
    r.vertices[new].valence = code_count(c, degree, np.int64(OF_LOOP))
    r.vertices[new].is_loop = True
    if state[DECODING] == 0:
        r.old[vertex].new = new
        r.vertices[new].old = vertex
    return add_node(front, new, max(r.vertices[new].valence - 2, 0))


@kernel
def _begin(c: Coder, front: Front, r: Region, seed: Int) -> Int:
    """Begin a component with a face; its three edges are the first front."""
    nodes = front.nodes
    halfedges = r.halfedges
    if front.counts[VERTICES] + 3 > len(r.vertices):
        return CORRUPT
    mixer = seed_contexts(r.model)
    encoding = c.state[DECODING] == 0
    n0 = _add_vertex(c, front, r, halfedges[3 * seed].start if encoding else 0, mixer)
    n1 = _add_vertex(c, front, r, halfedges[3 * seed + 1].start if encoding else 0, mixer)
    n2 = _add_vertex(c, front, r, halfedges[3 * seed + 2].start if encoding else 0, mixer)
    v0, v1, v2 = nodes[n0].vertex, nodes[n1].vertex, nodes[n2].vertex
    _add_face(front, r, 3 * seed, v0, v1, v2)
    if encoding:
        halfedges[3 * seed].node = DONE
    _set_gate(c, front, r, n1, n0, v2, 3 * seed)
    _set_gate(c, front, r, n2, n1, v0, 3 * seed + 1)
    _set_gate(c, front, r, n0, n2, v1, 3 * seed + 2)
    return OK


@kernel
def _close(c: Coder, front: Front, r: Region, node: Int) -> Int:
    """Add the one face left at a node without free edges."""
    nodes = front.nodes
    before, after = nodes[node].predecessor, nodes[node].successor
    gate = nodes[before].gate
    _add_face(front, r, gate, nodes[before].vertex, nodes[node].vertex, nodes[after].vertex)
    if c.state[DECODING] == 0:
        r.halfedges[gate - gate % 3].node = DONE
    remove_node(front, node)
    if nodes[after].successor == before:  # the last face of a front
        remove_node(front, before)
        remove_node(front, after)
        return OK if nodes[before].free == 0 and nodes[after].free == 0 else CORRUPT
    if nodes[before].free == 0 or nodes[after].free == 0:
        return CORRUPT
    set_free(front, before, nodes[before].free - 1)
    set_free(front, after, nodes[after].free - 1)
    inner = previous_halfedge(gate)
    _set_gate(c, front, r, before, after, nodes[node].vertex, inner)
    return OK


@kernel
def _expand(c: Coder, front: Front, r: Region, pivot: Int, loops: Int, loop_start: Int) -> Int:
    """Add the face at the gate of a pivot; return the loops that remain, or -1: corrupt."""
    nodes = front.nodes
    halfedges = r.halfedges
    after = nodes[pivot].successor
    if nodes[after].free == 0:
        return -1
    gate, vertex, encoding = np.int64(0), np.int64(0), c.state[DECODING] == 0
    if encoding:
        gate = nodes[pivot].gate
        vertex = halfedges[previous_halfedge(gate)].start
        halfedges[gate - gate % 3].node = DONE
    if code_join_flag(c, front, pivot, encoding and r.old[vertex].new >= 0):
        return loops if _join(c, front, r, pivot, gate) == OK else -1
    if front.counts[VERTICES] == len(r.vertices):
        return -1
    behind_pivot, behind_after = nodes[after].vertex, nodes[pivot].vertex
    if loops > 0 and code_loop_flag(c, encoding and vertex >= loop_start):
        loops -= 1
        node = _add_loop(c, front, r, vertex)
    else:
        mixer = gate_contexts(front, pivot, r.vertices, r.model)
        node = _add_vertex(c, front, r, vertex, mixer)
        r.model[RECENT + 1] = r.model[RECENT]
        r.model[RECENT] = min(r.vertices[nodes[node].vertex].valence, VALENCE_CAP)
    _add_face(front, r, gate, nodes[pivot].vertex, nodes[after].vertex, nodes[node].vertex)
    set_free(front, pivot, nodes[pivot].free - 1)
    set_free(front, after, nodes[after].free - 1)
    _set_gate(c, front, r, pivot, node, behind_pivot, previous_halfedge(gate))
    _set_gate(c, front, r, node, after, behind_after, next_halfedge(gate))
    return loops


@inlined
def _find_target(front: Front, r: Region, gate: Int) -> tuple[Int, Int]:
    """Find the node of the vertex across a gate, and its free edges on the pivot's side.

    Walk around the vertex both ways at once, so that a vertex of high valence that is joined
    often costs the shorter way each time.
    """
    nodes = front.nodes
    halfedges = r.halfedges
    left, right = previous_halfedge(gate), next_halfedge(gate)
    steps = 0
    while True:
        left = next_halfedge(halfedges[left].opposite)  # leaves the vertex
        if _is_done(r, halfedges[left].opposite):
            node = halfedges[left].node
            return node, steps
        right = previous_halfedge(halfedges[right].opposite)  # enters the vertex
        if _is_done(r, halfedges[right].opposite):
            node = nodes[halfedges[right].node].successor
            return node, nodes[node].free - 2 - steps
        steps += 1


@kernel
def _join(c: Coder, front: Front, r: Region, pivot: Int, gate: Int) -> Int:
    """Add a face whose third vertex is on a front: split the node there in two, and relink."""
    counts = front.counts
    # Of the nodes, as many as there are vertices are kept for these.
    if counts[JOINS] >= front.nodes.size - len(r.vertices):
        return CORRUPT
    counts[JOINS] += 1
    after = front.nodes[pivot].successor
    target, side = -1, 0
    if c.state[DECODING] == 0:
        target, side = _find_target(front, r, gate)
    target = code_target(c, front, pivot, target)
    fits = target >= 0 and target not in (pivot, after)
    if not fits or target in (front.nodes[pivot].predecessor, front.nodes[after].successor):
        return CORRUPT
    rest = front.nodes[target].free - 2
    side = code_side(c, rest, side) if rest >= 0 else 0
    if rest < side:
        return CORRUPT
    nodes = front.nodes
    _add_face(front, r, gate, nodes[pivot].vertex, nodes[after].vertex, nodes[target].vertex)
    second = add_node(front, front.nodes[target].vertex, rest - side)
    set_free(front, target, side)
    set_free(front, pivot, front.nodes[pivot].free - 1)
    set_free(front, after, front.nodes[after].free - 1)
    before = front.nodes[target].predecessor
    link(front, before, second, front.nodes[before].behind, front.nodes[before].gate)
    _set_gate(c, front, r, pivot, target, front.nodes[after].vertex, previous_halfedge(gate))
    _set_gate(c, front, r, second, after, front.nodes[pivot].vertex, next_halfedge(gate))
    return OK
