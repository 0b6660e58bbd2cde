"""Labels of the elements of a mesh; SPEC.md 5.16."""

from __future__ import annotations

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding import labels as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import FormatError


def encode_labels(elements: Elements, labels: Ints) -> bytes:
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
    coded = np.array(labels, dtype=np.int64)

    def run(coder: Coder) -> None:
        seen = kernels.code_labels(coder, elements.indptr, elements.indices, coded)
        if seen < 0 or not np.array_equal(coded, labels):
            raise ValueError("the labels are not numbered in the order of their first elements")

    return encode_with(kernels.MODEL, elements.count, run)


def decode_labels(payload: bytes | memoryview, elements: Elements) -> Ints:
    """Return the labels, int64 (elements.count,): the mirror of `encode_labels`.

    Raises
    ------
    FormatError
        If no encoder has written the stream; the offset counts from its beginning.
    """

    def run(coder: Coder) -> Ints:
        labels = np.zeros(elements.count, dtype=np.int64)
        if kernels.code_labels(coder, elements.indptr, elements.indices, labels) < 0:
            raise FormatError("non-canonical label: a candidate was skipped", 0)
        return labels

    return decode_with(kernels.MODEL, payload, run)
