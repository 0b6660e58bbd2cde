"""`deltamesh encode`: a mesh file in, a `.dmesh` out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from deltamesh._methods import AUTO, LOSSLESS
from deltamesh._options import (
    ANCHOR_METHODS,
    CHOICES,
    DEFAULT_BITS_NORMAL,
    DEFAULT_BITS_UV,
    DEFAULT_EFFORT,
    MAX_BITS,
    MAX_BITS_NORMAL,
    MAX_BITS_UV,
    MAX_EFFORT,
    MAX_QUALITY,
    MIN_BITS_NORMAL,
    check_together,
)
from deltamesh_cli import files, options, summary
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.meshes import container_of, note_memory, note_not_kept, parsed
from deltamesh_cli.output import print_json, shown
from deltamesh_cli.progress import Stage, progress
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.texts import texts_of
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh

_EXAMPLES = """\
deltamesh encode bunny.ply                      writes bunny.ply.dmesh
deltamesh encode bunny.ply small.dmesh --quality 3
deltamesh encode scan.obj --normal-error 0.5 --max-error-rel 1e-3
deltamesh encode part.stl --max-error 0.05      within that of each vertex
deltamesh encode scan.obj --method highpass --bits 6
deltamesh encode scan.obj --step 0.01 --anchors 500
deltamesh encode rig.obj --keep-order            arrays alongside still fit
deltamesh encode part.obj --lossless             everything to the last bit
deltamesh encode part.obj --drop all             the shape alone
deltamesh encode scan.glb --drop normal --bits-uv 14
cat mesh.off | deltamesh encode - --input-format off > mesh.dmesh
"""


@click.command(epilog=options.epilog(_EXAMPLES))
@click.argument("source", type=options.FILE, metavar="IN")
@options.output("IN.dmesh")
@click.option(
    "--quality",
    type=options.whole(1, MAX_QUALITY),
    metavar="1..9",
    help="How good: 5 keeps the mean deviation of the face normals within 1 degree and the RMS"
    " distance within 0.15 % of the diagonal of the bounding box; two more halve both."
    "  [default: 5]",
)
@click.option(
    "--normal-error",
    type=options.length,
    metavar="DEG",
    help="The same in units: the mean deviation of the face normals, in degrees.",
)
@click.option(
    "--dihedral-error",
    type=options.length,
    metavar="DEG",
    help="The mean deviation of the dihedral angles, in degrees.",
)
@click.option(
    "--max-error",
    type=options.length,
    metavar="LENGTH",
    help="No vertex further from where it was than that, in the unit of the mesh.",
)
@click.option(
    "--max-error-rel",
    type=options.length,
    metavar="FRACTION",
    help="Likewise, as a fraction of the diagonal of the bounding box.",
)
@click.option(
    "--effort",
    type=options.whole(1, MAX_EFFORT),
    metavar="1..3",
    help=f"How long to search for the fewest bytes.  [default: {DEFAULT_EFFORT}]",
)
@click.option(
    "--method",
    type=click.Choice(CHOICES),
    default=AUTO,
    show_default=True,
    help="What is quantized: differential coordinates, coarsely along the surface and finely across"
    " it (refined; scans, organic shapes); alike (highpass); x, y, z (cartesian; CAD); or nothing"
    " (lossless). auto is refined or cartesian, whichever takes fewer bytes.",
)
@click.option(
    "--lossless",
    is_flag=True,
    help="Keep positions to the last bit, -0.0 and all: short for --method lossless.",
)
@click.option(
    "-b",
    "--bits",
    type=options.whole(0, MAX_BITS),
    metavar="B",
    help="Instead of a quality, bits per coordinate: the step is the range of what is quantized"
    " over 2^B. 0 keeps connectivity and anchors alone.  [default: cartesian 11]",
)
@click.option(
    "--step",
    type=options.length,
    metavar="LENGTH",
    help="The step itself, in the unit of the mesh."
    "  [default: highpass and refined 1/1000 of the diagonal of the bounding box]",
)
@click.option(
    "--coarse",
    type=options.factor,
    metavar="C",
    help="With refined, the step along the surface over that across it, 1 to 64."
    "  [default: by search]",
)
@click.option(
    "--anchors",
    type=options.anchor_count,
    metavar="K|FRACTION",
    help="Vertices whose position is stored: how many, or which fraction.  [default: 0.001]",
)
@click.option(
    "--anchor-method",
    type=click.Choice(ANCHOR_METHODS),
    help="How anchors are chosen: spread over the surface, where the error is largest (slower),"
    " or at random.  [default: farthest]",
)
@click.option(
    "--diffusion/--no-diffusion",
    default=None,
    help="Hand each rounding error on to the neighbours still to come, which lowers the error at"
    " the same size; or plain rounding.  [default: diffusion]",
)
@click.option(
    "--seed",
    type=options.whole(0, 2**64 - 1),
    metavar="N",
    help="Seed of the random anchors.  [default: 0]",
)
@click.option(
    "--drop-isolated",
    is_flag=True,
    default=None,
    help="Leave out the vertices that belong to no face.",
)
@click.option(
    "--keep-order",
    is_flag=True,
    default=None,
    help="Vertices and faces come back in the order of IN, each face from its first corner on.",
)
@click.option(
    "--drop",
    multiple=True,
    callback=lambda context, parameter, names: list(names) or None,
    metavar="NAME",
    help="Leave out what has this name: an attribute, a role (uv, normal, colour), a kind of parts"
    " (object, mesh, group, material, smoothing), a key of metadata, transforms, or all. May come"
    " several times; what IN does not have is no error.",
)
@click.option(
    "--bits-uv",
    type=options.whole(1, MAX_BITS_UV),
    metavar="B",
    help="Texture coordinates: 2^B steps on the largest of their extents."
    f"  [default: {DEFAULT_BITS_UV}]",
)
@click.option(
    "--bits-normal",
    type=options.whole(MIN_BITS_NORMAL, MAX_BITS_NORMAL),
    metavar="B",
    help="Unit normals: 2^B steps on both sides of an unfolded octahedron."
    f"  [default: {DEFAULT_BITS_NORMAL}]",
)
@click.option(
    "--lossless-attributes",
    is_flag=True,
    default=None,
    help="Keep all attributes to the last bit, as --lossless does: texture coordinates, normals"
    " and colours of floats too, which otherwise are rounded.",
)
@options.input_format
@options.solver
@options.threads
@options.as_json
@options.verbosity
@options.debug
@options.name_formats
def command(
    source: str,
    target: str | None,
    output: str | None,
    force: bool,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Compress a mesh file into a .dmesh file.

    IN is a mesh file: {formats}.

    Connectivity is kept exactly, whatever it is: polygons, edges of three faces, faces turned over,
    faces twice, degenerate faces, several vertices at one position. Without --keep-order, vertices
    and faces come back in another order.

    Positions come back with a small, smooth error: --quality or bounds in units set it, any of them
    together. The encoder decodes what it has coded, and takes the smallest file within all bounds
    that it finds; what became of the errors is printed and stored in the file. A bound that cannot
    be met is an error (exit code 4) that says what could be had. With --lossless, positions come
    back as they were.

    Attributes of vertices, corners and faces are kept: any numbers to the last bit, but texture
    coordinates, unit normals and colours of floats, which are rounded (--bits-uv, --bits-normal)
    unless --lossless-attributes or --lossless is given. Kept are also the names and faces of
    objects, groups, smoothing groups and materials, the transforms of a scene, and comments. --drop
    leaves out what is not wanted.

    Not kept are pictures, what materials look like, animations, lines, points, and what else is no
    mesh of faces. What of these IN has is named in a note on standard error, in the output of
    --json as "not_kept", and by deltamesh info.

    IN stays as it is. An OUT that exists is overwritten only with -f. "-" is standard input or
    output; reading from standard input needs --input-format, and writes to standard output unless
    OUT is given.
    """
    target = files.chosen_output(target, output)
    if target is None:
        target = source if source == files.STDIO else source + files.SUFFIX
    check_parameters(parameters)
    if source == files.STDIO and input_format is None:
        raise click.UsageError("Reading from standard input needs --input-format.")
    files.check_usage(target, as_json)

    def encode(source: str) -> None:
        files.check_input(source)
        files.check_output(source, target, force=force)
        with progress(show_progress, verbose=verbose, quiet=quiet) as stage:
            size, container, lost = encode_file(
                source, target, input_format, stage, parameters, force=force
            )
        note_not_kept(source, lost, quiet=quiet)
        note_memory(target, container, quiet=quiet)
        if as_json or not (quiet or target == files.STDIO):
            _print_summary((source, size), target, container, as_json=as_json)

    each([source], encode, as_json=as_json)


