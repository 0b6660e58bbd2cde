"""Wedges of the corners at a point, in a stream and back."""

from __future__ import annotations

import numpy as np
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._kernels.coding import wedges as kernels
from deltamesh._shape.manifold import trivial
from deltamesh._shape.wedges import code_wedges, corners_of
from deltamesh._streams import entropy


@given(strategies.surfaces(), st.integers(1, 5), strategies.SMALL)
def test_wedges_come_back(mesh, count, seed):
    used, F = np.unique(mesh[1], return_inverse=True)
    F = F.reshape(-1, 3)
    opposite = pair_halfedges(F)
    corners = corners_of(F, opposite, trivial(len(used), len(F)), len(used))
    assert sorted(corners.ring.tolist()) == list(range(F.size))
    given_classes = np.random.default_rng(seed).integers(0, count, F.size)
    model = kernels.SLOTS, kernels.MIXERS
    encoder = entropy.encoder(F.size, *model)
    classes = code_wedges(encoder, corners, given_classes)
    payload = entropy.finish(encoder)
    decoder = entropy.decoder(payload, *model)
    decoded = code_wedges(decoder, corners, np.zeros(0, dtype=np.int64))
    entropy.check_end(decoder, 0)
    assert (decoded == classes).all()
    pairs = set(zip(F.ravel().tolist(), given_classes.tolist(), strict=True))
    assert sorted(set(classes.tolist())) == list(range(len(pairs)))
    assert len(set(zip(F.ravel(), given_classes, classes, strict=True))) == len(pairs)
    owner = dict(zip(classes.tolist(), F.ravel().tolist(), strict=True))
    assert [owner[k] for k in sorted(owner)] == sorted(owner.values())
