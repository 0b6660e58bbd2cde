"""`deltamesh decode`: a `.dmesh` file becomes a mesh file."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.decoding import decode_to_file, output_name_and_format
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.meshes import note_not_kept, note_prefix, parse_container
from deltamesh_cli.output import display_name, print_json
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.sequences import NumberedFiles, decode_all_to_files
from deltamesh_cli.summary import stage_object
from deltamesh_cli.value_types import FILE, whole
from deltamesh_formats.meshfiles.formats import FORMATS, written_format

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh

_EXAMPLES = """\
deltamesh decode bunny.ply.dmesh                 writes bunny.ply
deltamesh decode bunny.ply.dmesh bunny.stl
deltamesh decode mesh.dmesh --output-format obj  writes mesh.obj
deltamesh decode scan.ply.dmesh scan.obj --digits 3
deltamesh decode walk.dmesh pose.obj --frame 12
deltamesh decode walk.dmesh walk_%03d.ply --all  writes walk_000.ply ...
deltamesh decode bar.dmesh bent.obj --pose bent
deltamesh decode upload.dmesh --max-vertices 1000000 --memory 2G
deltamesh decode - --output-format off < mesh.dmesh | wc
head -c 20000 scan.dmesh | deltamesh decode - preview.ply --partial
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("source", type=FILE, metavar="IN")
@options.output("IN without .dmesh")
@click.option(
    "--frame",
    type=whole(0),
    metavar="N",
    help="Decode frame N of a sequence, from 0.  [default: 0]",
)
@click.option(
    "--all",
    "all_frames",
    is_flag=True,
    help="Decode all frames of a sequence, each into a file; OUT has %d or %04d for its number, or"
    " is a folder.",
)
@click.option("--pose", metavar="NAME", help="Decode the mesh in a pose, not at rest.")
@options.decode_options
@options.partial
@options.reporting
@options.name_formats
def command(
    source: str,
    target: str | None,
    output: str | None,
    force: bool,
    frame: int | None,
    all_frames: bool,
    output_format: str | None,
    partial: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Decode a .dmesh file into a mesh file.

    OUT is a mesh file: {written}. By default, OUT is IN without ".dmesh". If that name has no
    extension of a mesh file, OUT has the format that was encoded, and its extension is appended.

    OUT receives everything in IN that its format can hold: polygons, attributes, names. A note on
    standard error lists the rest. ply holds attributes of any kind; obj holds objects, groups and
    materials; glb holds several meshes with transforms.

    A file may have poses of its mesh, which deltamesh edit has added: deltamesh info lists them,
    and --pose takes one.

    What is written keeps the bounds of the encoder. Positions in ply are float32 if the source had
    that and it adds next to nothing to the error of IN, otherwise float64; a text has as many
    digits as that error deserves. stl and glb have nothing but float32: the note says by how much
    positions were rounded, if that is more.

    Of a sequence, --frame decodes one frame, and --all decodes every one into a file of its own,
    which appears whole or not at all. Without either, frame 0 is decoded, and a note counts the
    others.

    IN is never modified. If OUT exists, it is overwritten only with -f. "-" stands for standard
    input or output. A mesh from standard input goes to standard output unless OUT is given. IN may
    be compressed with gzip or zstandard, also on standard input; OUT is compressed if its name ends
    in .gz or .zst. IN and OUT may be URLs, with the extra `remote`.

    A damaged file is refused. A file that would exceed --max-vertices or --memory is refused before
    any memory is allocated, and one that decompresses to more than --memory as soon as it does. No
    OUT is written then.

    --partial takes a file that is cut, such as a download that ended early. OUT is the shape at the
    stage that the whole sections of IN reach, which a note on standard error names, with what has
    not come: first the least-squares mesh of the anchors, then the surface of the deltas, coarse in
    a refined file, then everything. Their checksums are verified, but that of the content only of a
    whole file. A file that ends before any vertex has a position is refused.
    """
    target = files.chosen_output(target, output)
    if target is None and source == files.STDIO:
        target = files.STDIO
    if target is None and not (files.without_suffix(source) or os.path.isdir(source)):
        name = display_name(source)
        raise click.UsageError(f"{name} does not end in {files.SUFFIX}: OUT is needed.")
    if all_frames:
        if frame is not None:
            raise click.UsageError("--frame and --all exclude each other.")
        if target == files.STDIO:
            raise click.UsageError("--all writes files: standard output cannot have them.")
    if partial and (all_frames or frame):
        raise click.UsageError("--partial decodes no frame but the first.")
    known = written_format(files.extension(target or "")) is not None
    known |= all_frames and os.path.isdir(str(target))
    if target not in (None, files.STDIO) and output_format is None and not known:
        name = display_name(str(target))
        raise click.UsageError(f"{name} names no mesh format: use --output-format.")
    files.check_stdout_has_one_use(target, as_json)

    def decode_all(source: str, container: Container) -> None:
        with attempt(source, "cannot decode"):
            names = NumberedFiles(source, target, output_format, container)
        is_text = FORMATS[names.file_format].is_text
        _check_digits(parameters, names.file_format)
        for index in range(names.count):
            files.check_output(source, names.name(index), force=force, text=is_text)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            lost = decode_all_to_files(names, source, container, progress, parameters, force=force)
        first, last = names.name(0), names.name(names.count - 1)
        note_not_kept(first, lost, quiet=quiet)
        if as_json:
            made = {"files": [names.name(i) for i in range(names.count)]}
            print_json({"source": source, "format": names.file_format, **made})
        elif not quiet:
            arrow = f"{display_name(source)} -> {display_name(first)} to {display_name(last)}"
            click.echo(f"{arrow}: {names.count} frames")

    def decode(source: str) -> None:
        data = files.read_input(source, parameters, partial=partial)
        container = parse_container(source, data, "cannot decode", partial=partial)
        if all_frames:
            decode_all(source, container)
            return
        stored = container.meta.source if container.meta is not None else ""
        name, file_format = output_name_and_format(source, target, output_format, stored)
        is_text = FORMATS[file_format].is_text
        _check_digits(parameters, file_format)
        files.check_output(source, name, force=force, text=is_text)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            mesh, lost = decode_to_file(
                *(name, file_format, source, container, progress),
                {**parameters, "frame": frame},
                partial=partial,
                force=force,
            )
        note_not_kept(name, lost, quiet=quiet)
        note_prefix(source, container, quiet=quiet)
        if as_json:
            _print_object(
                source, name, mesh, file_format, stage_object(container) if partial else {}
            )
        elif not (quiet or name == files.STDIO):
            names = f"{display_name(source)} -> {display_name(name)}"
            click.echo(f"{names}: {len(mesh.vertices)} vertices, {len(mesh.sizes)} faces")

    process_all_and_exit([source], decode, as_json=as_json)


def _check_digits(parameters: dict[str, Any], file_format: str) -> None:
    if parameters["digits"] is not None and not FORMATS[file_format].is_text:
        raise click.UsageError(f"--digits means nothing for {file_format}, which is binary.")


def _print_object(
    source: str, target: str, mesh: PolyMesh, file_format: str, stage: dict[str, object]
) -> None:
    counts = {"vertices": len(mesh.vertices), "faces": len(mesh.sizes)}
    print_json({"source": source, "file": target, "format": file_format, **counts, **stage})
