"""Coding one label for each element of a mesh; SPEC.md 5.16."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import labels as kernels
from deltamesh._streams import entropy
from deltamesh_formats.errors import FormatError

_Ints = NDArray[np.int64]


def encode_labels(elements: Elements, labels: _Ints) -> bytes:
    """Return the stream of labels that are `numbered`; it is empty if there is one label only.

    Parameters
    ----------
    elements : Elements
    labels : int64 (elements.count,)

    Raises
    ------
    ValueError
        For labels that are not numbered in the order in which they first appear.
    """
    coder = entropy.encoder(elements.count, kernels.SLOTS, kernels.MIXERS)
    coded = np.array(labels, dtype=np.int64)
    seen = kernels.code_labels(coder, elements.indptr, elements.indices, coded)
    if seen < 0 or not np.array_equal(coded, labels):
        raise ValueError("the labels are not numbered in the order of their first elements")
    return entropy.finish(coder)


def decode_labels(payload: bytes | memoryview, elements: Elements) -> _Ints:
    """Return the labels, int64 (elements.count,): the mirror of `encode_labels`.

    Raises
    ------
    FormatError
        If no encoder has written the stream; the offset counts from its beginning.
    """
    coder = entropy.decoder(payload, kernels.SLOTS, kernels.MIXERS)
    labels = np.zeros(elements.count, dtype=np.int64)
    if kernels.code_labels(coder, elements.indptr, elements.indices, labels) < 0:
        raise FormatError("a label that was passed over as that of a neighbour", 0)
    entropy.check_end(coder, 0)
    return labels
