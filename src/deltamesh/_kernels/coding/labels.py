"""Labels of elements: most equal that of a neighbour, or continue as labels did before.

See `src/core/labels.c`.
"""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import OK, call, constant, graph, ints_out, number, scratch
from deltamesh_formats.array_types import Ints, Shorts

MODEL = model_of("labels")
SLOTS, MIXERS = MODEL
_FOLLOWERS = constant("DM_FOLLOWERS")


def code_labels(c: Coder, indptr: Shorts, indices: Shorts, labels: Ints) -> int:
    """Code `labels` (n,), filled in when decoding; return how many there are, -1: corrupt.

    They are numbered in the order of their first elements. Neighbours ascend.
    """
    n, seen = len(labels), number()
    status = call(
        "dm_code_labels",
        c.pointer,
        *graph(indptr, indices, n),
        ints_out(labels, n),
        scratch(_FOLLOWERS),
        byref(seen),
    )
    return seen.value if status == OK else -1
