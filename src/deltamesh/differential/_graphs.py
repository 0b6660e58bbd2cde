"""Laplacian of a mesh as a sparse matrix, its products, and the arrays that functions are given."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._graph.adjacency import MOST, Graph, adjacency_between
from deltamesh._graph.adjacency import components as labels_of
from deltamesh._graph.halfedges import ends
from deltamesh._graph.laplacian import laplacian as laplacian_of
from deltamesh._kernels.mesh import laplacian as kernel
from deltamesh_formats.arguments import brief, require, require_whole
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    import scipy.sparse as sparse

    Sparse: TypeAlias = sparse.csr_array


def laplacian(faces: ArrayLike | Sequence[ArrayLike], count: int) -> Sparse:
    """Return the combinatorial Laplacian L = D - A of the graph of a mesh.

    O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003,
    section 3. L is symmetric and positive semi-definite; its rank is the number of vertices less
    that of the components (isolated vertices are components).

    Parameters
    ----------
    faces : int array (m, k), or a sequence of polygons
        Triangles, quads or polygons of any sizes, as `PolyMesh.faces` has them; diagonals are no
        edges. Vertices count from 0.
    count : int
        Number of vertices.

    Returns
    -------
    csr_array, float64 (count, count)
        The valence of vertex i on the diagonal, -1 for each of its neighbours.

    Raises
    ------
    OptionError
        If a face has no three corners, or names a vertex that is not there.
    LimitError
        If there are more edges than 32 bits count.
    """
    require_whole("count", count, 0)
    start, end = _halfedges(faces)
    if len(start) and not 0 <= start.min() <= start.max() < count:
        raise OptionError(f"a face names a vertex outside of 0 to {count - 1}")
    return laplacian_of(*adjacency_between(start, end, count))


def _halfedges(faces: ArrayLike | Sequence[ArrayLike]) -> tuple[Ints, Ints]:
    """Return the vertices at which the half-edges of faces start and end."""
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] >= 3:
        return ends(integers_of(faces, "faces"))
    require(isinstance(faces, Iterable), "faces must be polygons", faces)
    polygons = [integers_of(one, "faces") for one in cast("Sequence[ArrayLike]", faces)]
    for i, polygon in enumerate(polygons):
        if polygon.ndim != 1 or len(polygon) < 3:
            raise OptionError(f"face {i} has no three corners")
    none = np.zeros(0, dtype=np.int64)
    after = [np.roll(polygon, -1) for polygon in polygons]
    return np.concatenate([none, *polygons]), np.concatenate([none, *after])


def deltas(L: Sparse, vertices: ArrayLike) -> Floats:
    """Return the differential coordinates L x: valence times vertex less mean of its neighbours.

    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006, section 2.2,
    divide each row by the valence, `L.diagonal()`; what is solved and quantized is L x itself.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    vertices : float array (n, c)

    Returns
    -------
    float64 (n, c)
        Sums are in the order of a decoder's, bit for bit. The unit is that of the vertices.

    Raises
    ------
    OptionError
        If L is no Laplacian of a graph, or the shapes do not agree.
    """
    graph = graph_of(L)
    return kernel.apply(*graph, rows_of(vertices, len(graph[0]) - 1, "vertices"))


def components(L: Sparse) -> Ints:
    """Return the connected component of each vertex, int64 (n,), from 0 by its lowest vertex."""
    return labels_of(*graph_of(L))


def graph_of(L: Any) -> Graph:
    """Return the neighbours of each vertex, `indptr` and `indices`, of the graph of a Laplacian.

    Raises
    ------
    OptionError
        If L is not D - A for an undirected graph whose edges all weigh 1, or is too large for
        entries of 32 bits.
    """
    import scipy.sparse as sparse

    if not sparse.issparse(L) or L.ndim != 2 or L.shape[0] != L.shape[1]:
        raise OptionError("L is no square sparse matrix")
    A = sparse.csr_array(L, dtype=np.float64)
    A = (sparse.diags_array(A.diagonal()) - A).tocsr()
    A.eliminate_zeros()
    A.sort_indices()
    degrees = np.diff(A.indptr)
    if (A.data != 1).any() or (L.diagonal() != degrees).any() or (A != A.T).nnz:
        raise OptionError("L is not the Laplacian of a graph whose edges all weigh 1")
    if max(A.nnz, A.shape[0]) > MOST:
        raise OptionError(f"{A.nnz} entries of L are too many for 32 bits")
    return A.indptr.astype(np.int32), A.indices.astype(np.int32)


def rows_of(x: ArrayLike, count: int | None, name: str, columns: int | None = None) -> Floats:
    """Return an array of so many rows, of any number if that is None, float64 (count, c).

    Raises
    ------
    OptionError
        If it has another shape, or numbers that are not finite.
    """
    array = numbers_of(x, name)
    fits = array.ndim == 2 and count in (None, len(array)) and columns in (None, array.shape[1])
    if not fits:
        shape = f"({'n' if count is None else count}, {'c' if columns is None else columns})"
        raise OptionError(f"{name} have shape {array.shape}, not {shape}")
    if not np.isfinite(array).all():
        raise OptionError(f"{name} have a number that is not finite")
    return array


def numbers_of(x: ArrayLike, name: str) -> Floats:
    """Return an array of any shape, as float64.

    Raises
    ------
    OptionError
        If it has anything but real numbers.
    """
    try:
        if not np.iscomplexobj(x):
            return np.asarray(x, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError):
        pass
    raise OptionError(f"{name} are not real numbers, but {brief(x)}")


def vertices_of(x: ArrayLike, count: int, name: str = "anchors") -> Ints:
    """Return indices of distinct vertices, int64 (k,).

    Raises
    ------
    OptionError
    """
    array = integers_of(x, name)
    if array.ndim != 1 or (len(array) and not 0 <= array.min() <= array.max() < count):
        raise OptionError(f"{name} are not a list of vertices from 0 to {count - 1}")
    if len(np.unique(array)) != len(array):
        raise OptionError(f"{name} have a vertex twice")
    return array


def integers_of(x: ArrayLike, name: str) -> Ints:
    """Return an array of integers as int64.

    Raises
    ------
    OptionError
        If it has other numbers, such as 2.5, which would be another vertex.
    """
    try:
        array = np.asarray(x)
    except ValueError:  # rows of several lengths
        raise OptionError(f"{name} are no array, but {brief(x)}") from None
    if array.size and array.dtype.kind not in "iu":
        raise OptionError(f"{name} are not integers, but {array.dtype}")
    return np.ascontiguousarray(array, dtype=np.int64)
