"""Memory of factorizations, foreseen from where the entries of a matrix are.

Factors of surfaces have some hundred entries an unknown, those of random graphs a share of all
pairs. So each solver counts the entries, and refuses what would take more memory than it may,
before any number is computed.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from deltamesh._kernels.mesh import elimination
from deltamesh_formats.array_types import Ints
from deltamesh_formats.errors import LimitError

if TYPE_CHECKING:
    import scipy.sparse as sparse

# Bytes an entry, measured as peaks of whole processes (`benchmarks/memory.py`): of a matrix beside
# the plan of rslab, of one for the core, of a triangular factor, and of one by SuperLU, which keeps
# both triangles.
MATRIX_ENTRY: Final = 60
CORE_ENTRY: Final = 16
FACTOR_ENTRY: Final = 8
SUPERLU_ENTRY: Final = 30
# More entries than any factor has.
MOST: Final = 1 << 60
# Unknowns on a mean breadth-first level, over the root of all: below 6 on nearly all surfaces,
# above only on some with hubs, and 35 in a random graph of 20k vertices.
BROAD: Final = 8
# The most by which the fill of our own order may exceed that of amf: it is 1.3 to 2.7 on meshes.
WORSE: Final = 4


def check_memory(needed: float, memory: float) -> None:
    """Refuse a system that takes more memory than there may be.

    Raises
    ------
    LimitError
    """
    if needed > memory:
        raise LimitError(
            "the edges are not those of a surface: solving for the positions takes more than the"
            f" limit of {memory / 2**20:.0f} MiB"
        )


def pattern(matrix: sparse.csr_array) -> tuple[Ints, Ints]:
    """Return where the entries of a matrix are: its indptr and its indices, int64."""
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64)


def entries_within(memory: float, entry: float = FACTOR_ENTRY) -> int:
    """Return how many entries of so many bytes there may be."""
    return int(min(max(memory, 0) / entry, MOST))


def check_breadth(indptr: Ints, indices: Ints, entry: float, memory: float) -> None:
    """Refuse what is far too large for any order, before one of minimum degree is looked for.

    Those are fast where there are small separators. In a random graph of 20k vertices that of
    SuperLU takes 40 s, and amf 30 s in one of 100k; the time of dissection is bounded.
    """
    broad = BROAD * math.sqrt(len(indptr) - 1)
    if memory < math.inf and elimination.breadth(indptr, indices) > broad:
        order = elimination.dissect(indptr, indices)
        check_fill(indptr, indices, order, entry / WORSE, memory)


def check_fill(indptr: Ints, indices: Ints, order: Ints, entry: float, memory: float) -> None:
    """Refuse an order of elimination whose factor has too many entries of so many bytes."""
    most = entries_within(memory, entry)
    entries = elimination.factor_entries(indptr, indices, order, most)
    check_memory(entry * entries, memory)
