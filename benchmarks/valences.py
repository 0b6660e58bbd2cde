"""Bits of the connectivity against the zero-order entropy of the valences.

That entropy is what P. Alliez, M. Desbrun, "Valence-Driven Connectivity Encoding for 3D Meshes",
Eurographics 2001, measure their coder by: what the list of valences costs without any context.
"""

from __future__ import annotations

from pathlib import Path

import click
import corpus
import numpy as np
from numpy.typing import NDArray

from deltamesh import MeshError
from deltamesh._graph.adjacency import adjacency
from deltamesh._options import Options
from deltamesh._pipeline.encoder import Encoded, encode_mesh
from deltamesh_cli.output import table
from deltamesh_formats.container.reader import read_container

_EXAMPLES = """\
python benchmarks/valences.py
python benchmarks/valences.py horse.ply bunny.ply"""

_HEADING = ("file", "vertices", "bytes", "bits/vertex", "entropy", "ratio")


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("files", nargs=-1, type=click.Path(exists=True, dir_okay=False, path_type=Path))
def command(files: tuple[Path, ...]) -> None:
    """Compare the section CONN, all its bytes, with the valence entropy.

    Of every mesh file of the mesh folder, or of FILES. What the codec refuses is listed with the
    reason. Valences are neighbours in the mesh itself, of vertices with a face.
    """
    rows, refused = [], []
    for file in files or corpus.files():
        try:
            rows.append((file.name, *compared(file)))
        except MeshError as error:
            refused.append(f"  {file.name}: {str(error).removeprefix(f'{file}: ')}")
    click.echo(table([_HEADING, *rows]))
    if refused:
        click.echo("\nrefused:\n" + "\n".join(refused))


def compared(file: Path) -> tuple[str, ...]:
    """Return the cells of a file: counts, bits per vertex, entropy, ratio.

    Raises
    ------
    MeshError
    """
    # The geometry does not matter here: the fastest that there is.
    options = Options(method="cartesian", bits=8, drop_isolated=True)
    encoded = encode_mesh(corpus.as_polymesh(corpus.read(file)), options)
    size, n = read_container(encoded.data).sections["CONN"].size, len(encoded.order)
    rate, bound = 8 * size / n, entropy(_valences(encoded))
    ratio = f"{rate / bound:.3f}" if bound else "-"
    return str(n), str(size), f"{rate:.3f}", f"{bound:.3f}", ratio


def _valences(encoded: Encoded) -> NDArray[np.int64]:
    return np.diff(adjacency(encoded.mesh.triangles, len(encoded.order))[0])


def entropy(symbols: NDArray[np.int64]) -> float:
    """Return the zero-order entropy of non-negative integers, in bits each."""
    count = np.bincount(symbols)
    share = count[count > 0] / len(symbols)
    return float(-(share * np.log2(share)).sum()) + 0.0  # not -0.0


if __name__ == "__main__":
    command()
