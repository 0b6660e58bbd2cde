"""`deltamesh compare`: the differences between two meshes in every metric."""

from __future__ import annotations

import os
from typing import Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.comparing import compare_meshes, comparison_object, comparison_text
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all
from deltamesh_cli.inputs import EITHER, Choice, Input, chosen_files
from deltamesh_cli.meshes import load_mesh
from deltamesh_cli.output import display_name, message, print_json
from deltamesh_cli.pages import page_of_comparison
from deltamesh_cli.pairing import Folder
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE

_METRICS = """\
Metrics, in the unit of A and as a fraction of its bounding box diagonal:
  RMS, max         distances between corresponding vertices
  Hausdorff        symmetric distance between the surfaces, by samples
  visual           0.15 Mq + 0.85 Sq of the papers: position and smoothness
and in degrees:
  face normals     mean deviation, weighted by area
  dihedral angles  mean change over the interior edges
Each attribute of A has its largest difference; normals, the largest angle.
Parts (objects, groups, materials) are alike if the same faces have the same
names."""
_EXAMPLES = """\
deltamesh compare bunny.ply bunny.ply.dmesh
deltamesh compare scan.glb scan.obj     shows the effect of a conversion
deltamesh compare a.ply a.ply.dmesh --html a.html
deltamesh compare -r scans packed       pairs files by name
deltamesh compare --json a.obj b.obj | jq .errors.hausdorff
"""


@click.command(epilog=epilog(_EXAMPLES, _METRICS))
@click.argument("sources", type=FILE, metavar="[A]...", nargs=-1)
@click.argument("second", type=FILE, metavar="B")
@chosen_files
@click.option(
    "--html",
    "page",
    type=FILE,
    metavar="PAGE",
    help="Write a page that shows both in the browser, with errors in colours, as deltamesh view"
    " does.",
)
@click.option("-f", "--force", is_flag=True, help="Overwrite PAGE if it exists.")
@options.input_format
@options.decoding
@options.reporting
def command(
    sources: tuple[str, ...],
    second: str,
    choice: Choice,
    page: str | None,
    force: bool,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Measure how far mesh B is from mesh A.

    Each is a mesh file or a .dmesh file, and may be compressed with gzip or zstandard. Attributes
    and parts are compared face by face as well. Parts are reported even if only B has them,
    attributes only if A has them.

    The order of vertices and faces does not matter, nor do repeated positions and isolated
    vertices: each position and each face counts once. If the vertices still do not correspond
    because the connectivity differs, only the distance between the surfaces is measured.

    If B is a folder, each A is compared with the file of its name in B: scan.ply with scan.ply,
    with scan.ply.dmesh or, if neither is there, with scan.dmesh or scan.obj. An A that is a folder
    stands for the mesh files and the .dmesh files in it, whose paths in A and in B agree. A file
    without a counterpart in B is a failure. --include and --exclude choose among the files of A.
    """
    if second == files.STDIO and files.STDIO in sources:
        raise click.UsageError("A and B cannot both be standard input.")
    if not (sources or choice.lists):
        raise click.UsageError("A is missing: two files or folders are compared.")
    folder = Folder(second, recursive=choice.recursive) if os.path.isdir(second) else None
    inputs = choice.inputs(sources, EITHER)
    if folder is None and (len(inputs) > 1 or any(one.in_folder for one in inputs)):
        raise click.UsageError(f"Many files are given to compare: {second} has to be a folder.")
    if folder is not None and page is not None:
        raise click.UsageError("--html is for two files, not for folders.")
    paired: list[str] = []

    def compare_one(one: Input) -> None:
        name = one.checked()
        other = second if folder is None else folder.counterpart(one)
        paired.append(other)
        if page is not None:
            files.check_output(name, page, force=force, text=True)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            a = load_mesh(name, input_format, progress, quiet=quiet, **parameters)
            b = load_mesh(other, input_format, progress, quiet=quiet, **parameters)
            with attempt(other, f"cannot compare with {display_name(name)}"):
                comparison = interruptible(lambda: compare_meshes(a, b, progress))
            if page is not None:
                with attempt(other, "cannot show"):
                    text = page_of_comparison(other, name, comparison, progress)
                files.write_output(page, text.encode(), force=force)
        if as_json:
            print_json(comparison_object(name, other, comparison))
        elif not quiet:
            click.echo(comparison_text(name, other, comparison) + "\n" * (len(inputs) > 1))

    code = process_all(inputs, compare_one, as_json=as_json)
    if folder is not None and not (quiet or choice.include or choice.exclude):
        _note_unpaired(folder, paired)
    click.get_current_context().exit(code)


def _note_unpaired(folder: Folder, paired: list[str]) -> None:
    """Note on standard error the files of B that no A has the name of."""
    if others := folder.without(paired):
        text = f"in no A: {len(others)} files, the first {display_name(others[0])}"
        message(f"note: {display_name(folder.path)}: {text}")
