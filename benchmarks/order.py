"""What it costs to keep the order of vertices and faces, and what it costs Draco.

An order of n vertices and m faces, each face beginning at one of its corners, is one of n! m! 3^m:
an order without any pattern takes the logarithm of that. Files of ours are Cartesian here, so that
both codecs write the same grid points.
"""

from __future__ import annotations

import math
from pathlib import Path

import click
import corpus

from deltamesh import MeshError
from deltamesh._mesh import TriangleMesh
from deltamesh._options import Options
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh.bench._peers import draco_file
from deltamesh_cli.output import table
from deltamesh_formats.container.reader import read_container

_EXAMPLES = """\
python benchmarks/order.py
python benchmarks/order.py horse.ply bunny.ply"""

_HEADING = (
    *("file", "vertices", "faces", "ORDR", "bits/element", "any order", "share"),
    *("file", "kept", "ratio", "Draco", "kept", "ratio", "Draco kept / ours"),
)


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("files", nargs=-1, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--bits", type=click.IntRange(1, 30), default=12, show_default=True)
def command(files: tuple[Path, ...], bits: int) -> None:
    """Compare file sizes with and without the order, ours and Draco's (extra `bench`).

    Of every mesh file of the mesh folder, or of FILES. What the codec refuses is listed with the
    reason. ORDR is in bytes, with its framing; an element is a vertex or a face; any order is the
    bytes of log2(n! m! 3^m) bits, and the share is that of ORDR in them.
    """
    rows, refused = [], []
    for file in files or corpus.files():
        try:
            rows.append((file.name, *compared(file, bits)))
        except MeshError as error:
            refused.append(f"  {file.name}: {str(error).removeprefix(f'{file}: ')}")
    click.echo(table([_HEADING, *rows]))
    if refused:
        click.echo("\nrefused:\n" + "\n".join(refused))


def compared(file: Path, bits: int) -> tuple[str, ...]:
    """Return the cells of a file.

    Raises
    ------
    MeshError
    """
    mesh = corpus.read(file)
    whole = corpus.as_polymesh(mesh)
    kept = encode_mesh(whole, Options(method="cartesian", bits=bits, keep_order=True))
    free = encode_mesh(whole, Options(method="cartesian", bits=bits))
    size, n, m = read_container(kept.data).sections["ORDR"].size, len(kept.order), len(mesh.faces)
    bound = any_order(n, m)
    ours = len(free.data), len(kept.data)
    # Draco writes the same vertices and faces: welded, in the order of the file.
    same = TriangleMesh(mesh.vertices[kept.order], kept.mesh.triangles)
    draco = [len(draco_file(same, bits, order)) for order in (False, True)]
    return (
        *(
            str(n),
            str(m),
            str(size),
            f"{8 * size / (n + m):.2f}",
            str(bound),
            f"{size / bound:.3f}",
        ),
        *(str(ours[0]), str(ours[1]), f"{ours[1] / ours[0]:.2f}"),
        *(str(draco[0]), str(draco[1]), f"{draco[1] / draco[0]:.2f}", f"{draco[1] / ours[1]:.2f}"),
    )


def any_order(n: int, m: int) -> int:
    """Return the bytes of log2(n! m! 3^m) bits."""
    nats = math.lgamma(n + 1) + math.lgamma(m + 1) + m * math.log(3)
    return math.ceil(nats / math.log(256))


if __name__ == "__main__":
    command()
