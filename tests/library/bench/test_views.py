"""Files of several codecs beside each other: of the same vertices, in the same order."""

from __future__ import annotations

import importlib.util

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh._mesh import TriangleMesh
from deltamesh.bench import Views, codec_of, measured
from deltamesh.bench._views import rows_in

MESH = TriangleMesh(*meshes.icosphere(3))


def test_rows_are_found_in_others() -> None:
    rows = np.random.default_rng(1).normal(size=(50, 3))
    order = np.random.default_rng(2).permutation(50)
    np.testing.assert_array_equal(rows_in(rows, rows[order]), order)
    assert rows_in(rows, rows[1:]) is None
    assert rows_in(rows, rows + 1e-9) is None


def test_ours_is_held_as_it_is_and_the_original_has_its_vertices() -> None:
    views = Views("ball.ply", 1234)
    assert views.original() is None
    _, coded = measured("", MESH, codec_of("refined bits=7"))
    own, original = views.file("refined bits=7", coded), views.original()
    assert own is not None
    assert original is not None
    assert (own.data, own.role, own.size) == (coded.data, "", len(coded.data))
    assert (original.name, original.role, original.size) == ("ball.ply", "original", 1234)
    a, b = deltamesh.decode(original.data), deltamesh.decode(own.data)
    np.testing.assert_array_equal(a.corners, b.corners)
    np.testing.assert_allclose(a.vertices, coded.reference.vertices, atol=2e-6)
    np.testing.assert_array_equal(b.vertices, coded.decoded.vertices)


@pytest.mark.parametrize("label", ["draco bits=9", "meshopt bits=9"])
def test_peers_are_held_on_their_own_grid(label: str) -> None:
    if importlib.util.find_spec({"draco": "DracoPy"}.get(label.split()[0], "meshopt")) is None:
        pytest.skip(f"without the codec of {label}")
    views = Views("ball.ply", 1)
    _, ours = measured("", MESH, codec_of("refined bits=7"))
    _, theirs = measured("", MESH, codec_of(label))
    assert views.file(label, theirs) is None  # nothing to put it beside yet
    views.file("refined bits=7", ours)
    held = views.file(label, theirs)
    assert held is not None
    assert held.size == theirs.size
    mesh = deltamesh.decode(held.data)
    np.testing.assert_array_equal(mesh.corners, deltamesh.decode(ours.data).corners)
    order = rows_in(theirs.reference.vertices, ours.reference.vertices)
    expected = theirs.decoded.vertices[order]
    assert np.abs(mesh.vertices - expected).max() < theirs.step / 100
    # On its grid it takes about what it took before, not what exact numbers would.
    assert len(held.data) < 1.5 * theirs.size


def test_exact_peers_are_not_held() -> None:
    views = Views("ball.ply", 1)
    views.file("", measured("", MESH, codec_of("refined bits=7"))[1])
    assert views.file("zstd", measured("", MESH, codec_of("zstd"))[1]) is None
