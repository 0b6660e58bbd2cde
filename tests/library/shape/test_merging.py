"""Section of merged triangles: the twin, and counts that are refused."""

from __future__ import annotations

import forging
import meshes
import numpy as np
import oracle
import polygon_oracle
import pytest
import strategies
from coders import slow_coder
from drafts import merged_of
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import MADE, soups

from deltamesh import decode, encode
from deltamesh._kernels.coding import hidden_edges as kernels
from deltamesh._shape.merging import decode_merged, encode_merged
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh


def counts_of(mesh, merged, candidate):
    explicit = np.count_nonzero((merged >= 0) & (merged != candidate)) // 2
    return int(mesh.sizes.min()), int(mesh.sizes.max()), explicit


@strategies.FEW
@given(soups() | st.sampled_from([MADE[name] for name in ("tetrahedra", "doubled", "mixed")]))
def test_the_payload_is_that_of_the_oracle(mesh: PolyMesh) -> None:
    if (mesh.sizes == 3).all():
        return
    s, merged = merged_of(mesh)
    manifold, reversed_ = s.complex.manifold, s.complex.stitches.reversed
    candidate = s.merge_candidates
    assert candidate.tolist() == polygon_oracle.candidates(
        s.faces.tolist(), len(manifold.faces), manifold.opposite.tolist(), reversed_.tolist()
    )
    least, most, explicit = counts_of(mesh, merged, candidate)
    payload = encode_merged(s.faces, candidate, merged, mesh.sizes)
    header = b"".join(map(write_varint, (len(mesh.sizes), least, most, explicit)))
    twin = polygon_oracle.Merging(s.faces.tolist(), candidate.tolist())
    coder = slow_coder(None, kernels.SLOTS, kernels.MIXERS)
    pairs = {h: int(g) for h, g in enumerate(merged) if g >= 0}
    by_candidate = {h: g for h, g in pairs.items() if candidate[h] == g}
    twin.code_hidden(coder, by_candidate, least, most, explicit > 0)
    others = {h: g for h, g in pairs.items() if h not in by_candidate}
    assert explicit == 0 or twin.code_explicit_pairs(
        coder, others, most, explicit, oracle.code_below
    )
    assert twin.merged == pairs
    assert payload == header + coder.finish()
    np.testing.assert_array_equal(decode_merged(memoryview(payload), s.faces, candidate), merged)


@pytest.mark.parametrize("name", ["torus", "prism", "tetrahedra", "mixed"])
def test_a_flipped_bit_is_refused_or_another_mesh(name: str) -> None:
    """With all checksums right: whatever is decoded are polygons of the triangles."""
    data = encode(MADE[name], method="cartesian")
    payload = bytes(read_container(data).sections["POLY"].payload)
    refused = 0
    for at in range(8 * len(payload)):
        damaged = bytearray(payload)
        damaged[at // 8] ^= 1 << at % 8
        forged = forging.forged(data, POLY=bytes(damaged))
        with pytest.raises(FormatError):  # the digest, if nothing else
            decode(forged)
        try:
            consistent = forging.consistent(forged)
        except FormatError:
            refused += 1
        else:
            assert (decode(consistent).sizes - 2).sum() == (MADE[name].sizes - 2).sum()
    assert refused


@pytest.mark.parametrize(
    "counts",
    [
        (0, 4, 4, 0),
        (144, 3, 3, 0),  # as many as triangles
        (71, 4, 4, 0),
        (72, 2, 4, 0),
        (72, 5, 4, 0),
        (72, 4, 1 << 40, 0),
        (72, 4, 4, 73),
        (72, 4, 4, 1),
        (72, 3, 4, 0),
        (72, 4, 5, 0),
    ],
)
def test_counts_that_are_wrong_are_refused(counts: tuple[int, ...]) -> None:
    data = encode(MADE["torus"], method="cartesian")
    payload = bytes(read_container(data).sections["POLY"].payload)
    header = b"".join(map(write_varint, counts))
    assert payload[:4] == bytes([72, 4, 4, 0])
    with pytest.raises(FormatError, match="POLY"):
        decode(forging.forged(data, POLY=header + payload[4:]))


def test_polygons_of_nothing_are_refused() -> None:
    V, F = meshes.torus(9, 8)
    data = encode(V, F, method="cartesian")
    with pytest.raises(FormatError, match="POLY"):
        decode(forging.forged(data, POLY=b"".join(map(write_varint, (len(F), 3, 3, 0)))))
