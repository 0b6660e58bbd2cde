"""`deltamesh view`: one page that shows a mesh in the browser, beside its original."""

from __future__ import annotations

import webbrowser
from functools import partial
from pathlib import Path
from typing import Any

import click

from deltamesh._progress import Progress
from deltamesh_cli import files, options
from deltamesh_cli.comparing import compare_meshes
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.meshes import LoadedMesh, load_mesh
from deltamesh_cli.output import display_name
from deltamesh_cli.pages import page_of_comparison, page_of_mesh
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE
from deltamesh_formats.remote import is_url

_EXAMPLES = """\
deltamesh view bunny.ply.dmesh                  writes bunny.ply.dmesh.html
deltamesh view bunny.ply.dmesh bunny.ply        with its errors in colours
deltamesh view --no-open -o page.html scan.obj
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("source", type=FILE, metavar="FILE")
@click.argument("original", type=FILE, metavar="[ORIGINAL]", required=False)
@click.option(
    "-o", "--output", type=FILE, metavar="PAGE", help="The file to write.  [default: FILE.html]"
)
@click.option("-f", "--force", is_flag=True, help="Overwrite PAGE if it exists.")
@click.option(
    "--open/--no-open", "opened", default=True, help="Open PAGE in the browser.  [default: open]"
)
@options.input_format
@options.decoding
@options.reporting
def command(
    source: str,
    original: str | None,
    output: str | None,
    force: bool,
    opened: bool,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Show a mesh in the browser, beside its original.

    FILE and ORIGINAL are .dmesh files or mesh files, and may be compressed with gzip or zstandard.
    One page is written that is complete in itself: it holds the meshes as .dmesh files, decodes
    them, and fetches nothing. It can be mailed, or opened years later without a network.

    The page shows flat or smooth surfaces, edges, anchors, colours, texture coordinates as a
    checker, and parts, which can be hidden. With ORIGINAL, both meshes are seen side by side from
    the same place, or in turn, and errors are shown in colours: of distances, of face normals and
    of dihedral angles. Other .dmesh, OBJ and PLY files can be dropped on it.

    If the vertices of both correspond, the page holds the positions of ORIGINAL rounded to a
    millionth of its size; the numbers beside them are of ORIGINAL itself.
    """
    target = output or files.named_after(source, ".html")
    if files.STDIO in (source, original):
        raise click.UsageError("FILE and ORIGINAL are names of files.")

    def view(name: str) -> None:
        files.check_output(name, target, force=force, text=True)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            # The page has all frames; only what is compared is one of them.
            alone = quiet or original is None
            mesh = load_mesh(name, input_format, progress, quiet=alone, **parameters)
            make = partial(page_of_mesh, name)
            if original is not None:
                other = load_mesh(original, input_format, progress, quiet=quiet, **parameters)
                make = partial(_beside, name, original, other)
            with attempt(name, "cannot show"):
                page = interruptible(lambda: make(mesh, progress))
            data = page.encode()
            files.write_output(target, data, force=force)
        files.print_written("page", name, target, len(data), as_json=as_json, quiet=quiet)
        if opened and target != files.STDIO:
            _open(target, quiet)

    process_all_and_exit([source], view, as_json=as_json)


def _beside(
    name: str, original: str, other: LoadedMesh, mesh: LoadedMesh, progress: Progress
) -> str:
    """Return the page of a mesh beside its original."""
    comparison = compare_meshes(other, mesh, progress)
    return page_of_comparison(name, original, comparison, progress)


def _open(target: str, quiet: bool) -> None:
    """Open a page in the browser of the system, if it has one."""
    address = target if is_url(target) else Path(target).resolve().as_uri()
    if not webbrowser.open(address) and not quiet:
        click.echo(f"note: {display_name(target)}: no browser was found to open it", err=True)
