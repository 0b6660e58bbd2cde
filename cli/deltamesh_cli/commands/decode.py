"""`deltamesh decode`: a `.dmesh` in, a mesh file out."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.failures import each
from deltamesh_cli.meshes import container_of, decoded, note_not_kept, write_mesh_file
from deltamesh_cli.output import print_json, shown
from deltamesh_cli.progress import Stage, progress
from deltamesh_formats.meshfiles.formats import FORMATS, format_of_extension

if TYPE_CHECKING:
    from deltamesh_formats.polymesh.mesh import PolyMesh

# What a file that names no format of its own is written as: binary, exact, read by everything.
_FALLBACK_FORMAT = "ply"

_EXAMPLES = """\
deltamesh decode bunny.ply.dmesh                 writes bunny.ply
deltamesh decode bunny.ply.dmesh bunny.stl
deltamesh decode mesh.dmesh --output-format obj  writes mesh.obj
deltamesh decode upload.dmesh --max-vertices 1000000 --memory 2G
deltamesh decode - --output-format off < mesh.dmesh | wc
"""


@click.command(epilog=options.epilog(_EXAMPLES))
@click.argument("source", type=options.FILE, metavar="IN")
@options.output("IN without .dmesh")
@options.output_format
@options.solver
@options.threads
@options.limits
@options.as_json
@options.verbosity
@options.debug
@options.name_formats
def command(
    source: str,
    target: str | None,
    output: str | None,
    force: bool,
    output_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Rebuild the mesh of a .dmesh file.

    OUT is a mesh file: {formats}. Without OUT it is IN without ".dmesh"; where that has no
    extension of a mesh file, the format is the one that was encoded, and its extension is added.

    OUT gets all that IN holds and its format has a place for: polygons, attributes, names. What it
    has no place for is named in a note on standard error. ply holds attributes of any kind, obj
    objects, groups and materials, glb several placed meshes.

    IN stays as it is. An OUT that exists is overwritten only with -f. "-" is standard input or
    output; from standard input the mesh goes to standard output unless OUT is given.

    A damaged file is refused, and so is one that would need more than --max-vertices or --memory
    allow, before anything is allocated; no OUT is written then.
    """
    target = files.chosen_output(target, output)
    if target is None and source == files.STDIO:
        target = files.STDIO
    if target is None and not source.lower().endswith(files.SUFFIX):
        raise click.UsageError(f"{shown(source)} does not end in {files.SUFFIX}: OUT is needed.")
    known = format_of_extension(files.extension(target or ""))
    if target not in (None, files.STDIO) and output_format is None and known is None:
        raise click.UsageError(f"{shown(str(target))} names no mesh format: use --output-format.")
    files.check_usage(target, as_json)

    def decode(source: str) -> None:
        data = files.read_input(source)
        container = container_of(source, data, "cannot decode")
        stored = container.meta.source if container.meta is not None else ""
        name, file_format = destination(source, target, output_format, stored)
        files.check_output(source, name, force=force, text=FORMATS[file_format].is_text)
        with progress(show_progress, verbose=verbose, quiet=quiet) as stage:
            mesh, lost = decode_into(
                name, file_format, source, data, stage, parameters, force=force
            )
        note_not_kept(name, lost, quiet=quiet)
        if as_json or not (quiet or name == files.STDIO):
            _print_summary(source, name, mesh, file_format, as_json)

    each([source], decode, as_json=as_json)


def decode_into(
    target: str,
    file_format: str,
    source: str,
    data: bytes,
    stage: Stage,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> tuple[PolyMesh, tuple[str, ...]]:
    """Write the mesh of a `.dmesh` file, whose bytes are `data`.

    Returns
    -------
    mesh : PolyMesh
    lost : tuple of str
        Words for what the format of the target has no place for.

    Raises
    ------
    Failure
    """
    mesh = decoded(source, data, stage, **parameters)
    stage("writing")
    return mesh, write_mesh_file(target, mesh, file_format, force=force)


def destination(
    source: str, target: str | None, output_format: str | None, stored: str
) -> tuple[str, str]:
    """Return the name and the format of the output; `stored` is the format that was encoded."""
    name = source[: -len(files.SUFFIX)] if target is None else target
    named = format_of_extension(files.extension(name))
    original = stored if stored in FORMATS else _FALLBACK_FORMAT
    file_format = output_format or (original if named is None else named.name)
    if target is not None or (named is not None and named.name == file_format):
        return name, file_format
    stem = name if named is None else os.path.splitext(name)[0]
    return f"{stem}.{FORMATS[file_format].extensions[0]}", file_format


def _print_summary(
    source: str, target: str, mesh: PolyMesh, file_format: str, as_json: bool
) -> None:
    vertices, faces = len(mesh.vertices), len(mesh.sizes)
    if as_json:
        counts = {"vertices": vertices, "faces": faces}
        print_json({"source": source, "file": target, "format": file_format, **counts})
    else:
        click.echo(f"{shown(source)} -> {shown(target)}: {vertices} vertices, {faces} faces")
