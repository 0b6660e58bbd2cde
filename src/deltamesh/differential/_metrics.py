"""Metrics of positions: what `encode` keeps within bounds, of arrays."""

from __future__ import annotations

from numpy.typing import ArrayLike

from deltamesh._measures import metrics
from deltamesh._measures.metrics import VertexErrors
from deltamesh.differential._graphs import integers_of, rows_of
from deltamesh_formats.errors import OptionError


def diagonal(V: ArrayLike) -> float:
    """Return the length of the diagonal of the bounding box of vertices (n, 3), 0 without any.

    Raises
    ------
    OptionError
        If they have another shape, or a number that is not finite.
    """
    return metrics.diagonal(rows_of(V, None, "vertices", 3))


def vertex_errors(V: ArrayLike, W: ArrayLike, F: ArrayLike) -> VertexErrors:
    """Return the errors of positions: of distances, face normals and dihedral angles.

    Parameters
    ----------
    V, W : float array (n, 3)
        Reference and other positions.
    F : int array (m, 3)

    Raises
    ------
    OptionError
        If the shapes do not agree, or a face names a vertex that is not there.
    """
    first = rows_of(V, None, "reference vertices", 3)
    second = rows_of(W, len(first), "other vertices", 3)
    faces = integers_of(F, "faces")
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise OptionError(f"faces have shape {faces.shape}, not (m, 3)")
    return metrics.vertex_errors(first, second, faces)
