"""What the beginning of a file holds: bytes and errors after each stage of default files.

Each mesh is encoded with the defaults, cut where a stage is reached, and decoded as a prefix. With
`--solutions`, the surface of the coarse deltas is also solved for otherwise: by interpolated
anchors without the vectors of their cells, and with them, which come later in the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import click
import corpus
import numpy as np

import deltamesh
from deltamesh._geometry.deltas import deltas
from deltamesh._geometry.integers import NO_CELLS, NONE
from deltamesh._geometry.positions import solved
from deltamesh._geometry.systems import Systems
from deltamesh._measures.metrics import diagonal, vertex_errors
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.stages import stages_of

_EXAMPLES = """\
python benchmarks/partial.py
python benchmarks/partial.py --mesh bunny --solutions"""

HEAD = "| mesh | stage | bytes | share | RMS | largest | normals | dihedral |"
RULE = "|---|---|--:|--:|--:|--:|--:|--:|"


@dataclass(frozen=True)
class Stage:
    """One stage of a file.

    Attributes
    ----------
    name : str
    bytes : int
        After which it is reached.
    share : float
        Of the whole file.
    mesh : TriangleMesh
    rms, largest : float
        Distances to the vertices of the source, over the diagonal.
    normals, dihedral : float
        Mean deviations, in degrees.
    """

    name: str
    bytes: int
    share: float
    mesh: TriangleMesh
    rms: float
    largest: float
    normals: float
    dihedral: float

    def row(self, mesh: str) -> str:
        """Return a row of the table."""
        cells = f"{self.bytes:,}", f"{100 * self.share:.0f} %", f"{self.rms:.1e}"
        angles = f"{self.normals:.2f}", f"{self.dihedral:.2f}"
        return f"| {' | '.join((mesh, self.name, *cells, f'{self.largest:.1e}', *angles))} |"


def _stage(name: str, size: int, share: float, V: Floats, W: Floats, F: Floats) -> Stage:
    errors, extent = vertex_errors(V, W, F), diagonal(V)
    lengths = errors.rms / extent, errors.max / extent
    return Stage(
        name, size, share, TriangleMesh(W, F), *lengths, errors.normal_deviation, errors.dihedral
    )


def stages_of_mesh(mesh: TriangleMesh) -> Iterator[Stage]:
    """Yield the stages of the default file of a mesh."""
    made = encode_mesh(corpus.as_polymesh(mesh), Options())
    V = mesh.vertices[made.order]
    for name, size in stages_of(made.container).items():
        found = deltamesh.decode(made.data[:size], partial=True).mesh
        yield _stage(name, size, size / len(made.data), V, found.vertices, found.triangles)


def coarse_surfaces(mesh: TriangleMesh) -> Iterator[Stage]:
    """Yield the surface of the coarse deltas, solved for in several ways."""
    made = encode_mesh(corpus.as_polymesh(mesh), Options())
    p, size = made.container.parameters, made.container.sections["DELT"].end
    content = read_content(made.container, 1 << 40, 1 << 50)
    surface, integers = content.structure.surface, content.integers
    V, systems = mesh.vertices[made.order], Systems(surface, memory=math.inf)
    bare = replace(integers, cells=NO_CELLS, units=NONE)
    for name, parameters, known in (
        ("least squares", replace(p, interpolated=False), bare),
        ("interpolated without cells", replace(p, interpolated=True), bare),
        ("interpolated with cells", p, integers),
    ):
        W = solved(deltas(parameters, known), parameters, known, systems, stage=0)
        yield _stage(name, size, size / len(made.data), V, W, np.asarray(surface.faces))


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--solutions", is_flag=True, help="Compare solutions of the coarse deltas, too.")
@corpus.selection
def command(names: tuple[str, ...], quick: bool, solutions: bool) -> None:
    """Print bytes and errors of each stage of the default file of each mesh."""
    click.echo(f"{HEAD}\n{RULE}")
    for name in corpus.chosen(names or ("bunny", "horse") * (not quick), quick):
        mesh = corpus.bare(name)
        for stage in stages_of_mesh(mesh):
            click.echo(stage.row(name))
        for stage in coarse_surfaces(mesh) if solutions else ():
            click.echo(stage.row(name))


if __name__ == "__main__":
    command()
