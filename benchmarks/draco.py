"""Our Cartesian method against Draco (github.com/google/draco) at equal quantization bits.

Draco is at its best, compression level 10; both write positions and faces of the same welded mesh
without isolated vertices, on a grid of 2^bits points along the longest side; whole files count.
"""

from __future__ import annotations

import click
import corpus
import numpy as np
from numpy.typing import NDArray

import deltamesh
from deltamesh.topology import weld
from deltamesh_cli.output import table

_EXAMPLES = """\
python benchmarks/draco.py
python benchmarks/draco.py --bits 11 --mesh fandisk --mesh bunny --mesh horse"""

_LEVEL = 10


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
@click.option(
    "--bits",
    type=click.IntRange(1, 30),
    multiple=True,
    default=(10, 11, 12),
    show_default=True,
    help="Quantization bits; may be repeated.",
)
def command(names: tuple[str, ...], quick: bool, bits: tuple[int, ...]) -> None:
    """Compare file sizes with Draco's; needs DracoPy, of the extra `bench`.

    For each number of bits: our bytes, Draco's, and ours over Draco's.
    """
    sizes = {name: [file_sizes(name, one) for one in bits] for name in corpus.chosen(names, quick)}
    heading = [cell for one in bits for cell in (f"{one} bits", "Draco", "ratio")]
    rows = [(name, *_cells(of_mesh)) for name, of_mesh in sizes.items()]
    means = np.exp(np.log([[a / b for a, b in one] for one in sizes.values()]).mean(axis=0))
    last = [cell for mean in means for cell in ("", "", f"{mean:.3f}")]
    click.echo(table([("", *heading), *rows, ("geometric mean", *last)]))


def _cells(sizes: list[tuple[int, int]]) -> list[str]:
    return [cell for a, b in sizes for cell in (str(a), str(b), f"{a / b:.3f}")]


def file_sizes(name: str, bits: int) -> tuple[int, int]:
    """Return the bytes of our file and of Draco's."""
    vertices, faces = welded(name)
    ours = deltamesh.encode(vertices, faces, method="cartesian", bits=bits)
    return len(ours), len(draco(vertices, faces, bits))


def welded(name: str) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a mesh with each position once, and without isolated vertices."""
    mesh = corpus.load(name)
    keep, to = weld(mesh.vertices)
    used, faces = np.unique(to[mesh.faces], return_inverse=True)
    return mesh.vertices[keep][used], faces.reshape(-1, 3)


def draco(vertices: NDArray[np.float64], faces: NDArray[np.int64], bits: int) -> bytes:
    """Return a Draco file of a mesh."""
    try:
        import DracoPy
    except ImportError as error:
        raise click.ClickException("DracoPy is missing: pip install '.[bench]'") from error
    # Its coordinates are float32, those of nearly all mesh files; it asks for uint32 faces.
    points, triangles = vertices.astype(np.float32), faces.astype(np.uint32)
    data: bytes = DracoPy.encode(
        points, triangles, quantization_bits=bits, compression_level=_LEVEL
    )
    return data


if __name__ == "__main__":
    command()
