"""A folder of many small meshes, made from a few large ones: something for `deltamesh batch` to do.

Meshes are cut in halves along their longest side until no piece has too many faces, and pieces
into their components. Copies of these with noise make up the number.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice
from pathlib import Path

import click
import corpus
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csgraph

from deltamesh._graph.halfedges import weld
from deltamesh._measures.metrics import diagonal
from deltamesh._mesh import TriangleMesh
from deltamesh_formats.meshfiles.files import write_mesh
from deltamesh_formats.polymesh.mesh import from_triangles

# A scan in full, formats in turn: text and binary, with shared vertices and without.
_FORMATS = ("ply", "obj", "stl", "off", "glb")

# A tenth of the default step, over the diagonal: the copies differ, but not in character.
_NOISE = 1e-4

_EXAMPLES = """\
python benchmarks/make_folder.py /tmp/many
python benchmarks/make_folder.py /tmp/few --count 20 --faces 2000 torus.ply
deltamesh batch -r /tmp/many --output-dir-mirror /tmp/packed -j 0"""


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("folder", type=click.Path(path_type=Path))
@click.argument("meshes", nargs=-1, type=click.Path(path_type=Path, exists=True))
@click.option("--count", "wanted", default=500, show_default=True, help="How many meshes to make.")
@click.option(
    "--faces", default=16000, show_default=True, help="The most faces that a mesh may have."
)
@click.option(
    "--least", default=200, show_default=True, help="The fewest faces that a mesh may have."
)
@click.option("--seed", default=7, show_default=True, help="Seed of the noise.")
def command(
    folder: Path, meshes: tuple[Path, ...], wanted: int, faces: int, least: int, seed: int
) -> None:
    """Make FOLDER and meshes in it, from MESHES or else from those that are benchmarked.

    The same meshes give the same folder, byte for byte.
    """
    names = meshes or [corpus.path(name) for name in corpus.chosen((), quick=False)]
    parts = [part for name in names for part in pieces(corpus.read(name), faces, least)]
    if not parts:
        raise click.ClickException("no part of these meshes is a manifold of that size")
    for number, mesh in enumerate(islice(copies(parts, seed), wanted)):
        file_format = _FORMATS[number % len(_FORMATS)]
        # A hundred files a folder, as in a tree that somebody keeps.
        path = folder / f"{number // 100:02}" / f"{number:04}.{file_format}"
        path.parent.mkdir(parents=True, exist_ok=True)
        write_mesh(path, from_triangles(mesh.vertices, mesh.faces))
    click.echo(f"{folder}: {wanted} meshes, of {len(parts)} parts")


def copies(parts: list[TriangleMesh], seed: int) -> Iterator[TriangleMesh]:
    """Yield the parts, and then copies with noise, without end."""
    rng = np.random.default_rng(seed)
    for turn in count():
        for part in parts:
            scale = _NOISE * diagonal(part.vertices) * (turn > 0)
            yield TriangleMesh(
                part.vertices + scale * rng.standard_normal(part.vertices.shape), part.faces
            )


def pieces(mesh: TriangleMesh, most: int, least: int) -> Iterator[TriangleMesh]:
    """Yield the components of the pieces of a mesh that have `least` to `most` faces."""
    keep, welded = weld(mesh.vertices)
    V, F = mesh.vertices[keep], welded[mesh.faces]
    for piece in halved(V, F, most):
        for component in components(piece):
            if len(component) >= least:
                used, faces = np.unique(component, return_inverse=True)
                yield TriangleMesh(V[used], faces.reshape(component.shape))


def halved(V: NDArray[np.float64], F: NDArray[np.int64], most: int) -> Iterator[NDArray[np.int64]]:
    """Yield faces, int64 (m, 3), cut at the median of their longest side until m <= `most`."""
    if len(F) <= most:
        yield F
        return
    centres = V[F].mean(axis=1)
    order = np.argsort(centres[:, np.argmax(np.ptp(centres, axis=0))], kind="stable")
    for half in np.array_split(order, 2):
        yield from halved(V, F[np.sort(half)], most)


def components(F: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Yield the faces of each component."""
    size = int(F.max(initial=-1)) + 1
    edges = coo_array(
        (np.ones(2 * len(F)), (F[:, :2].ravel("F"), F[:, 1:].ravel("F"))), (size,) * 2
    )
    _, label = csgraph.connected_components(edges, directed=False)
    of_face = label[F[:, 0]]
    for which in np.unique(of_face):
        yield F[of_face == which]


if __name__ == "__main__":
    command()
