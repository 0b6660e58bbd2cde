"""Errors of written files over their bounds: every output format, source type, bound and offset.

Meshes are read, cut into triangles, scaled to a size of about 1 and moved away from the origin.
They are written as a source of each type, encoded within a bound, decoded, written in each format
and read again, and the error against the source is divided by the bound. A share above 1 is right
only where the format says so itself: binary STL and GLB, which have nothing but float32, describe
what they lose.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain
from typing import Final, NamedTuple

import click
import corpus
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import deltamesh
from deltamesh._geometry.bounds import bounds_of
from deltamesh._measures.measure import Measure
from deltamesh._measures.parts import parts_of
from deltamesh._options import Options
from deltamesh._shape.complexes import distinct_faces
from deltamesh_cli.output import table
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.meshfiles.files import read_mesh, written
from deltamesh_formats.meshfiles.formats import FORMATS
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

OFFSETS: Final = (0.0, 1e3, 4e6)
BOUNDS: Final[dict[str, dict[str, float | str]]] = {
    "lossless": {"method": "lossless"},
    "max 1e-3": {"max_error_rel": 1e-3},
    "max 1e-6": {"max_error_rel": 1e-6},
    "quality 5": {},
}

# Of the largest coordinate: what float64 may lose where a node of a GLB turns positions.
NOISE: Final = 2.0**-50

_EXAMPLES = """\
python benchmarks/written.py
python benchmarks/written.py --meshes 50 --vertices 2000"""


class Case(NamedTuple):
    """A file that was written: its error over the bound, and whether it says that it lost more."""

    source: str
    bound: str
    target: str
    share: float
    named: bool


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--meshes", "count", type=int, default=50, show_default=True, metavar="N")
@click.option(
    "--vertices",
    "most",
    type=int,
    default=3000,
    show_default=True,
    metavar="N",
    help="Take a patch of this many vertices, at most, of each mesh.",
)
def command(count: int, most: int) -> None:
    """Measure what is written of N meshes, the folder's and generated ones."""
    cases: list[Case] = []
    for name, mesh in chosen(count, most):
        click.echo(name, err=True)
        for offset in OFFSETS:
            cases += measured(mesh, offset)
    click.echo(table([*_rows(cases)]))
    silent = [case for case in cases if case.share > 1 and not case.named]
    if silent:
        raise click.ClickException(f"{len(silent)} files lose more than their bound in silence")


def chosen(count: int, most: int) -> Iterator[tuple[str, PolyMesh]]:
    """Yield names and meshes of triangles: those of the folder, and pieces, until there are N."""
    found = chain(_files(most), _generated(most))
    for _, named in zip(range(count), found, strict=False):
        yield named


