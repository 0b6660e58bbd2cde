"""Labels, as the kernel and its twin code them."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import strategies
from coders import slow_coder
from elements_of import of_faces, rows
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import labels as kernels
from deltamesh._streams import entropy, labels
from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.permutations import numbered


def twin_of(data: bytes | None) -> oracle.RangeCoder:
    return slow_coder(data, kernels.SLOTS, kernels.MIXERS)


CASES = st.tuples(
    st.sampled_from([meshes.icosphere(1)[1], meshes.grid(6, 5)[1], meshes.crossing()[1]]),
    st.lists(st.integers(0, 6), min_size=1, max_size=9),
    st.sampled_from([0.0, 0.1, 0.5]),
    strategies.SMALL,
)


@strategies.FEW
@given(CASES)
def test_labels_equal_their_oracle(case: tuple[Ints, list[int], float, int]) -> None:
    F, cycle, share, seed = case
    these = of_faces(F)
    rng = np.random.default_rng(seed)
    values = np.resize(np.array(cycle), these.count)
    values = np.where(rng.random(these.count) < share, rng.integers(0, 40, these.count), values)
    wanted, _ = numbered(values)
    twin = twin_of(None)
    assert oracle.code_labels(twin, rows(these), wanted.tolist()) == wanted.tolist()
    assert labels.encode_labels(these, wanted) == twin.finish()


@strategies.FEW
@given(st.binary(max_size=60), st.sampled_from([0x00, 0x55, 0xFF]), st.integers(0, 100))
def test_any_bytes_are_the_labels_of_the_oracle(data: bytes, filler: int, more: int) -> None:
    data += bytes([filler]) * more
    these = of_faces(meshes.icosphere(1)[1])
    found = np.zeros(these.count, dtype=np.int64)
    decoder = entropy.decoder(data, kernels.SLOTS, kernels.MIXERS)
    seen = kernels.code_labels(decoder, these.indptr, these.indices, found)
    twin = twin_of(data)
    expected = oracle.code_labels(twin, rows(these), [0] * these.count)
    assert (seen < 0) == (expected is None)
    if expected is not None:
        assert found.tolist() == expected
        assert seen == max(expected) + 1
        assert decoder.registers.code == twin.code
