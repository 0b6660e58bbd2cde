"""What a `.dmesh` keeps of mesh files: each encoded, decoded and compared with what was read.

A row a file: bytes before and after, seconds, what the file has beside triangles, and what became
of it. Files that hold no mesh are named with the reason why they are refused.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import click
import corpus

import deltamesh
from deltamesh._compare import likeness
from deltamesh_cli.output import table
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.meshfiles.files import read_mesh
from deltamesh_formats.polymesh.descriptions import describe_attribute
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.printing import printable

_EXAMPLES = """\
python benchmarks/kept.py
python benchmarks/kept.py --keep-order --lossless scans/*.ply"""

_HEADING = ("file", "bytes", "of", "ratio", "s", "beside triangles", "lost")


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("files", nargs=-1, type=click.Path(path_type=Path))
@click.option("--keep-order", is_flag=True, help="Keep the order of vertices and faces.")
@click.option("--lossless", is_flag=True, help="Lose nothing at all.")
def command(files: tuple[Path, ...], keep_order: bool, lossless: bool) -> None:
    """Tell what is kept of FILES; without any, of every mesh of the folder.

    Exits with 1 if anything but what cannot be kept has been lost.
    """
    method = "lossless" if lossless else "auto"
    rows: list[tuple[str, ...]] = []
    wrong: list[str] = []
    for file in files or corpus.files():
        try:
            row, lost = measured(file, method, keep_order)
        except DeltameshError as error:
            reason = str(error).removeprefix(f"{file}: ")
            row, lost = (file.name, "", str(file.stat().st_size), "", "", "", reason), []
        rows.append(row)
        wrong += [f"{file.name}: {word}" for word in lost]
    click.echo(table([_HEADING, *rows]))
    if wrong:
        raise click.ClickException("; ".join(wrong))


def measured(file: Path, method: str, keep_order: bool) -> tuple[tuple[str, ...], list[str]]:
    """Return a row for a file, and words for what should have been kept and was not."""
    before, known = file.stat().st_size, file.suffix[1:].lower()
    mesh = read_mesh(file)
    start = time.perf_counter()
    data = deltamesh.encode(mesh, method=method, keep_order=keep_order, source_format=known)
    middle = time.perf_counter()
    decoded = deltamesh.decode(data)
    end = time.perf_counter()
    lost = list(unlike(mesh, decoded, exact=method == "lossless"))
    seconds = f"{middle - start:.1f} + {end - middle:.1f}"
    sizes = (str(len(data)), str(before), f"{before / len(data):.1f}")
    return (file.name, *sizes, seconds, ", ".join(kept(mesh)), ", ".join(lost)), lost


def kept(mesh: PolyMesh) -> Iterator[str]:
    """Yield words for what a mesh has beside triangles."""
    if (mesh.sizes != 3).any():
        yield f"{len(mesh.sizes)} polygons"
    yield from (printable(describe_attribute(one)) for one in mesh.attributes)
    yield from (f"{len(p.names)} of {p.kind}" for p in mesh.parts)
    yield from (f"{key} ({len(said)})" for key, said in mesh.metadata.items() if said)


def unlike(mesh: PolyMesh, decoded: PolyMesh, exact: bool) -> Iterator[str]:
    """Yield words for what a decoded mesh lacks."""
    found = likeness.corresponding(mesh, decoded, exact)
    pairs = None if found is None else likeness.matched_corners(mesh, decoded, found)
    if pairs is None:
        yield "other faces"
        return
    for one in likeness.differences(mesh, decoded, pairs):
        if one.largest is None:
            yield printable(describe_attribute(one.attribute))
    yield from likeness.other_parts(mesh, decoded, pairs)
    yield from (key for key, said in mesh.metadata.items() if decoded.metadata.get(key) != said)
    if decoded.precision != mesh.precision:
        yield mesh.precision


if __name__ == "__main__":
    command()
