"""SPEC.md against the package, of whole meshes: polygons, parts and words, right and damaged."""

from __future__ import annotations

from dataclasses import replace

import annotated
import forging
import golden_polymeshes
import numpy as np
import polygon_meshes
import pytest
import spec_decoder
import strategies
from hypothesis import given
from hypothesis import strategies as st
from second_opinion import assert_same

from deltamesh import encode
from deltamesh_formats.container import layout
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh

METHODS = ("cartesian", "highpass", "lossless", "refined")


@st.composite
def told_polygons(draw: st.DrawFn) -> PolyMesh:
    mesh = draw(polygon_meshes.soups())
    kinds = draw(st.lists(st.sampled_from(list(layout.KINDS)), unique=True, max_size=2))
    count = len(mesh.sizes)
    return replace(
        mesh,
        parts=tuple(draw(annotated.divisions(kind, count)) for kind in kinds),
        metadata=draw(st.dictionaries(annotated.ANY_TEXT, annotated.NAMES, max_size=2)),
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["torus", "prism", "mixed", "repeated_vertices"])
def test_made_polygons(name: str, method: str) -> None:
    assert_same(encode(polygon_meshes.MADE[name], method=method))


@strategies.FEW
@given(told_polygons(), st.sampled_from(METHODS), st.booleans())
def test_any_whole_mesh(mesh: PolyMesh, method: str, keep: bool) -> None:
    assert_same(encode(mesh, method=method, keep_order=keep))


@strategies.FEW
@given(annotated.annotated_meshes())
def test_any_words_of_triangles(mesh: PolyMesh) -> None:
    assert_same(encode(mesh, method="cartesian"))


def refused(data: bytes) -> bool:
    """Whether the second decoder refuses a file, and for more than its digest."""
    try:
        spec_decoder.decode(data)
    except (ValueError, IndexError) as error:
        return str(error) != "digest"
    return False


@pytest.mark.parametrize("section", ["POLY", "PART", "ORDR"])
@pytest.mark.parametrize(
    "name", ["prism", "mixed", pytest.param("tetrahedra", marks=pytest.mark.slow)]
)
def test_both_decoders_refuse_the_same(name: str, section: str) -> None:
    """Truncated payloads and flipped bits, all checksums right."""
    mesh = golden_polymeshes.with_parts(polygon_meshes.MADE[name])
    data = encode(mesh, method="cartesian", keep_order=True)
    payload = bytes(read_container(data).sections[section].payload)
    rng = np.random.default_rng(len(payload))
    damaged = [payload[:size] for size in rng.integers(0, len(payload), 4)]
    for bit in rng.integers(0, 8 * len(payload), 20).tolist():
        flipped = bytearray(payload)
        flipped[bit // 8] ^= 1 << bit % 8
        damaged.append(bytes(flipped))
    for other in damaged:
        forged = forging.forged(data, **{section: other})
        try:
            consistent = forging.consistent(forged)
        except FormatError:
            assert refused(forged)
        else:
            assert_same(consistent)
