"""Files of one mesh under several codecs, as a page holds them: of the same vertices."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from deltamesh._codec.decoding import decode
from deltamesh._codec.encoding import encode
from deltamesh._page.filling import PageFile
from deltamesh.bench._peers import Coded
from deltamesh_formats.array_types import Floats, Ints

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.mesh import PolyMesh

# Bits of a coordinate where positions are on no grid: those of originals in other pages.
_BITS: Final = 20


class Views:
    """Files of a mesh, in the order of vertices of the first `.dmesh` that was made of it.

    Parameters
    ----------
    name : str
        What the page calls the original.
    size : int
        Bytes of its file.
    """

    def __init__(self, name: str, size: int) -> None:
        self.name, self.size = name, size
        self.mesh: PolyMesh | None = None
        self.reference: Floats = np.empty((0, 3))

    def file(self, label: str, coded: Coded) -> PageFile | None:
        """Return what a codec has made of the mesh as a page holds it, None where it cannot.

        A `.dmesh` is held as it is, the mesh of another codec as a `.dmesh` on the same grid.
        """
        if coded.data:
            if self.mesh is None:
                self.mesh, self.reference = decode(coded.data), coded.reference.vertices
            return PageFile(label, coded.data, "", len(coded.data))
        if self.mesh is None or not coded.step:
            return None
        order = rows_in(coded.reference.vertices, self.reference)
        if order is None:
            return None
        data = self._held(coded.decoded.vertices[order], step=coded.step)
        return PageFile(label, data, "", coded.size)

    def original(self) -> PageFile | None:
        """Return the original as a page holds it, None where no codec has coded it."""
        if self.mesh is None:
            return None
        return PageFile(self.name, self._held(self.reference, bits=_BITS), "original", self.size)

    def _held(self, positions: Floats, **grid: Any) -> bytes:
        assert self.mesh is not None
        mesh = replace(self.mesh, vertices=positions, margin=0.0, metadata={}, lost=())
        return encode(mesh, method="cartesian", keep_order=True, **grid)


def rows_in(rows: Floats, others: Floats) -> Ints | None:
    """Return the row (n, 3) of each of other rows, int64 (n,), None if they are not the same rows.

    Equal rows may stand for each other.
    """
    if rows.shape != others.shape:
        return None
    order, other = np.lexsort(rows.T), np.lexsort(others.T)
    if not np.array_equal(rows[order], others[other]):
        return None
    found = np.empty(len(rows), dtype=np.int64)
    found[other] = order
    return found
