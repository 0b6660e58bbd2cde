"""The order of vertices and faces: kept exactly, and cheaply where it follows the mesh."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest

from deltamesh import decode
from deltamesh.codec import encode_mesh
from deltamesh.options import Options
from deltamesh.order import Order, decode_order, encode_order

MANIFOLDS = {name: mesh for name, mesh in meshes.every().items() if name != "three_pages"}


def identity(n, m):
    return Order(np.arange(n), np.arange(m), np.zeros(m, dtype=np.int64))


def scrambled(n, m, seed):
    rng = np.random.default_rng(seed)
    return Order(rng.permutation(n), rng.permutation(m), rng.integers(0, 3, m))


def assert_round_trip(faces, order):
    """Encode and decode; return the payload."""
    payload = encode_order(faces, order)
    decoded = decode_order(memoryview(payload), faces, len(order.vertices))
    for name in ("vertices", "faces", "turns"):
        np.testing.assert_array_equal(getattr(decoded, name), getattr(order, name))
        assert getattr(decoded, name).dtype == np.int64
    return payload


def naive(n, m):
    """The bytes of any order, all as likely: log2(n! m! 3^m) bits."""
    return (math.lgamma(n + 1) + math.lgamma(m + 1) + m * math.log(3)) / math.log(256)


@pytest.mark.parametrize("name", MANIFOLDS)
@pytest.mark.parametrize("method", ["highpass", "cartesian"])
def test_a_mesh_comes_back_in_its_order(name: str, method: str) -> None:
    V, F = MANIFOLDS[name]
    mesh, _ = meshes.shuffled(V, F, 5)
    encoded = encode_mesh(mesh, Options(method=method, keep_order=True))
    decoded = decode(encoded.data)
    np.testing.assert_array_equal(decoded.faces, mesh.faces)
    np.testing.assert_array_equal(encoded.mesh.faces, mesh.faces)
    np.testing.assert_array_equal(encoded.order, np.arange(len(V)))
    assert np.abs(decoded.vertices - mesh.vertices).max() < 0.05
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, rtol=0, atol=1e-8)
