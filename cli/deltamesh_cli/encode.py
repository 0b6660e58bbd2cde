"""`deltamesh encode`: a mesh file in, a `.dmesh` out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from deltamesh.options import ANCHOR_METHODS, MAX_BITS, METHODS, RATES
from deltamesh_cli import files, options, summary
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.meshes import parsed
from deltamesh_cli.output import print_json, shown
from deltamesh_cli.progress import Stage, progress
from deltamesh_cli.signals import interruptible

if TYPE_CHECKING:
    from deltamesh_formats.meshfile import MeshData

_EXAMPLES = """\
deltamesh encode bunny.ply                      writes bunny.ply.dmesh
deltamesh encode bunny.ply small.dmesh --bits 6
deltamesh encode scan.obj --step 0.01 --anchors 500
deltamesh encode scan.obj --method refined --normal-error 1
deltamesh encode part.stl --method cartesian --max-error 0.05
deltamesh encode part.stl --method cartesian --bits 12
cat mesh.off | deltamesh encode - --input-format off > mesh.dmesh
"""


@click.command(epilog=options.epilog(_EXAMPLES))
@click.argument("source", metavar="IN")
@options.output("IN.dmesh")
@click.option(
    "--method",
    type=click.Choice(METHODS),
    default="highpass",
    show_default=True,
    help="What is quantized: differential coordinates (scans, organic shapes); these coarsely, and"
    " finely across the surface (the same look in fewer bytes); or x, y, z (CAD).",
)
@click.option(
    "-b",
    "--bits",
    type=options.whole(0, MAX_BITS),
    metavar="B",
    help="Bits per coordinate: the step is the range of what is quantized over 2^B. With highpass,"
    " 0 keeps connectivity and anchors alone.  [default: cartesian 11]",
)
@click.option(
    "--step",
    type=options.length,
    metavar="LENGTH",
    help="The step itself, in the unit of the mesh, instead of --bits."
    "  [default: highpass 1/1000 of the diagonal of the bounding box]",
)
@click.option(
    "--normal-error",
    type=options.length,
    metavar="DEG",
    help="The quality instead of the step: the mean deviation of the face normals, in degrees.",
)
@click.option(
    "--max-error",
    type=options.length,
    metavar="LENGTH",
    help="Likewise: no vertex further from where it was than that, in the unit of the mesh.",
)
@click.option(
    "--max-error-rel",
    type=options.length,
    metavar="FRACTION",
    help="Likewise, as a fraction of the diagonal of the bounding box.",
)
@click.option(
    "--coarse",
    type=options.factor,
    metavar="C",
    help="With refined, the step along the surface over that across it, 1 to 64.  [default: 8]",
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
@options.input_format
@options.solver
@options.threads
@options.as_json
@options.verbosity
@options.debug
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

    IN is an obj, ply, off, stl or glb file.

    Connectivity is kept exactly, whatever it is: edges of three faces, faces turned over, faces
    twice, degenerate faces, several vertices at one position. Vertices and faces may come back in
    another order. Positions come back with a small, smooth error: --bits or --step sets it, and
    what became of it is printed and stored in the file.

    IN stays as it is. An OUT that exists is overwritten only with -f. "-" is standard input or
    output; reading from standard input needs --input-format, and writes to standard output unless
    OUT is given.
    """
    target = files.chosen_output(target, output)
    if target is None:
        target = source if source == files.STDIO else source + files.SUFFIX
    if parameters["method"] == "cartesian":
        _refuse_high_pass_options(parameters)
    _refuse_two_rates(parameters)
    if source == files.STDIO and input_format is None:
        raise click.UsageError("Reading from standard input needs --input-format.")
    files.check_usage(target, as_json)

    def encode(source: str) -> None:
        files.check_input(source)
        files.check_output(source, target, force=force)
        original = files.read_input(source)
        with progress(show_progress, verbose=verbose, quiet=quiet) as stage:
            mesh = parsed(source, original, input_format, stage)
            with attempt(source, "cannot encode"):
                data = interruptible(lambda: _encoded(mesh, stage, parameters))
        with files.open_output(target) as stream:
            stream.write(data)
        if as_json or not (quiet or target == files.STDIO):
            _print_summary((source, len(original)), target, data, as_json)

    each([source], encode, as_json=as_json)


def _refuse_two_rates(parameters: dict[str, Any]) -> None:
    given = [f"--{name.replace('_', '-')}" for name in RATES if parameters[name] is not None]
    if len(given) > 1:
        raise click.UsageError(f"{' and '.join(given)} exclude each other.")


def _refuse_high_pass_options(parameters: dict[str, Any]) -> None:
    for name in ("anchors", "anchor_method", "diffusion", "seed"):
        if parameters[name] is not None:
            option = name.replace("_", "-")
            raise click.UsageError(f"--{option} means nothing with --method cartesian.")


def _encoded(mesh: MeshData, stage: Stage, parameters: dict[str, Any]) -> bytes:
    import deltamesh

    return deltamesh.encode(
        mesh.vertices,
        mesh.faces,
        source_format=mesh.format,
        progress=stage,
        **options.given(parameters),
    )


def _print_summary(source: tuple[str, int], target: str, data: bytes, as_json: bool) -> None:
    """Print what became of `source`, a name and a size in bytes."""
    from deltamesh_formats.reader import read_container

    container = read_container(data)
    name, size = source
    if as_json:
        made = summary.as_object(target, container)
        print_json({"source": name, "source_bytes": size, **made})
        return
    click.echo(f"{shown(name)}: {size} bytes")
    click.echo(f"{shown(target)}: {container.size} bytes, {summary.counts(container)}")
    if container.meta is not None:
        click.echo(f"achieved: {summary.achieved(container.meta)}")
