"""Laplacian editing: some vertices are put somewhere, and the surface follows with its details.

Sources: O. Sorkine, D. Cohen-Or, Y. Lipman, M. Alexa, C. Rössl, H.-P. Seidel, "Laplacian surface
editing", SGP 2004; the two linear systems of Y. Lipman et al., SIGGRAPH 2005 (`poses`). Where a
vertex is put without a rotation, that is what the surface around it does: both are made in turns,
as in O. Sorkine, M. Alexa, "As-rigid-as-possible surface modeling", SGP 2007.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._geometry import rotations
from deltamesh._geometry.poses import two_systems
from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh import laplacian
from deltamesh_formats.array_types import Bools, Floats, Ints

# Weight of the vertices that are put somewhere: they miss it by less than 1e-9 of the diagonal.
WEIGHT = 1e4
# Turns of rotations and positions, where some rotations are not given: after more of them, dihedral
# angles change by a tenth less.
ROUNDS = 8
# Edges around a vertex from which its rotation is taken then.
RINGS = 3


@dataclass(frozen=True)
class Held:
    """Vertices that are put somewhere.

    Attributes
    ----------
    vertices : int64 (h,)
        Each once; every component of the surface has one.
    positions : float64 (h, 3)
    quaternions : float64 (h, 4)
        How they are turned; of any value where that is not given.
    turned : bool (h,)
        Where it is.
    """

    vertices: Ints
    positions: Floats
    quaternions: Floats
    turned: Bools


def deformed(
    graph: Graph,
    vertices: Floats,
    held: Held,
    solver: str = "auto",
    threads: int | None = None,
    memory: float = np.inf,
) -> tuple[Floats, Floats]:
    """Return the surface whose held vertices are where they are put.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
    vertices : float64 (n, 3)
        At rest.
    held : Held
    solver, threads, memory
        See `LeastSquares`.

    Returns
    -------
    float64 (n, 3), (n, 3, 3)
        Positions, and how the neighbourhood of each vertex has turned.

    Raises
    ------
    LimitError, SolveError
    """
    system = LeastSquares(graph, held.vertices, solver, threads, memory, WEIGHT)
    if held.turned.all():
        return two_systems(graph, vertices, system, held.positions, held.quaternions)
    quaternions, unknown = held.quaternions.copy(), ~held.turned
    x = system.solve(laplacian.apply(*graph, vertices), held.positions)
    for _ in range(ROUNDS):
        fitted = rotations.fit(graph, vertices, x, RINGS)[held.vertices[unknown]]
        quaternions[unknown] = rotations.to_quaternions(fitted)
        x, turns = two_systems(graph, vertices, system, held.positions, quaternions)
    return x, turns
