"""Surface of a file: its graph is that of the polygons."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from polygon_meshes import MADE, lists_of, soups

from deltamesh import decode, encode
from deltamesh._graph.laplacian import laplacian
from deltamesh._options import Options
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import PolyMesh


def surface_of_file(data):
    return read_content(read_container(data), 10**9, 2**40).structure.surface


@pytest.mark.parametrize("name", ["quads", "torus", "prism"])
def test_the_laplacian_is_that_of_the_polygons(name: str) -> None:
    mesh = MADE[name]
    encoded = encode_mesh(mesh, Options(method="cartesian"))
    decoded = decode(encoded.data)
    edges = {frozenset((p[i - 1], p[i])) for p in lists_of(decoded) for i in range(len(p))}
    L = np.zeros((len(mesh.vertices),) * 2)
    for a, b in map(tuple, edges):
        L[a, b] = L[b, a] = -1
    np.fill_diagonal(L, -L.sum(axis=1))
    np.testing.assert_array_equal(laplacian(*surface_of_file(encoded.data).graph).toarray(), L)


@given(soups())
def test_components_stay_whole(mesh: PolyMesh) -> None:
    """Without hidden edges, the vertices of a face still hang together."""
    surface = surface_of_file(encode(mesh, method="cartesian"))
    labels = surface.labels[surface.faces]
    assert (labels == labels[:, :1]).all()


def test_hidden_halfedges_are_no_edges_unless_one_is_seen() -> None:
    """Three triangles on one edge, hidden in two of them only: it counts."""
    F = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    hidden = np.zeros(9, dtype=bool)
    hidden[[0, 3]] = True
    seen = surface_of(F, 5, 0, hidden)
    assert laplacian(*seen.graph)[0, 1] == -1
    hidden[6] = True
    alone = surface_of(F, 5, 0, hidden)
    assert laplacian(*alone.graph)[0, 1] == 0
    assert laplacian(*alone.graph)[0, 2] == -1
    assert alone.labels.tolist() == [0] * 5
