"""hypothesis strategies: manifold meshes of any shape, from a base and a list of operations.

Every operation keeps an oriented manifold one, and does nothing where it would not. What they are
given are plain integers, which shrink.
"""

from __future__ import annotations

import meshes
import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from meshes import Arrays
from numpy.typing import NDArray

Faces = list[tuple[int, int, int]]

# A share of the examples of the profile, for tests that take long over each.
FEW = settings(max_examples=max(settings.default.max_examples // 4, 5))
SOME = settings(max_examples=max(settings.default.max_examples // 2, 5))


def halfedges(faces: Faces) -> dict[tuple[int, int], int]:
    """The third vertex of the face on the left of each half-edge."""
    return {(f[i - 2], f[i - 1]): f[i] for f in faces for i in range(3)}


def is_manifold(faces: Faces) -> bool:
    """Whether half-edges are unique and the faces of each vertex form one fan; slow and obvious."""
    left = halfedges(faces)
    if len(left) != 3 * len(faces):
        return False
    for v in {v for f in faces for v in f}:
        link = {f[i - 2]: f[i - 1] for f in faces for i in range(3) if f[i] == v}
        starts = [a for a in link if a not in link.values()] or [min(link)]
        a, fan = starts[0], 0
        while a in link and fan < len(link):
            a, fan = link[a], fan + 1
        if len(starts) > 1 or fan < len(link):
            return False
    return True


def flip(faces: Faces, at: int) -> Faces:
    """Replace an interior edge by the other diagonal of its two triangles."""
    left = halfedges(faces)
    interior = sorted((a, b) for a, b in left if a < b and (b, a) in left)
    if not interior:
        return faces
    a, b = interior[at % len(interior)]
    c, d = left[a, b], left[b, a]
    if c == d or (c, d) in left or (d, c) in left:
        return faces
    others = [f for f in faces if not {a, b} <= set(f)]
    return [*others, (a, d, c), (d, b, c)]


def open_hole(faces: Faces, at: int) -> Faces:
    """Take a face away."""
    at %= len(faces)
    rest = faces[:at] + faces[at + 1 :]
    return rest if rest and is_manifold(rest) else faces


def join_by_tube(faces: Faces, at: int, to: int) -> Faces:
    """Put a tube in the place of two faces: a handle, or one component less."""
    (a, b, c), (d, e, f) = faces[at % len(faces)], faces[to % len(faces)]
    left = halfedges(faces)
    new = [(a, f), (a, d), (b, f), (b, e), (c, e), (c, d)]
    if len({a, b, c, d, e, f}) < 6 or any((v, w) in left or (w, v) in left for v, w in new):
        return faces
    others = [face for face in faces if face not in ((a, b, c), (d, e, f))]
    tube = [(a, b, f), (a, f, d), (b, c, e), (b, e, f), (c, a, d), (c, d, e)]
    return others + tube


SMALL = st.integers(0, 10**6)

bases = st.one_of(
    st.just(meshes.tetrahedron()),
    st.builds(meshes.icosphere, st.integers(0, 1)),
    st.builds(meshes.torus, st.integers(3, 8), st.integers(3, 7)),
    st.builds(meshes.grid, st.integers(2, 7), st.integers(2, 7)),
    st.just(meshes.double_torus()),
)
operations = st.lists(
    st.one_of(
        st.tuples(st.just(flip), SMALL),
        st.tuples(st.just(open_hole), SMALL),
        st.tuples(st.just(join_by_tube), SMALL, SMALL),
    ),
    max_size=12,
)


@st.composite
def surfaces(draw: st.DrawFn) -> Arrays:
    """Oriented manifolds with holes, handles and components, and isolated vertices, shuffled."""
    V, F = meshes.union(*draw(st.lists(bases, min_size=1, max_size=3)))
    faces = [tuple(map(int, f)) for f in F]
    for operation, *places in draw(operations):
        faces = operation(faces, *places)
    # Positions that no two vertices share: equal ones are welded.
    noise = np.random.default_rng(draw(SMALL)).normal(size=V.shape)
    vertices = V + draw(st.sampled_from([1e-3, 1.0])) * noise
    mesh, _ = meshes.shuffled(vertices, np.array(faces), draw(SMALL))
    return mesh.vertices, mesh.faces


@st.composite
def complexes(draw: st.DrawFn) -> Arrays:
    """Triangles of any kind: non-manifold, turned, repeated, degenerate; vertices at one place."""
    seed = draw(SMALL)
    rng = np.random.default_rng(seed)
    if draw(st.booleans()):
        n = draw(st.integers(1, 12))
        F = np.array(draw(st.lists(st.tuples(*[st.integers(0, n - 1)] * 3), min_size=1)))
    else:
        V, F = draw(surfaces())
        n = len(V)
        glued = rng.random(n) < draw(st.sampled_from([0.0, 0.1, 0.5]))
        F = np.where(glued, rng.integers(0, n, n), np.arange(n))[F]
    again = rng.random(len(F)) < draw(st.sampled_from([0.0, 0.1, 1.0]))
    F = np.concatenate((F, F[again]))
    turned = rng.random(len(F)) < draw(st.sampled_from([0.0, 0.1, 0.5]))
    F = np.where(turned[:, None], F[:, [0, 2, 1]], F)
    n += draw(st.integers(0, 4))  # isolated ones
    places = draw(st.sampled_from([2, 4, 100]))
    on_grid = rng.integers(0, places, (n, 3)).astype(float)
    V = on_grid if draw(st.booleans()) else rng.normal(size=(n, 3))
    if draw(st.booleans()):
        to = rng.integers(0, n, draw(st.integers(1, n)))
        for i, v in enumerate(to.tolist(), start=n):
            F[np.equal(F, v) & (rng.random(F.shape) < 0.4)] = i
        V = np.concatenate((V, V[to]))
    mesh, _ = meshes.shuffled(V, F, seed)
    return mesh.vertices, mesh.faces


def canonical(faces: NDArray[np.int64]) -> list[tuple[int, ...]]:
    """The faces as a sorted list, each in the least of its rotations: winding counts."""
    return sorted(min((a, b, c), (b, c, a), (c, a, b)) for a, b, c in faces.tolist())
