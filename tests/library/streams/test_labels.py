"""Labels of elements: round trips, the twin, their cost, and bytes that are none."""

from __future__ import annotations

import drafts
import meshes
import numpy as np
import pytest
import strategies
from elements_of import of_faces
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph import elements
from deltamesh._graph.elements import Elements, alone
from deltamesh._streams import labels
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import from_triangles
from deltamesh_formats.polymesh.permutations import numbered

SEQUENCES = st.lists(st.integers(-3, 5), max_size=12)


def size(elements: Elements, values: Ints) -> int:
    """Bytes of a stream that comes back."""
    wanted, order = numbered(values)
    data = labels.encode_labels(elements, wanted)
    found = labels.decode_labels(memoryview(data), elements)
    assert np.array_equal(order[found], values)
    return len(data)


# ---- Round trips ----------------------------------------------------------------------------


@given(strategies.complexes(), SEQUENCES, strategies.SMALL)
def test_labels_of_any_mesh_round_trip(mesh: meshes.Arrays, cycle: list[int], seed: int) -> None:
    V, F = mesh
    rng = np.random.default_rng(seed)
    for these in (elements.of_vertices(F, len(V)), of_faces(F)):
        values = np.resize(np.array(cycle or [0]), these.count)
        noise = rng.random(these.count) < rng.choice([0.0, 0.1, 1.0])
        size(these, np.where(noise, rng.integers(-(2**62), 2**62, these.count) % 50, values))


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 5])
def test_few_elements_round_trip(count: int) -> None:
    for values in np.ndindex(*(3,) * count):
        size(alone(count), np.array(values, dtype=np.int64))


@pytest.mark.parametrize("wrong", [[1, 0], [0, 2], [0, -1], [0, 1, 3, 2]])
def test_other_numbers_are_refused(wrong: list[int]) -> None:
    with pytest.raises(ValueError, match="first elements"):
        labels.encode_labels(alone(len(wrong)), np.array(wrong))


# ---- What they cost -------------------------------------------------------------------------


def test_what_goes_on_costs_next_to_nothing() -> None:
    these = of_faces(meshes.torus(160, 160)[1])
    count = these.count
    assert count > 50_000
    assert size(these, np.full(count, 3)) == 0
    for cycle in ([0, 1, 2], [0, 0, 0, 0, 0, 0, 1], list(range(100)), [0, 0, 1, 0, 0, 2]):
        assert size(these, np.resize(cycle, count)) < 40
    assert size(these, np.arange(count)) < 40


def test_patches_cost_about_a_bit_an_element_on_their_boundaries() -> None:
    V, F = meshes.torus(100, 100)
    draft = drafts.before_polygons(from_triangles(V, F))
    structure, vertices = draft.structure, draft.triangle_provenance.vertices
    these = of_faces(structure.faces)
    # Two sides of a slanted plane, across which the faces do not alternate evenly.
    middles = V[vertices][structure.faces].mean(axis=1)
    inside = middles @ np.array([0.7, 0.4, 1.1]) > 0.2
    pairs = np.repeat(np.arange(len(F)), np.diff(these.indptr))
    on_boundary = np.unique(pairs[inside[pairs] != inside[these.indices]])
    assert 100 < len(on_boundary) < 0.1 * len(F)
    assert 8 * size(these, inside.astype(np.int64)) < 1.8 * len(on_boundary)


def test_noise_costs_little_more_than_its_entropy() -> None:
    values = np.random.default_rng(7).integers(0, 170, 20_000)
    assert 8 * size(alone(20_000), values) < 1.05 * 20_000 * np.log2(170)


# ---- Refusals -------------------------------------------------------------------------------


@given(st.binary(max_size=200))
def test_any_bytes_are_labels_or_refused(data: bytes) -> None:
    these = elements.of_vertices(meshes.icosphere(1)[1], 45)
    try:
        found = labels.decode_labels(data, these)
    except FormatError:
        return
    assert labels.encode_labels(these, found) == data
    assert found[0] == 0
    assert (np.diff(np.maximum.accumulate(found)) <= 1).all()


def test_an_empty_stream_is_one_label_for_any_number_of_elements() -> None:
    for count in (0, 1, 300_000):
        assert not labels.decode_labels(b"", alone(count)).any()
        assert labels.encode_labels(alone(count), np.zeros(count, dtype=np.int64)) == b""