def _files(most: int) -> Iterator[tuple[str, PolyMesh]]:
    for file in corpus.files():
        try:
            mesh = corpus.read(file)
        except DeltameshError:
            continue
        if not len(mesh.faces):
            continue
        for i, first in enumerate((0, len(mesh.faces) // 2)):
            piece = _piece(mesh.vertices, mesh.faces[first : first + 2 * most])
            if np.ptp(piece.vertices, axis=0).max() > 0:
                yield f"{file.name} {i}", piece
            if len(mesh.faces) <= 2 * most:
                break


def _generated(most: int) -> Iterator[tuple[str, PolyMesh]]:
    """Yield bumpy grids without end, each from another seed."""
    side = int(most**0.5)
    for seed in range(1000):
        rng = np.random.default_rng(seed)
        i, j = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
        z = rng.uniform(0, 0.2) * np.sin(i / rng.uniform(2, 9)) * np.cos(j / rng.uniform(2, 9))
        V = np.stack([i / side, j / side, z], axis=2).reshape(-1, 3)
        a = (side * i[:-1, :-1] + j[:-1, :-1]).ravel()
        F = np.concatenate(
            [np.stack([a, a + side, a + 1], 1), np.stack([a + 1, a + side, a + side + 1], 1)]
        )
        yield f"grid {seed}", _piece(V + 1e-3 / side * rng.normal(size=V.shape), F)


def _piece(V: Floats, F: Ints) -> PolyMesh:
    used, faces = np.unique(F, return_inverse=True)
    V = V[used] - V[used].mean(axis=0)
    return from_triangles(V / (np.ptp(V, axis=0).max() or 1.0), faces.reshape(-1, 3))


def sources(mesh: PolyMesh, offset: float) -> Iterator[tuple[str, PolyMesh]]:
    """Yield a mesh at an offset as a reader of each type of source returns it."""
    away = np.array([offset, -offset / 2, offset / 3])
    near = mesh.vertices.astype(np.float32).astype(np.float64)
    single = (mesh.vertices + away).astype(np.float32).astype(np.float64)
    yield "float32 ply", _again(replace(mesh, vertices=single, precision="float32"), "ply")
    yield "float64 ply", _again(replace(mesh, vertices=mesh.vertices + away), "ply")
    yield "obj", _again(replace(mesh, vertices=np.round(mesh.vertices + away, 6)), "obj")
    yield "off", _again(replace(mesh, vertices=mesh.vertices + away), "off")
    yield "stl", _again(replace(mesh, vertices=single), "stl")
    matrix = np.eye(4)
    matrix[:3, :3] = 2 * np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    matrix[:3, 3] = away
    placed = replace(
        mesh,
        vertices=near @ matrix[:3, :3].T + away,
        parts=(Parts("object", ("placed",), np.zeros(len(mesh.sizes), np.int64), matrix[None]),),
    )
    yield "glb", _again(placed, "glb")


def _again(mesh: PolyMesh, file_format: str) -> PolyMesh:
    return read_mesh(io.BytesIO(written(mesh, file_format).data), file_format)


def measured(mesh: PolyMesh, offset: float) -> Iterator[Case]:
    """Yield the case of every source, bound and target."""
    for source_name, source in sources(mesh, offset):
        for bound, options in BOUNDS.items():
            try:
                data = deltamesh.encode(source, keep_order=True, **options)  # type: ignore[arg-type]
            except (DeltameshError, ValueError) as error:  # as of a mesh that float32 made a line
                click.echo(f"  {source_name}, {bound}, at {offset:g}: {error}", err=True)
                continue
            decoded = deltamesh.decode(data)
            share = _share_of(source, options)
            for name, write in targets().items():
                back, lost = write(decoded)
                named = any("beyond float32" in words for words in lost)
                yield Case(source_name, bound, name, share(back), named)


def targets() -> dict[str, Callable[[PolyMesh], tuple[PolyMesh, tuple[str, ...]]]]:
    """Return writers that read again what they have written, by the names of their formats."""

    def file(file_format: str) -> Callable[[PolyMesh], tuple[PolyMesh, tuple[str, ...]]]:
        def write(mesh: PolyMesh) -> tuple[PolyMesh, tuple[str, ...]]:
            made = written(mesh, file_format)
            return read_mesh(io.BytesIO(made.data), file_format), made.lost

        return write

    def solid(mesh: PolyMesh) -> tuple[PolyMesh, tuple[str, ...]]:
        named = Parts("object", ("solid",), np.zeros(len(mesh.sizes), np.int64))
        return file("stl")(replace(mesh, parts=(named,)))

    def pyvista(mesh: PolyMesh) -> tuple[PolyMesh, tuple[str, ...]]:
        from deltamesh.plugins.pyvista import from_pyvista, to_pyvista

        return from_pyvista(to_pyvista(mesh)), ()

    def bare_stl(mesh: PolyMesh) -> tuple[PolyMesh, tuple[str, ...]]:
        return file("stl")(replace(mesh, parts=()))

    files = {name: file(name) for name in FORMATS if name != "stl"}
    return {**files, "stl": bare_stl, "text stl": solid, "pyvista": pyvista}


def _share_of(source: PolyMesh, options: dict[str, float | str]) -> Callable[[PolyMesh], float]:
    """Return the measure of a mesh with the triangles of the source: its error over the bound."""
    V, F = source.vertices, source.triangles
    scale = float(np.linalg.norm(np.ptp(V, axis=0)))
    # The encoder and `compare` measure positions, and faces over these, each once.
    _, first, point = np.unique(V, axis=0, return_index=True, return_inverse=True)
    faces = point.ravel()[F]
    faces = faces[distinct_faces(faces)]
    measure = Measure(V[first], faces, parts_of(faces, _components(faces, len(first))))
    bounds = bounds_of(Options(**options), scale)  # type: ignore[arg-type]

    def share(other: PolyMesh) -> float:
        corners = other.vertices[other.triangles].reshape(-1, 3)
        if len(corners) != F.size:
            raise ValueError(f"{len(corners)} corners of {F.size} came back")
        W = V.copy()
        W[F.ravel()] = corners
        largest = float(np.linalg.norm(corners - V[F.ravel()], axis=1).max())
        if bounds is None:
            return 0.0 if largest <= NOISE * np.abs(V).max() else np.inf
        return max(bounds.excess(measure(W[first])), largest / bounds.max)

    return share


def _components(F: Ints, n: int) -> Ints:
    """Return the component of each vertex, -1 for one in no face."""
    pairs = np.concatenate([F[:, :2], F[:, 1:]])
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    used = np.unique(F)
    found = np.full(n, -1)
    found[used] = np.unique(label[used], return_inverse=True)[1]
    return found


def _rows(cases: list[Case]) -> Iterator[tuple[str, ...]]:
    yield "target", "source", "files", *BOUNDS, "named"
    for target in targets():
        for source in dict.fromkeys(case.source for case in cases):
            mine = [case for case in cases if (case.target, case.source) == (target, source)]
            named = sum(case.named for case in mine)
            kept = {
                bound: max(
                    (c.share for c in mine if c.bound == bound and not c.named), default=np.nan
                )
                for bound in BOUNDS
            }
            shares = (f"{share:.4f}" for share in kept.values())
            yield target, source, str(len(mine)), *shares, str(named)


if __name__ == "__main__":
    command()
