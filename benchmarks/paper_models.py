"""Meshes on which the paper's statements are measured, in coding order, with their Laplacians."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import corpus
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

import deltamesh
from deltamesh import differential as dc
from deltamesh._mesh import TriangleMesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Made here; all others, but the mesh of the repository, are of the mesh folder.
MADE = ("ball", "two balls", "bar", "fine bar", "coarse sphere", "fine sphere")
# Vertices around and along the bars.
_BARS = {"bar": (24, 55), "fine bar": (48, 110)}
# Subdivisions of icosahedra.
_SPHERES = {"coarse sphere": 4, "fine sphere": 6}


@dataclass(frozen=True)
class Model:
    """A mesh in coding order.

    Attributes
    ----------
    name : str
    V : float64 (n, 3)
    F : int64 (m, 3)
    connectivity : int
        Bytes of its section CONN.
    """

    name: str
    V: Floats
    F: Ints
    connectivity: int

    @cached_property
    def L(self) -> csr_array:
        """The Laplacian."""
        return dc.laplacian(self.F, len(self.V))

    @cached_property
    def delta(self) -> Floats:
        """The differential coordinates L x."""
        return dc.deltas(self.L, self.V)

    @cached_property
    def diagonal(self) -> float:
        """Of the bounding box."""
        return dc.diagonal(self.V)

    @cached_property
    def valences(self) -> Floats:
        """Float64 (n, 1)."""
        return np.asarray(self.L.diagonal())[:, None]

    @cached_property
    def edges(self) -> Ints:
        """Each once, int64 (e, 2)."""
        L = self.L.tocoo()
        return np.stack((L.row, L.col), axis=1)[L.row < L.col]

    @cached_property
    def spectrum(self) -> tuple[Floats, Floats]:
        """All eigenvalues and eigenvectors of L."""
        return dc.eigenvectors(self.L)

    def errors(self, x: Floats) -> dc.VertexErrors:
        """Return the errors of other positions; lengths are over the diagonal."""
        found = dc.vertex_errors(self.V, x, self.F)
        return dc.VertexErrors(
            found.rms / self.diagonal,
            found.max / self.diagonal,
            found.normal_deviation,
            found.dihedral,
        )

    def quantized(self, step: float, diffusion: float) -> Floats:
        """Return the deltas after quantization."""
        return dc.quantized_deltas(self.L, self.delta, step, diffusion) * step

    def hops(self, sources: Ints) -> Floats:
        """Return the number of edges from each vertex to the nearest source, float64 (n,)."""
        return np.asarray(dijkstra(abs(self.L), indices=sources, unweighted=True, min_only=True))


@lru_cache(maxsize=8)
def model(name: str) -> Model:
    """Return a mesh by its name: `corpus.NAMES`, `MADE`, or one of those with " x 4" for Loop's."""
    if name.endswith(" x 4"):
        from trimesh.remesh import subdivide_loop

        coarse = model(name.removesuffix(" x 4"))
        V, F = subdivide_loop(coarse.V, coarse.F, 1)
        return _coded(name, np.asarray(V, np.float64), np.asarray(F, np.int64))
    mesh = source(name)
    return _coded(name, mesh.vertices, mesh.faces)


def source(name: str) -> TriangleMesh:
    """Return a mesh as it is made or in its file."""
    return _made(name) if name in MADE else corpus.bare(name)


def is_there(name: str) -> bool:
    """Tell whether a mesh is made here or found in a file."""
    name = name.removesuffix(" x 4")
    return name in MADE or corpus.path(name).is_file()


def _coded(name: str, V: Floats, F: Ints) -> Model:
    data = deltamesh.encode(V, F, method="lossless")
    mesh, size = deltamesh.decode(data), deltamesh.info(data).sections["CONN"].size
    return Model(name, mesh.vertices, mesh.triangles, size)


def _made(name: str) -> TriangleMesh:
    if name in _BARS:
        return bar(*_BARS[name])
    if name in _SPHERES:
        return _sphere(_SPHERES[name])
    V, F = _ball(3)
    if name == "ball":
        return TriangleMesh(V, F)
    W, G = _ball(1)
    return TriangleMesh(np.concatenate((V, W + 3)), np.concatenate((F, G + len(V))))


def _sphere(levels: int) -> TriangleMesh:
    """Return a sphere of 10 * 4^levels + 2 vertices."""
    from trimesh.creation import icosphere

    made = icosphere(subdivisions=levels)
    return TriangleMesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))


def _ball(levels: int) -> tuple[Floats, Ints]:
    """Return a sphere with bumps."""
    mesh = _sphere(levels)
    V, F = mesh.vertices, mesh.faces
    bumps = np.sin(7 * V[:, 0] + 1) * np.sin(6 * V[:, 1] + 2) * np.sin(5 * V[:, 2] + 3)
    return V * (1 + 0.1 * bumps[:, None]), F


def bar(around: int, along: int) -> TriangleMesh:
    """Return an open tube with bumps, of length 6 in z."""
    angle = np.arange(around) / around * 2 * np.pi
    T, Z = np.meshgrid(angle, np.linspace(0, 6, along))
    radius = 0.7 + 0.05 * np.cos(6 * T) * np.sin(5 * Z)
    V = np.stack((radius * np.cos(T), radius * np.sin(T), Z), axis=2).reshape(-1, 3)
    i = np.arange((along - 1) * around)
    right = i + 1 - around * ((i + 1) % around == 0)
    lower = np.stack((i, right, right + around), axis=1)
    upper = np.stack((i, right + around, i + around), axis=1)
    return TriangleMesh(V, np.concatenate((lower, upper)))
