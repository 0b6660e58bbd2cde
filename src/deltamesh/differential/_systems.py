"""Systems that give positions: least squares with anchors of any weight, and Poisson's problem."""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._geometry import solve
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.directions import directions, quotient
from deltamesh._geometry.interpolation import Interpolation
from deltamesh._vectors import largest, sides
from deltamesh.differential._graphs import graph_of, rows_of, vertices_of
from deltamesh_formats.array_types import Floats, Ints

if TYPE_CHECKING:
    from deltamesh.differential._graphs import Sparse

# Right-hand sides that the multigrid solver takes at once.
AT_ONCE: Final = 3


class LeastSquares:
    """The rectangular system [L; W S], factored once, for any number of right-hand sides.

    S selects the anchors and W has their weights on its diagonal. O. Sorkine, D. Cohen-Or,
    S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003, section 3, and equations (1)
    and (2) of D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006,
    have the weight 1.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    anchors : int array (k,)
        Vertices whose positions are given, each once; every component needs one.
    weights : float, or float array (k,)
        Positive. An anchor of weight `math.inf` is hard: the surface goes through it, and the
        others are the least squares that this leaves. All rows of L stay in either case.
    solver : {"auto", "core", "rslab", "pardiso", "scipy"}
    memory : float
        Bytes that the factorization may take.

    Attributes
    ----------
    count : int
        Number of vertices.
    anchors : int64 (k,)
    weights : float64 (k,)

    Raises
    ------
    ValueError
        If L is no Laplacian, or anchors or weights are no such lists.
    SolveError
        If a component has no anchor, or the solver is missing or fails.
    LimitError
        If the factorization would take more memory.
    """

    def __init__(
        self,
        L: Sparse,
        anchors: ArrayLike,
        weights: ArrayLike = 1.0,
        *,
        solver: str = "auto",
        memory: float = math.inf,
    ) -> None:
        graph = graph_of(L)
        self.count = len(graph[0]) - 1
        self.anchors = vertices_of(anchors, self.count)
        given = np.asarray(weights, dtype=np.float64)
        if given.shape not in ((), self.anchors.shape) or not (given > 0).all():
            raise ValueError("weights are no positive number, nor one for each anchor")
        self.weights: Floats = np.broadcast_to(given, self.anchors.shape)
        self._system = solve.LeastSquares(
            graph, self.anchors, solver, memory=memory, weights=self.weights
        )

    def solve(self, delta: ArrayLike, positions: ArrayLike) -> Floats:
        """Return argmin |L x - delta|^2 + |W (x[anchors] - positions)|^2, column by column.

        Parameters
        ----------
        delta : float array (n, c)
        positions : float array (k, c)
            In the order of the anchors.

        Returns
        -------
        float64 (n, c)
            In the unit of the positions; errors of rounding are about 1e-14 of the extent.

        Raises
        ------
        ValueError
            If the shapes do not agree, or a number is not finite.
        SolveError
            If the system is too ill-conditioned for double precision.
        """
        rows = rows_of(delta, self.count, "deltas")
        return self._system.solve(
            rows, rows_of(positions, len(self.anchors), "positions", rows.shape[1])
        )

    def normal(self, b: ArrayLike) -> Floats:
        """Return M^-1 b, float64 (n, c), for M = L^T L + S^T W^2 S, without refinement.

        Where anchors are hard, their rows and columns of M are those of the identity.
        """
        return self._system.solve_normal(rows_of(b, self.count, "right-hand sides"))


