"""Meshes with parts, metadata and losses, by hypothesis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import strategies
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh_formats.container.payload_layout import KINDS
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

# Any text of Python, with surrogates and control characters.
ANY_TEXT = st.text(st.characters(exclude_categories=[]), max_size=12)


NAMES = st.lists(ANY_TEXT | st.sampled_from(["", "a", "a"]), max_size=5).map(tuple)


MATRICES = nps.arrays("u8", (4, 4)).map(lambda bits: bits.view("f8")) | st.just(np.eye(4))


@st.composite
def divisions(draw: st.DrawFn, kind: str, faces: int) -> Parts:
    names = draw(NAMES)
    rng = np.random.default_rng(draw(strategies.SMALL))
    least = draw(st.sampled_from([-1, 0])) if names else -1
    of_face = rng.integers(least, max(len(names), 1) if names else 0, faces)
    if draw(st.booleans()):
        of_face = np.sort(of_face)
    moves = draw(st.none() | st.tuples(*[MATRICES] * len(names)))
    transforms = None if moves is None else np.array(moves, dtype=np.float64).reshape(-1, 4, 4)
    return Parts(kind, names, of_face, transforms)


@st.composite
def annotated_meshes(draw: st.DrawFn) -> PolyMesh:
    """Triangles of any kind with parts, metadata and losses."""
    V, F = draw(strategies.complexes())
    kinds = draw(st.lists(st.sampled_from(list(KINDS)), unique=True))
    return replace(
        from_triangles(V, F),
        parts=tuple(draw(divisions(kind, len(F))) for kind in kinds),
        metadata=draw(st.dictionaries(ANY_TEXT, NAMES, max_size=3)),
        lost=tuple(dict.fromkeys(draw(NAMES))),
        precision=draw(st.sampled_from(["float32", "float64"])),
    )
