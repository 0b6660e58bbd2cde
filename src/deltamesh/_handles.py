"""Vertices that an edit moves or holds, as points of a surface."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._content import Content
from deltamesh._geometry.editing import Held
from deltamesh._geometry.rotations import nearest, to_quaternions
from deltamesh._graph.adjacency import lowest
from deltamesh_formats.arguments import require
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

# Vertices by their indices, by a mask, or by the name of a part.
Vertices: TypeAlias = ArrayLike | str
# Vertices that move, and a matrix (4, 4), a shift (3,), or their positions (k, 3).
Move: TypeAlias = tuple[Vertices, ArrayLike]

_STILL = np.array([1.0, 0.0, 0.0, 0.0])


def held(
    mesh: PolyMesh,
    content: Content,
    rest: Floats,
    moves: Sequence[Move],
    fix: Iterable[Vertices],
) -> tuple[Held, Bools]:
    """Return the points that an edit holds, ascending, and which of them it moves, bool (h,).

    Parameters
    ----------
    mesh : PolyMesh
        At rest, as it is decoded.
    content : Content
        Of its file.
    rest : float64 (n, 3)
        The points of faces, at rest.
    moves, fix
        See `deltamesh.edit`.

    Raises
    ------
    OptionError
    """
    n, surface = len(rest), content.structure.surface
    state = np.zeros(n, dtype=np.int8)  # of each point: 0 free, 1 fixed, 2 moved
    positions, quaternions = rest.copy(), np.tile(_STILL, (n, 1))
    turned = np.ones(n, dtype=bool)
    for vertices in fix:
        points = content.points[indices_of(mesh, vertices)]
        state[points[points < n]] = 1  # an isolated one stays by itself
    moves = list(moves)
    if not moves:
        raise OptionError("no vertices are moved")
    for move in moves:
        vertices, target = _pair(move)
        listed = indices_of(mesh, vertices)
        points, at, back = np.unique(content.points[listed], return_index=True, return_inverse=True)
        chosen = listed[at]
        if not len(chosen):
            raise OptionError("a move of no vertices")
        _refuse(chosen, points >= n, "belongs to no face, and cannot be moved")
        _refuse(chosen, state[points] == 1, "is moved, and fixed")
        _refuse(chosen, state[points] == 2, "is moved twice")
        state[points] = 2
        placed, quaternion = _target(np.asarray(target), rest[points[back]])
        _refuse(listed, (placed != placed[at[back]]).any(axis=1), "is put in two places")
        positions[points] = placed[at]
        turned[points] = quaternion is not None
        quaternions[points] = _STILL if quaternion is None else quaternion
    components = np.bincount(surface.labels[state > 0], minlength=int(surface.labels.max()) + 1)
    state[lowest(surface.labels)[components == 0]] = 1
    found = np.flatnonzero(state)
    places = Held(found, positions[found], quaternions[found], turned[found])
    return places, state[found] == 2


def indices_of(mesh: PolyMesh, vertices: Vertices) -> Ints:
    """Return vertices of a mesh by their indices, int64.

    Raises
    ------
    OptionError
        If it has no such vertices, or no part of this name.
    """
    n = len(mesh.vertices)
    if isinstance(vertices, str):
        return _of_part(mesh, vertices)
    array = np.asarray(vertices)
    if array.dtype == np.bool_:
        if array.shape != (n,):
            raise OptionError(f"a mask of shape {array.shape} for {n} vertices")
        return np.flatnonzero(array)
    array = np.ravel(array)
    if not len(array):
        return np.zeros(0, dtype=np.int64)
    if array.dtype.kind not in "iu":
        raise OptionError(f"vertices are indices, a mask or a name, not {array.dtype}")
    if array.min() < 0 or array.max() >= n:
        wrong = int(array[(array < 0) | (array >= n)][0])
        raise OptionError(f"vertex {wrong} of a mesh of {n}")
    return array.astype(np.int64)


def _of_part(mesh: PolyMesh, name: str) -> Ints:
    for parts in mesh.parts:
        chosen = [number for number, known in enumerate(parts.names) if known == name]
        if chosen:
            in_part = np.repeat(np.isin(parts.of_face, chosen), mesh.sizes)
            return np.unique(mesh.corners[in_part])
    raise OptionError(f"there is no part {name!r}")


def _pair(move: Move) -> Move:
    """Return the vertices of a move, and where they go."""
    fits = isinstance(move, (tuple, list)) and len(move) == 2
    require(fits, "a move must be a pair of vertices and a motion", move)
    return move


def _refuse(vertices: Ints, wrong: Bools, fault: str) -> None:
    if wrong.any():
        raise OptionError(f"vertex {int(vertices[wrong].min())} {fault}")


def _target(target: np.ndarray, rest: Floats) -> tuple[Floats, Floats | None]:
    """Return where vertices go, and the quaternion by which they turn, if that is given."""
    if target.dtype.kind not in "iuf" or not np.isfinite(target).all():
        raise OptionError("a move that is not of finite numbers")
    target = target.astype(np.float64)
    if target.shape == (3,):
        return rest + target, None
    if target.shape == (4, 4):
        if (target[3] != (0, 0, 0, 1)).any():
            raise OptionError("the last row of a matrix has to be 0 0 0 1")
        linear = target[:3, :3]
        if not np.linalg.det(linear) > 0:
            raise OptionError("a matrix that mirrors, or flattens")
        return rest @ linear.T + target[:3, 3], to_quaternions(nearest(linear[None]))[0]
    if target.shape != rest.shape:
        shape = f"(4, 4), (3,) or {rest.shape}"
        raise OptionError(f"a move of shape {target.shape}: it is {shape}")
    return target, None