class Poisson:
    """The square system L_ff x_f = b_f - L_fc x_c, for free vertices f and fixed ones c.

    The rows and columns of the fixed vertices are erased: the surface goes through them, but where
    b is not the Laplacian of a surface that does, they stick out of it. The solver, conjugate
    gradients on multigrid, takes 15 to 40 iterations at any size and memory in proportion to the
    edges. Files with interpolated anchors are decoded by it.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    fixed : int array (k,)
        Vertices that keep their positions, each once; every component needs one.

    Raises
    ------
    ValueError
        If L is no Laplacian, or `fixed` is no such list.
    SolveError
        If a component has no fixed vertex.
    """

    def __init__(self, L: Sparse, fixed: ArrayLike) -> None:
        graph = graph_of(L)
        self.fixed: Ints = vertices_of(fixed, len(graph[0]) - 1)
        _, labels = solve.anchored_components(graph, self.fixed)
        self._system = Interpolation(Cells(graph, labels, self.fixed))

    def solve(self, b: ArrayLike, positions: ArrayLike, tolerance: float = 1e-9) -> Floats:
        """Return x with x[fixed] = positions and (L x)_i = b_i at every free vertex i.

        Parameters
        ----------
        b : float array (n, c)
        positions : float array (k, c)
        tolerance : float
            The most by which a coordinate errs, as a share of the largest side of the box around
            the positions, or of 1 where they are all the same. It is proved, not estimated; where
            doubles cannot keep it, a millionth of the result's largest magnitude may pass.

        Returns
        -------
        float64 (n, c)

        Raises
        ------
        ValueError
            If the shapes do not agree, or a number is not finite.
        SolveError
            If double precision cannot keep that.
        """
        rows = rows_of(b, len(self._system.cells.labels), "right-hand sides")
        columns = rows.shape[1]
        held = rows_of(positions, len(self.fixed), "positions", columns)
        unit = largest(sides(held)) or 1.0
        steps, found = np.full((len(rows), 1), unit), np.empty(rows.shape)
        for at in range(0, columns, AT_ONCE):
            some = slice(at, min(at + AT_ONCE, columns))
            wide = ((0, 0), (0, AT_ONCE - (some.stop - at)))
            given = np.pad(rows[:, some], wide), np.pad(held[:, some], wide)
            x = self._system.solve(*given, steps, tolerance)
            found[:, some] = x[:, : some.stop - at]
        return found


def fitted_positions(
    system: LeastSquares,
    delta: ArrayLike,
    vertices: ArrayLike,
    tolerance: float = 1e-6,
    most: int = 100,
) -> Floats:
    """Return the positions of the anchors that bring the solution nearest to the vertices.

    A decoder solves for whatever positions it is given. With x(c) = x(0) + B c, where column j of B
    is the basis function of anchor j, c = argmin |x(c) - V| is a system of k x k,
    B^T B c = B^T (V - x(0)), solved here by conjugate gradients: two solves an iteration.

    Parameters
    ----------
    system : LeastSquares
        Its anchors are soft.
    delta : float array (n, c)
        What the decoder has; 0 for a least-squares mesh.
    vertices : float array (n, c)
    tolerance : float
        Residual of the k x k system, relative to that of the vertices' own positions.
    most : int
        Iterations after which it ends all the same.

    Returns
    -------
    float64 (k, c)

    Raises
    ------
    ValueError
        If an anchor is hard, or the shapes do not agree.
    SolveError
    """
    if not np.isfinite(system.weights).all():
        raise ValueError("an anchor is hard: its position is not to be fitted")
    V = rows_of(vertices, system.count, "vertices")
    squares = (system.weights**2)[:, None]

    def transposed(r: Floats) -> Floats:
        return np.asarray(squares * system.normal(r)[system.anchors])

    def applied(c: Floats) -> Floats:
        b = np.zeros((system.count, c.shape[1]))
        b[system.anchors] = squares * c
        return system.normal(b)

    c = V[system.anchors]
    r = transposed(V - system.solve(delta, c))
    least = tolerance**2 * (r * r).sum(axis=0)
    for p, product in islice(directions(r, np.copy), most):
        if (product <= least).all():
            break
        image = transposed(applied(p))
        a = quotient(product, (p * image).sum(axis=0))
        c += a * p
        r -= a * image
    return c


def basis_functions(system: LeastSquares, which: ArrayLike | None = None) -> Floats:
    """Return the basis functions f_i of anchors: what all vertices become of a unit at one of them.

    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006, section 4: a
    least-squares mesh is the sum of f_i c_i. Their sum is 1 on every vertex.

    Parameters
    ----------
    system : LeastSquares
    which : int array (j,), optional
        Numbers of anchors, in their order. Default: all.

    Returns
    -------
    float64 (n, j)
    """
    k = len(system.anchors)
    chosen = np.arange(k) if which is None else np.asarray(which, dtype=np.int64)
    return system.solve(np.zeros((system.count, len(chosen))), np.eye(k)[:, chosen])
