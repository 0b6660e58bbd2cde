"""Hidden edges and explicit pairs that no encoder has written, against their twin."""

from __future__ import annotations

import numpy as np
import oracle
import polygon_oracle
import pytest
import strategies
from coders import slow_coder
from drafts import merged_of
from hypothesis import given
from hypothesis import strategies as st
from polygon_meshes import MADE

from deltamesh._kernels.coding import hidden_edges as kernels
from deltamesh._kernels.coding.merged_pairs import code_explicit_pairs
from deltamesh._shape.merging import halfedge_groups
from deltamesh._shape.polygons import merged_polygons
from deltamesh._streams import entropy


@strategies.FEW
@given(
    st.sampled_from(sorted(MADE)),
    st.binary(max_size=60),
    st.sampled_from([0x00, 0x55, 0xFF]),
    st.integers(3, 5),
    st.integers(0, 4),
    st.integers(0, 9),
)
def test_any_bytes_are_the_polygons_of_the_oracle(
    name: str, data: bytes, filler: int, least: int, more: int, total: int
) -> None:
    if name in ("quads", "torus"):
        name = "prism"  # the oracle is slow
    structure, _ = merged_of(MADE[name])
    faces, candidate, most = structure.faces, structure.merge_candidates, least + more
    data = data + bytes([filler]) * 30
    decoder = entropy.decoder(data, kernels.SLOTS, kernels.MIXERS)
    m = len(faces)
    merged, parent, size = np.full(3 * m, -1), np.arange(m), np.full(m, 3)
    corners, count = faces.ravel(), int(faces.max()) + 1
    kernels.code_hidden(
        decoder, corners, count, candidate, merged, parent, size, least, most, total > 0
    )
    twin = polygon_oracle.Merging(faces.tolist(), candidate.tolist())
    coder = slow_coder(data, kernels.SLOTS, kernels.MIXERS)
    twin.code_hidden(coder, {}, least, most, total > 0)
    assert twin.merged == {h: g for h, g in enumerate(merged.tolist()) if g >= 0}
    if total:
        none = np.zeros(0, dtype=np.int64)
        groups = halfedge_groups(faces)
        found = code_explicit_pairs(
            decoder, candidate, none, merged, parent, size, most, total, *groups
        )
        assert found == twin.code_explicit_pairs(coder, {}, most, total, oracle.code_below)
        assert twin.merged == {h: g for h, g in enumerate(merged.tolist()) if g >= 0}
    assert decoder.registers.code == coder.code
    merged_polygons(merged)  # whatever it is, these are polygons


@pytest.mark.parametrize("change", ["exchanged", "twice", "elsewhere"])
def test_half_edges_that_are_not_grouped_are_refused(change: str) -> None:
    structure, _ = merged_of(MADE["tetrahedra"])
    faces, m = structure.faces, len(structure.faces)
    order, group, across, bounds = halfedge_groups(faces)
    several = int(bounds[np.argmax(np.diff(bounds))])  # the first of a group of two or more
    if change == "exchanged":
        order[[several, several + 1]] = order[[several + 1, several]]
    elif change == "twice":
        order[several + 1] = order[several]
    else:
        group[order[several]] = (group[order[several]] + 1) % len(across)
    decoder = entropy.decoder(b"", kernels.SLOTS, kernels.MIXERS)
    merged, none = np.full(3 * m, -1), np.zeros(0, dtype=np.int64)
    forest, groups = (np.arange(m), np.full(m, 3)), (order, group, across, bounds)
    with pytest.raises(ValueError, match="dm_code_explicit_pairs"):
        code_explicit_pairs(
            decoder, structure.merge_candidates, none, merged, *forest, 4, 1, *groups
        )
