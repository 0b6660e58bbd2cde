"""`deltamesh render`: a picture of a mesh, or of its errors, without a browser."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.comparing import compare_meshes
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.meshes import LoadedMesh, load_mesh
from deltamesh_cli.output import display_name
from deltamesh_cli.pictures import Look, picture
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE

if TYPE_CHECKING:
    from deltamesh._progress import Progress
    from deltamesh_formats.array_types import Floats

_EXAMPLES = """\
deltamesh render bunny.dmesh                     writes bunny.dmesh.png
deltamesh render bunny.dmesh --error bunny.ply   distances in colours
deltamesh render scan.ply -o scan.png --from 1 0 0.2 --up 0 0 1
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("source", type=FILE, metavar="FILE")
@click.option(
    "-o", "--output", type=FILE, metavar="PICTURE", help="The file to write.  [default: FILE.png]"
)
@click.option("-f", "--force", is_flag=True, help="Overwrite PICTURE if it exists.")
@click.option(
    "--error",
    "original",
    type=FILE,
    metavar="ORIGINAL",
    help="Show how far each vertex is from where it is in this mesh.",
)
@click.option(
    "--size",
    nargs=2,
    type=click.IntRange(16, 8192),
    default=(960, 720),
    show_default=True,
    metavar="W H",
    help="Pixels of the picture.",
)
@click.option(
    "--from",
    "direction",
    nargs=3,
    type=float,
    default=(0.45, 0.35, 1.0),
    show_default=True,
    metavar="X Y Z",
    help="Direction from the mesh to the camera.",
)
@click.option(
    "--up",
    nargs=3,
    type=float,
    default=(0.0, 1.0, 0.0),
    show_default=True,
    metavar="X Y Z",
    help="Direction that points upwards.",
)
@options.input_format
@options.decoding
@options.reporting
def command(
    source: str,
    output: str | None,
    force: bool,
    original: str | None,
    size: tuple[int, int],
    direction: tuple[float, float, float],
    up: tuple[float, float, float],
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Write a picture of a mesh, a PNG, without a browser.

    FILE and ORIGINAL are .dmesh files or mesh files, and may be compressed with gzip or zstandard.
    Colours of vertices are shown. With --error, colours are distances of vertices over the diagonal
    of the bounding box of ORIGINAL, whose vertices have to correspond, in any order; the scale ends
    where the largest 2 % begin.

    PyVista draws the picture, without a display: pip install "deltamesh[view]".
    """
    target = output or files.named_after(source, ".png")
    for name, vector in (("--from", direction), ("--up", up)):
        if not any(vector):
            raise click.UsageError(f"{name} 0 0 0 is no direction.")

    def render(name: str) -> None:
        files.check_output(name, target, force=force)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            mesh = load_mesh(name, input_format, progress, quiet=quiet, **parameters)
            errors = None
            if original is not None:
                other = load_mesh(original, input_format, progress, quiet=quiet, **parameters)
                with attempt(original, f"cannot be compared with {display_name(name)}"):
                    errors = interruptible(lambda: _errors(mesh, other, progress))
            progress("picture")
            with attempt(name, "cannot render"):
                data = picture(mesh.mesh, Look(*size, direction, up), errors)
            files.write_output(target, data, force=force)
        files.print_written("picture", name, target, len(data), as_json=as_json, quiet=quiet)

    process_all_and_exit([source], render, as_json=as_json)


def _errors(mesh: LoadedMesh, original: LoadedMesh, progress: Progress) -> Floats:
    """Return the distance of each vertex from its original, over the diagonal.

    Raises
    ------
    MeshError
        If the vertices do not correspond.
    """
    from deltamesh._measures.metrics import diagonal
    from deltamesh._page.alignment import aligned
    from deltamesh._vectors import safe_lengths
    from deltamesh_formats.errors import MeshError

    match = compare_meshes(original, mesh, progress).match
    if match is None:
        raise MeshError("the vertices do not correspond: the connectivity differs")
    where = aligned(mesh.mesh, match).vertices
    return safe_lengths(mesh.mesh.vertices - where) / (diagonal(original.mesh.vertices) or 1.0)
