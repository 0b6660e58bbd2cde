"""Rotations in the core: what it refuses."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.mesh import rotations as kernels


@pytest.mark.parametrize("bad", [-1, 3, (1 << 31) - 1])
def test_a_graph_of_other_vertices_is_refused(bad: int) -> None:
    graph = np.array([0, 1, 1, 1], np.int32), np.array([bad], np.int32)
    V, R = np.zeros((3, 3)), np.zeros((3, 3, 3))
    with pytest.raises(ValueError, match="contradict"):
        kernels.fit(*graph, V, V, 0)
    with pytest.raises(ValueError, match="contradict"):
        kernels.turned_deltas(*graph, V, R)


def test_a_negative_number_of_rings_is_refused() -> None:
    V, F = meshes.tetrahedron()
    with pytest.raises(ValueError, match="contradict"):
        kernels.fit(*adjacency(F, len(V)), V, V, -1)