def check_parameters(parameters: dict[str, Any]) -> None:
    """Refuse options that do not go together; what is left are keywords of `deltamesh.encode`."""
    if parameters.pop("lossless"):
        _choose_lossless(parameters)
    try:
        check_together(parameters["method"], options.given(parameters), options.shown)
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _choose_lossless(parameters: dict[str, Any]) -> None:
    source = click.get_current_context().get_parameter_source("method")
    method = parameters["method"]
    if source is not click.core.ParameterSource.DEFAULT and method != LOSSLESS.name:
        raise click.UsageError(f"--lossless and --method {method} exclude each other.")
    parameters["method"] = LOSSLESS.name


def encode_file(
    source: str,
    target: str,
    input_format: str | None,
    stage: Stage,
    parameters: dict[str, Any],
    *,
    force: bool,
) -> tuple[int, Container, tuple[str, ...]]:
    """Compress one file into another.

    Returns
    -------
    size : int
        Bytes of the first.
    container : Container
        Of the second.
    lost : tuple of str
        Words for what is not kept.

    Raises
    ------
    Failure
    """
    original = files.read_input(source)
    mesh = parsed(source, original, input_format, stage)
    with attempt(source, "cannot encode"):
        data = interruptible(lambda: _encoded(mesh, stage, parameters))
    files.write_output(target, data, force=force)
    container = container_of(target, data, "cannot encode")
    return len(original), container, texts_of(container).lost


def _encoded(mesh: PolyMesh, stage: Stage, parameters: dict[str, Any]) -> bytes:
    import deltamesh

    return deltamesh.encode(
        mesh,
        source_format=mesh.format,
        progress=stage,
        **options.given(parameters),
    )


def _print_summary(
    source: tuple[str, int], target: str, container: Container, *, as_json: bool
) -> None:
    """Print what became of `source`, a name and a size in bytes."""
    name, size = source
    if as_json:
        print_json({"source": name, "source_bytes": size, **summary.as_object(target, container)})
        return
    click.echo(f"{shown(name)}: {size} bytes")
    click.echo(f"{shown(target)}: {container.size} bytes, {summary.counts(container)}")
    if container.meta is not None:
        click.echo(f"achieved: {summary.achieved(container.meta)}")
