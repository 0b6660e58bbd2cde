"""Order of polygons, and the corners at which they begin."""

from __future__ import annotations

import contextlib

import numpy as np
import strategies
from drafts import merged_of
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import soups

from deltamesh._order.coding import decode_order, encode_order
from deltamesh._order.reordering import Order
from deltamesh._shape.polygons import merged_polygons
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh


@given(soups(), strategies.SMALL, st.booleans())
def test_any_order_of_any_polygons(mesh: PolyMesh, seed: int, near: bool) -> None:
    structure, merged = merged_of(mesh)
    faces, polygons, rng = structure.faces, merged_polygons(merged), np.random.default_rng(seed)
    n, sizes = int(faces.max()) + 1, np.diff(polygons.offsets)
    vertices, places = rng.permutation(n), rng.permutation(len(sizes))
    if near:  # runs, so that steps of all kinds come up
        vertices[n // 2 :].sort()
        places[len(sizes) // 3 :].sort()
    order = Order(vertices, places, rng.integers(0, sizes[places]))
    payload = encode_order(faces, polygons, order)
    decoded = decode_order(memoryview(payload), faces, polygons, n)
    for name in ("vertices", "polygons", "rotations"):
        np.testing.assert_array_equal(getattr(decoded, name), getattr(order, name))
    # What no encoder has written is an order, too, or refused.
    damaged = bytes([payload[0]]) + rng.bytes(len(payload))
    with contextlib.suppress(FormatError):
        decoded = decode_order(memoryview(damaged), faces, polygons, n)
        assert sorted(decoded.polygons.tolist()) == list(range(len(sizes)))
        assert (decoded.rotations < sizes[decoded.polygons]).all()
