"""Parallelograms of a mesh, as the core finds them."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._graph.parallelograms import NO_QUADS
from deltamesh._kernels.mesh import parallelograms as kernels


@pytest.mark.parametrize("name", ["torus", "grid"])
def test_parallelograms_equal_their_oracle(name: str) -> None:
    V, F = meshes.every()[name]
    first, corners, within = kernels.find(F, len(V), pair_halfedges(F), NO_QUADS)
    expected = oracle.parallelograms(F)
    for i in range(len(V)):
        rows = corners[first[i] : first[i + 1]].tolist()
        assert sorted(map(tuple, rows)) == sorted(expected.get(i, []))
    assert not within.any()


def test_indices_of_no_vertex_and_no_half_edge_are_refused() -> None:
    F, quads = np.array([[0, 1, 2], [2, 1, 3]]), np.array([[0, 1, 3, 2]])
    opposite = pair_halfedges(F)
    for bad in (-2, 6, 1 << 62):
        for k in range(3):
            arrays = [F.copy(), opposite.copy(), quads.copy()]
            arrays[k].flat[1] = bad
            with pytest.raises(ValueError, match="contradict"):
                kernels.find(arrays[0], 4, arrays[1], arrays[2])
