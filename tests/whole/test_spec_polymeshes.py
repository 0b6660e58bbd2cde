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
from converted_numbers import KINDS, as_single, walk
from hypothesis import given
from hypothesis import strategies as st
from second_opinion import assert_same

from deltamesh import encode
from deltamesh._streams.exact import unpack_formats
from deltamesh_formats.container import payload_layout
from deltamesh_formats.container.attribute_table import entries_of
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

METHODS = ("cartesian", "highpass", "lossless", "refined")


@st.composite
def told_polygons(draw: st.DrawFn) -> PolyMesh:
    mesh = draw(polygon_meshes.soups())
    kinds = draw(st.lists(st.sampled_from(list(payload_layout.KINDS)), unique=True, max_size=2))
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


@pytest.mark.parametrize("kind", ["12 bits", "* 25.4", "* 25.4, float64", "near 25.4"])
def test_converted_attributes(kind: str) -> None:
    """Exact texture coordinates have the conversions of positions, for fewer bytes."""
    mesh = polygon_meshes.quads(14, 14)
    decimals = np.stack([walk(len(mesh.vertices), seed).round(3) for seed in (1, 2)], axis=1)
    single, function = KINDS[kind.replace("near", "*")]
    values = function(as_single(decimals) if single else decimals)
    values = values.astype("f4" if single else "f8")
    if kind not in KINDS:
        values[::9] = np.nextafter(values[::9], np.float32(np.inf))
    values[5, 0], values[6, 1] = np.nan, -0.0
    sizes = []
    noise = np.random.default_rng(1).normal(size=values.shape) / 1000
    for some in (values, (values * (1 + noise)).astype(values.dtype)):
        whole = replace(mesh, attributes=(Attribute("uv", "vertex", some, role="uv"),))
        data = encode(whole, method="cartesian", lossless_attributes=True)
        assert_same(data)
        sizes.append(read_container(data).sections["ATTR"].size)
    assert sizes[0] < 0.8 * sizes[1]
    entries = entries_of(read_container(data))
    assert [entry.coding for entry in entries] == ["exact"]


@pytest.mark.parametrize("kind", ["- mean", "12 bits in float64", "off"])
def test_both_decoders_refuse_the_same_conversions(kind: str) -> None:
    """Flipped bits of the operations, of the formats and of both streams, all checksums right."""
    mesh = polygon_meshes.quads(7, 7)
    V = np.stack([walk(len(mesh.vertices), seed).round(3) for seed in range(3)], axis=1)
    V = as_single(25.4 * V) if kind == "off" else KINDS[kind][1](as_single(V))
    if kind == "off":
        V[::7] = np.nextafter(V[::7].astype("f4"), np.float32(np.inf))
    data = encode(replace(mesh, vertices=V), method="lossless")
    payload = bytes(read_container(data).sections["EXAC"].payload)
    _, columns, at = unpack_formats(memoryview(payload))
    assert all(column.conversion.operations for column in columns)
    assert any(column.conversion.deviations for column in columns) == (kind == "off")
    bits = np.random.default_rng(at).integers(8 * at, 8 * len(payload), 12).tolist()
    agreed = 0
    for bit in [*range(0, 8 * at, 17), *bits]:
        flipped = bytearray(payload)
        flipped[bit // 8] ^= 1 << bit % 8
        forged = forging.forged(data, EXAC=bytes(flipped))
        try:
            consistent = forging.consistent(forged)
        except FormatError:
            assert refused(forged)
            agreed += 1
        else:
            assert_same(consistent)
    assert agreed > 5


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
