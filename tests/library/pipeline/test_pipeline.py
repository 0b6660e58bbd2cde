"""Pipelines of encoder and decoder: what is kept beside the bytes, and the proof of these."""

from __future__ import annotations

import forging
import numpy as np
import pytest

from deltamesh._decode_options import DecodeOptions
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._options import Options
from deltamesh._pipeline.decoder import decode_mesh, proven_content, read_content
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh._pipeline.proof import proven
from deltamesh_formats.container.reader import read_container, read_prefix
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.arrays import from_arrays

METHODS = ["highpass", "refined", "cartesian", "lossless"]
LIMITS = {"max_vertices": DEFAULT_MAX_VERTICES, "memory": DEFAULT_MEMORY}
BOX = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
CORNERS = np.array([[i // 4, i // 2 % 2, i % 2] for i in range(8)], dtype=float)


def encoded_box(**options: object) -> Encoded:
    return encode_mesh(from_arrays(CORNERS, BOX), Options(**options))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("keep_order", [False, True])
def test_the_encoder_knows_the_mesh_of_the_decoder_and_where_it_comes_from(
    method: str, keep_order: bool
) -> None:
    encoded = encoded_box(method=method, keep_order=keep_order)
    decoded = decode_mesh(encoded.container, DecodeOptions())
    np.testing.assert_array_equal(decoded.corners, encoded.mesh.corners)
    np.testing.assert_allclose(decoded.vertices, encoded.mesh.vertices, atol=1e-9)
    np.testing.assert_allclose(decoded.vertices, CORNERS[encoded.order], atol=0.02)
    for i, first in enumerate(decoded.offsets[:-1]):
        polygon = np.roll(BOX[encoded.face_order[i]], -encoded.rotation[i])
        found = encoded.order[decoded.corners[first : first + 4]]
        np.testing.assert_array_equal(found, polygon)
    if keep_order:
        assert encoded.order.tolist() == list(range(8))
        assert not encoded.rotation.any()


@pytest.mark.parametrize("method", METHODS)
def test_the_content_is_proven_by_its_digest(method: str) -> None:
    data = encoded_box(method=method).data
    assert proven(data) == read_container(data)
    wrong = read_container(forging.forged(data, checksum=bytes(8)))
    assert read_content(wrong, **LIMITS).digest() == read_container(data).digest
    with pytest.raises(FormatError, match="checksum of the decoded integers is wrong") as caught:
        proven_content(wrong, **LIMITS)
    assert caught.value.offset == wrong.sections["CHEK"].offset


def test_a_file_that_does_not_decode_is_not_proven() -> None:
    data = encoded_box(method="cartesian").data
    for wrong in (
        data[:-1],
        forging.forged(data, checksum=bytes(8)),
        forging.forged(data, CART=b""),
    ):
        with pytest.raises(RuntimeError, match="the encoded file cannot be decoded"):
            proven(wrong)


def test_a_prefix_has_no_digest() -> None:
    prefix = read_prefix(encoded_box(method="cartesian").data[:-1])
    assert read_content(prefix, **LIMITS).integers.values.any()
    with pytest.raises(FormatError, match="truncated: section CHEK is missing"):
        proven_content(prefix, **LIMITS)
