"""`deltamesh encode`: a mesh file becomes a `.dmesh` file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from deltamesh._options import DEFAULT_KEY_EVERY, MAX_KEY_EVERY, SEQUENCE_OPTIONS
from deltamesh_cli import files, options
from deltamesh_cli.encode_options import check_encode_options, encode_options
from deltamesh_cli.encoding import EncodedFile, encode_file
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import process_all_and_exit
from deltamesh_cli.meshes import memory_notes, note_collapse, note_faces, note_not_kept
from deltamesh_cli.output import display_name, message, number, print_json
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.sequences import encode_sequence_file, in_order
from deltamesh_cli.summary import container_object, costly_lines
from deltamesh_cli.value_types import FILE, positive, whole
from deltamesh_formats.container.figures import attributes_of
from deltamesh_formats.container.lines import (
    achieved,
    achieved_in_worst_part,
    counts,
    frame_lines,
    region_lines,
)

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container

_EXAMPLES = """\
deltamesh encode bunny.ply                      writes bunny.ply.dmesh
deltamesh encode bunny.ply small.dmesh --quality 3
deltamesh encode scan.obj --normal-error 0.5 --max-error-rel 1e-3
deltamesh encode part.stl --max-error 0.05      moves no vertex further
deltamesh encode part.3mf --max-error 0.05mm
deltamesh encode scan.ply --rms-error 0.05%      of the diagonal
deltamesh encode scan.obj --method highpass --bits 6
deltamesh encode scan.obj --step 0.01 --anchors 500
deltamesh encode face.ply --importance quality   more bits where it is 1
deltamesh encode rig.obj --keep-order            keeps vertex numbers
deltamesh encode part.obj --lossless             keeps every bit
deltamesh encode part.obj --drop all             keeps the shape alone
deltamesh encode scan.glb --drop normal,tangent --bits-uv 14
deltamesh encode scan.ply --max-attribute-error confidence=0.01
deltamesh encode frames/*.ply -o walk.dmesh --sequence --fps 25
cat mesh.off | deltamesh encode - --input-format off > mesh.dmesh
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("names", type=FILE, metavar="IN... [OUT]", nargs=-1, required=True)
@options.output("IN.dmesh", positional=False)
@click.option(
    "--force-name",
    is_flag=True,
    help="Write OUT even if its name does not end in .dmesh.",
)
@click.option(
    "--sequence",
    is_flag=True,
    help="All IN are frames of one sequence: meshes of the same vertices and faces, at other"
    " positions. OUT is given with -o.",
)
@click.option(
    "--fps",
    type=positive,
    metavar="F",
    help="Frames a second of a sequence, to be stored.",
)
@click.option(
    "--key-every",
    type=whole(1, MAX_KEY_EVERY),
    metavar="N",
    help="One frame in N is a key frame, from where the frames after it are decoded."
    f"  [default: {DEFAULT_KEY_EVERY}]",
)
@encode_options
@options.reporting
@options.name_formats
def command(
    names: tuple[str, ...],
    output: str | None,
    force: bool,
    sequence: bool,
    force_name: bool,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Compress a mesh file into a .dmesh file.

    IN is a mesh file: {formats}.

    Connectivity is lossless, even where it is irregular: polygons, edges with three faces, flipped
    faces, repeated faces, degenerate faces, several vertices at one position. Without --keep-order,
    the order of vertices and faces changes.

    Positions change by a small, smooth error. --quality or bounds in units limit it, and they can
    be combined. The encoder decodes every file that it tries and keeps the smallest one within all
    bounds. It prints the errors that it measured and stores them in the file. If a bound cannot be
    met, encoding fails with exit code 4, and the message gives the smallest errors that were found.
    With --lossless, positions do not change.

    With --importance, bounds are divided by the importance of each vertex, an attribute from 0 to
    1, and means are weighted by it. The errors of what is important, and of the rest, are printed
    and stored.

    Attributes of vertices, corners and faces are kept. All numbers are kept to the last bit, except
    texture coordinates, unit normals and floating-point colours, which are rounded (--bits-uv,
    --bits-normal) unless --lossless-attributes or --lossless is given. The names and faces of
    objects, groups, smoothing groups and materials, the transforms of a scene, and comments are
    kept, too. --drop leaves out content that you do not need.

    Pictures, the appearance of materials, animations, lines, points and everything else that is not
    a mesh of faces are not kept. If IN has any of these, a note on standard error lists them, and
    so do the key "not_kept" of --json and deltamesh info.

    With --sequence, the frames are in the order of IN; if that is the one in which a shell lists
    names, numbers in them count: frame2 comes before frame10. All bounds hold in every frame.
    Attributes that differ between frames are not kept. A frame with another connectivity than the
    first is refused.

    IN is never modified. OUT ends in .dmesh unless --force-name is given. If OUT exists, it is
    overwritten only with -f. "-" stands for standard input or output. Reading from standard input
    needs --input-format, and writes to standard output unless OUT is given. IN may be compressed
    with gzip or zstandard, as scan.ply.gz or scan.ply.zst, also on standard input; OUT is
    compressed if its name ends in .gz or .zst.

    IN and OUT may be URLs, such as s3://bucket/scan.ply or https://host/scan.ply, with the extra
    `remote` (pip install 'deltamesh[remote]') and the package of the store.
    """
    sources, positional = _inputs(names, sequence)
    source = sources[0]
    if not sequence:
        _refuse_options_of_sequences(parameters)
    target = files.chosen_output(positional, output)
    if target is None and sequence:
        raise click.UsageError("--sequence needs -o OUT.")
    if target is None:
        target = source if source == files.STDIO else source + files.SUFFIX
    elif not force_name:
        files.check_name_of_dmesh(target)
    check_encode_options(parameters)
    if files.STDIO in sources and (input_format is None or sequence):
        if sequence:
            raise click.UsageError("The frames of a sequence are files.")
        raise click.UsageError("Reading from standard input needs --input-format.")
    files.check_stdout_has_one_use(target, as_json)

    def encode(source: str) -> None:
        for one in sources:
            files.check_input(one)
            files.check_output(one, target, force=force)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            if sequence:
                encoded = encode_sequence_file(
                    sources, target, input_format, progress, parameters, force=force
                )
            else:
                encoded = encode_file(
                    source, target, input_format, progress, parameters, force=force
                )
        note_not_kept(source, encoded.lost, quiet=quiet)
        note_faces(source, encoded.report, quiet=quiet)
        note_collapse(source, encoded.report, encoded.container, quiet=quiet)
        for note in () if quiet else memory_notes(target, encoded.container):
            message(f"note: {note}")
        _note_unknown(source, encoded.container, parameters, quiet=quiet)
        if as_json:
            print_json(_object(sources, target, encoded))
        elif not (quiet or target == files.STDIO):
            _print_summary(sources, target, encoded)

    process_all_and_exit([source], encode, as_json=as_json)


def _inputs(names: tuple[str, ...], sequence: bool) -> tuple[tuple[str, ...], str | None]:
    """Return the inputs among the names, and OUT if that is one of them."""
    if sequence:
        return in_order(names), None
    if len(names) > 2:
        raise click.UsageError(
            f"{len(names)} names, where IN and OUT are two: --sequence makes one file of many"
            " frames, deltamesh batch one of each."
        )
    return names[:1], names[1] if len(names) > 1 else None


def _refuse_options_of_sequences(parameters: dict[str, Any]) -> None:
    for name in SEQUENCE_OPTIONS:
        if parameters[name] is not None:
            raise click.UsageError(f"{options.flag_of(name)} means nothing without --sequence.")


def _note_unknown(
    source: str, container: Container, parameters: dict[str, Any], *, quiet: bool
) -> None:
    """Note on standard error the names of --max-attribute-error that no attribute has."""
    given = parameters["max_attribute_error"]
    if given and not quiet:
        known = {name for entry in attributes_of(container) for name in (entry.name, entry.role)}
        for name in given.keys() - known:
            text = f"--max-attribute-error {display_name(name)}: there is no such attribute"
            message(f"note: {display_name(source)}: {text}")


def _object(sources: tuple[str, ...], target: str, encoded: EncodedFile) -> dict[str, object]:
    """Return what was encoded for `--json`."""
    cost = None if encoded.cost is None else vars(encoded.cost)
    sizes = {"source": sources[0], "source_bytes": encoded.source_size}
    return {
        **sizes,
        **container_object(target, encoded.container),
        "bound": cost,
        "unit": encoded.unit or None,
    }


def _print_summary(sources: tuple[str, ...], target: str, encoded: EncodedFile) -> None:
    """Print the sizes of the files, the errors, and the bound that cost the bytes."""
    container, cost = encoded.container, encoded.cost
    name, others = display_name(sources[0]), len(sources) - 1
    named = f"{name} and {others} more" if others else name
    click.echo(f"{named}: {encoded.source_size} bytes")
    click.echo(f"{display_name(target)}: {container.size} bytes, {counts(container)}")
    if container.meta is not None:
        click.echo(f"achieved: {achieved(container.meta)}")
        if container.meta.parts > 1:
            click.echo(achieved_in_worst_part(container.meta))
        for line in region_lines(container):
            click.echo(line)
    for line in frame_lines(container):
        click.echo(line)
    for line in costly_lines(container):
        click.echo(line)
    if encoded.unit:
        click.echo(f"unit of lengths: {encoded.unit}")
    if cost is not None:
        where = "" if cost.part is None else f" in {display_name(cost.part)}"
        reached = f"{number(cost.error)} of {number(cost.bound)}"
        what = "bound that cost the bytes" if cost.error <= cost.bound else "beyond this method"
        click.echo(f"{what}: {cost.name}{where}, {reached}")
