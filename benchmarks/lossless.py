"""Our lossless method against general compressors and Draco without quantization.

All write the same welded mesh without isolated vertices, and whole files count. zstd, at level 19,
and xz are given the arrays: positions as float32 where these hold all of them, else as float64, and
faces as int32. Draco knows float32 only: where that is not exact, it loses what we keep.
"""

from __future__ import annotations

import lzma
from pathlib import Path

import click
import corpus
import numpy as np

import deltamesh
from deltamesh._compare.welding import welded, without_isolated
from deltamesh.bench._peers import ZSTD_LEVEL, draco_file
from deltamesh_cli.output import table
from deltamesh_formats.errors import MeshError
from deltamesh_formats.zstd_frames import frame

_EXAMPLES = """\
python benchmarks/lossless.py
python benchmarks/lossless.py --quick
python benchmarks/lossless.py --mesh bunny --mesh horse"""

_HEADING = ("mesh", "type", "vertices", "bytes", "bits/vertex", "/zstd", "/xz", "/Draco")
# Headers, parameters and checksums take 200 bytes: what a mesh so small compresses to means little.
_FEW = 100


@click.command(epilog=corpus.epilog(_EXAMPLES))
@corpus.selection
def command(names: tuple[str, ...], quick: bool) -> None:
    """Compare lossless file sizes; needs DracoPy, of the extra `bench`.

    Without --mesh or --quick, every manifold of the folder. Ratios are our bytes over theirs; their
    means are those of the meshes of more than 100 vertices. Exits with 1 where one of those is
    larger than what zstd or Draco makes of it.
    """
    files = corpus.files()
    if names or quick:
        files = [corpus.path(name) for name in corpus.chosen(names, quick)]
    rows = [row for row in map(measured, files) if row]
    counted = [row for row in rows if int(row[2]) > _FEW]
    ratios = np.array([[float(cell) for cell in row[5:]] for row in counted])
    means = (
        "geometric mean",
        *[""] * 4,
        *(f"{x:.3f}" for x in np.exp(np.log(ratios).mean(axis=0))),
    )
    click.echo(table([_HEADING, *rows, means]))
    larger = [row[0] for row in counted if max(float(row[5]), float(row[7])) >= 1]
    if larger:
        raise click.ClickException(f"larger than zstd or Draco: {', '.join(larger)}")


def measured(file: Path) -> tuple[str, ...] | None:
    """Return a row for a mesh file; None for what is no manifold."""
    try:
        mesh = without_isolated(welded(corpus.read(file), exact=True))
        V, F = mesh.vertices, mesh.faces
        ours = deltamesh.encode(V, F, method="lossless")
    except MeshError as error:
        click.echo(f"skipped, {file.name}: {str(error).removeprefix(str(file))}", err=True)
        return None
    if sorted(map(bytes, deltamesh.decode(ours).vertices)) != sorted(map(bytes, V)):
        raise click.ClickException(f"{file.name} does not come back as it was")
    with np.errstate(over="ignore"):
        single = bool((V.astype(np.float32) == V).all())
    raw = (V.astype(np.float32) if single else V).tobytes() + F.astype(np.int32).tobytes()
    others = len(frame(raw, ZSTD_LEVEL)), len(lzma.compress(raw)), len(draco_file(mesh, 0))
    rate = f"{8 * len(ours) / len(V):.2f}"
    ratios = (f"{len(ours) / other:.3f}" for other in others)
    kind = "float32" if single else "float64"
    return file.name, kind, str(len(V)), str(len(ours)), rate, *ratios


if __name__ == "__main__":
    command()
