"""Bits where they matter: files whose bounds hold on a head, and are wider on the rest.

Of bunny and horse, 15 % of the vertices, the fewest edges away from one on the head, have
importance 1, the others less. Each file is beside that of the same bounds everywhere. The camel
head has no importance at all on most of it: figure 4 of Cohen-Or and Sorkine 2006.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import click
import corpus
import numpy as np

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import by_edge, ends
from deltamesh._measures.measure import errors_by_importance
from deltamesh._measures.metrics import diagonal
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh_formats.array_types import Bools, Floats, Ints

_EXAMPLES = """\
python benchmarks/importance.py
python benchmarks/importance.py --mesh bunny --outside 0.25"""

# Where heads are, in the bounding box.
HEADS: Final[Mapping[str, tuple[float, float, float]]] = {
    "bunny": (0.15, 0.75, 0.6),
    "horse": (0.5, 1.0, 0.8),
}
SHARE: Final = 0.15
HEAD = (
    "| mesh | method | importance outside | bytes | STEP | normals inside | outside"
    " | RMS inside | outside |"
)
RULE = "|---|---|--:|--:|--:|--:|--:|--:|--:|"


@dataclass(frozen=True)
class Row:
    """A file: its bytes, those of STEP, normals in degrees, and RMS distances over the diagonal."""

    mesh: str
    method: str
    outside: str
    bytes: int
    step: int
    normals: tuple[float, float]
    rms: tuple[float, float]

    def __str__(self) -> str:
        """Return a row of the table."""
        angles = (f"{one:.2f}" for one in self.normals)
        lengths = (f"{one:.1e}" for one in self.rms)
        names = self.mesh, self.method, self.outside, f"{self.bytes:,}", str(self.step)
        return f"| {' | '.join((*names, *angles, *lengths))} |"


def edges_away(graph: tuple[Ints, Ints], sources: Ints) -> Ints:
    """Return how many edges each vertex is away from the nearest of some, int64 (n,)."""
    indptr, head = graph
    tail = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    found = np.full(len(indptr) - 1, -1, dtype=np.int64)
    found[sources], ring = 0, 0
    while True:
        reached = tail[(found[head] == ring) & (found[tail] < 0)]
        if not len(reached):
            return found
        ring += 1
        found[reached] = ring


def head_of(mesh: TriangleMesh, place: tuple[float, float, float]) -> Bools:
    """Return the vertices around a place in the bounding box, bool (n,)."""
    V = mesh.vertices
    at = V.min(axis=0) + np.array(place) * np.ptp(V, axis=0)
    seed = np.array([np.argmin(np.linalg.norm(V - at, axis=1))])
    away = edges_away(adjacency(mesh.faces, len(V)), seed)
    away[away < 0] = away.max() + 1
    return np.asarray(away <= np.sort(away)[int(SHARE * len(V))])


def row_of(
    name: str, mesh: TriangleMesh, inside: Bools, outside: float, options: Mapping[str, Any]
) -> tuple[Row, Encoded]:
    """Return a file whose importance is 1 inside, and what became of both regions."""
    importance = np.where(inside, 1.0, outside)
    given = None if outside == 1 else importance
    made = encode_mesh(corpus.as_polymesh(mesh), Options(**options, importance=given))
    V, order = mesh.vertices[made.order], made.order
    W, faces = made.mesh.vertices, np.asarray(made.mesh.triangulation().faces)
    full, rest = errors_by_importance(V, faces, W, np.where(inside, 1.0, 0.5)[order])
    extent, sections = diagonal(V), made.container.sections
    step = sections["STEP"].size if "STEP" in sections else 0
    normals = full.normal_deviation, rest.normal_deviation
    lengths = full.rms / extent, rest.rms / extent
    method = made.container.parameters.method
    return Row(name, method, f"{outside:g}", len(made.data), step, normals, lengths), made


def rows_of(name: str, outside: tuple[float, ...]) -> Iterator[Row]:
    """Yield files of a mesh by both methods, at the default bounds on its head."""
    mesh = corpus.bare(name)
    inside = head_of(mesh, HEADS[name])
    for method in ("refined", "highpass"):
        for one in (1.0, *outside):
            yield row_of(name, mesh, inside, one, {"method": method})[0]


def boundary(F: Ints) -> Ints:
    """Return the vertices at edges of one face."""
    a, b = ends(F)
    order, bounds = by_edge(a, b)
    single = order[bounds[:-1][np.diff(bounds) == 1]]
    return np.unique(np.concatenate([a[single], b[single]]))


def hole_of(mesh: TriangleMesh, share: float) -> Bools:
    """Return the vertices that are farther from the boundary than a share of the largest, (n,)."""
    away = edges_away(adjacency(mesh.faces, len(mesh.vertices)), boundary(mesh.faces))
    return np.asarray(away > share * away.max())


def area_of(V: Floats, F: Ints) -> float:
    """Return the area of faces."""
    a, b = V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]
    return float(np.linalg.norm(np.cross(a, b), axis=1).sum() / 2)


@dataclass(frozen=True)
class Hole:
    """A camel head whose front has no bits: its file, and what becomes of the front.

    Attributes
    ----------
    original, mesh : TriangleMesh
        In the order of the file.
    none : bool (n,)
        The vertices without importance.
    bytes, whole : int
        Of the file, and of the one of the same bounds everywhere.
    area : float
        Of the front, over what it was.
    normals : float
        Mean deviation of the rest, in degrees.
    """

    original: TriangleMesh
    mesh: TriangleMesh
    none: Bools
    bytes: int
    whole: int
    area: float
    normals: float

    def __str__(self) -> str:
        """Return a row of the table."""
        count = f"{int(self.none.sum()):,} of {len(self.none):,}"
        cells = (
            count,
            f"{self.bytes:,}",
            f"{self.whole:,}",
            f"{self.area:.2f}",
            f"{self.normals:.2f}",
        )
        return f"| {' | '.join(cells)} |"


HOLE_HEAD = "| vertices without bits | bytes | whole | area of the front | normals of the rest |"
HOLE_RULE = "|---|--:|--:|--:|--:|"
FRONT: Final = 0.25


def hole() -> Hole:
    """Return the camel head without bits but at its neck."""
    mesh = corpus.bare("camelhead")
    none = hole_of(mesh, FRONT)
    whole = len(encode_mesh(corpus.as_polymesh(mesh), Options()).data)
    row, made = row_of("camelhead", mesh, ~none, 0.0, {})
    V, none = mesh.vertices[made.order], none[made.order]
    F, W = np.asarray(made.mesh.triangulation().faces), made.mesh.vertices
    front = F[none[F].all(axis=1)]
    area = area_of(W, front) / area_of(V, front)
    original = TriangleMesh(V, F)
    return Hole(original, TriangleMesh(W, F), none, row.bytes, whole, area, row.normals[0])


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--outside", type=float, multiple=True, default=(0.125, 0.0), show_default=True)
@click.option("--mesh", "names", type=click.Choice(list(HEADS)), multiple=True, metavar="NAME")
def command(outside: tuple[float, ...], names: tuple[str, ...]) -> None:
    """Print bytes and errors of files that are good on a head."""
    click.echo(f"{HEAD}\n{RULE}")
    for name in corpus.present(names or HEADS):
        for row in rows_of(name, outside):
            click.echo(str(row))
    if not names and corpus.path("camelhead").is_file():
        click.echo(f"\n{HOLE_HEAD}\n{HOLE_RULE}\n{hole()}")


if __name__ == "__main__":
    command()
