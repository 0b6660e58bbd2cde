"""`deltamesh edit`: a pose is added to a `.dmesh` file, or poses are removed."""

from __future__ import annotations

from collections.abc import Sized
from typing import TYPE_CHECKING, Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.meshes import parse_container
from deltamesh_cli.output import display_name, message, number, print_json
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.regions import Motion, Term, motion, region, target_of, vertices_in
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE, positive

if TYPE_CHECKING:
    from deltamesh import Edited, PolyMesh
    from deltamesh._handles import Move
    from deltamesh._progress import Progress
    from deltamesh_formats.array_types import Bools, Floats
    from deltamesh_formats.container.container import Container

_EXAMPLES = """\
deltamesh edit a.dmesh b.dmesh --name up --move 'z>9' turn=y,90 --fix 'z<1'
deltamesh edit a.dmesh b.dmesh --name out --move vertices:7 shift=1,0,0
deltamesh edit a.dmesh b.dmesh --name in --move part:arm turn=0,1,1,40
deltamesh decode b.dmesh up.obj --pose up
deltamesh edit b.dmesh c.dmesh --remove up
"""

_REGIONS = """\
REGION is one or more of these, with & between them:
  y<45%             a share of the bounding box, of x, y or z, by < or >
  z>2.5             likewise, a coordinate
  ball:X,Y,Z,R      vertices within R of a point
  box:X,Y,Z,X,Y,Z   vertices between two corners
  vertices:3,7-9    vertices by their numbers, from 0
  part:NAME         vertices of a part; a name ends the region"""

_MOTIONS = """\
MOTION is one or more of these, with blanks between them:
  shift=X,Y,Z       by a vector
  turn=y,30         about an axis, x, y, z or X,Y,Z, by degrees
  about=X,Y,Z       a point on that axis; else the middle of the region"""

# Errors of a record that are worth a word: those of the default quality.
_RMS, _NORMAL = 0.0015, 1.0


@click.command(epilog=epilog(_EXAMPLES, _REGIONS, _MOTIONS))
@click.argument("source", type=FILE, metavar="IN")
@options.output("none; it is needed")
@click.option("--name", help="Name of the pose.")
@click.option(
    "--move",
    "moves",
    type=(region, motion),
    multiple=True,
    metavar="REGION MOTION",
    help="Move the vertices of a region; may be given several times.",
)
@click.option(
    "--fix",
    "fixed",
    type=region,
    multiple=True,
    metavar="REGION",
    help="Leave the vertices of a region where they are; may be given several times.",
)
@click.option(
    "--step",
    type=positive,
    metavar="S",
    help="Step of the displacements in the file, in the unit of the mesh."
    "  [default: 1/4096 of the diagonal]",
)
@click.option(
    "--remove",
    "removed",
    multiple=True,
    metavar="NAME",
    help="Remove a pose instead of adding one; may be given several times.",
)
@options.decoding
@options.reporting
def command(
    source: str,
    target: str | None,
    output: str | None,
    force: bool,
    name: str | None,
    moves: tuple[tuple[tuple[Term, ...], Motion], ...],
    fixed: tuple[tuple[Term, ...], ...],
    step: float | None,
    removed: tuple[str, ...],
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Add a pose to a .dmesh file, or remove poses.

    The surface follows the vertices that are moved (--move) and stays where it is held (--fix). OUT
    is IN with one pose more: the mesh at rest stays as it is, and deltamesh decode --pose NAME
    makes the mesh in the pose. A pose is a motion of the anchors of the file, and takes about 0.4
    to 3 % of it. What is printed says how far that is from the edit; more anchors (deltamesh encode
    --anchors) come nearer.

    Without a turn, vertices are put where they are to be, and turn as the surface does; turn=z,0
    keeps them from turning. Files of methods cartesian and lossless have no anchors, and take no
    poses. With --remove, OUT is IN without the poses of these names.
    """
    _check_use(name, moves, fixed, step, removed)
    target = files.chosen_output(target, output)
    if target is None:
        raise click.UsageError("OUT is needed: IN is never modified.")
    files.check_name_of_dmesh(target)
    files.check_stdout_has_one_use(target, as_json)

    def edit(source: str) -> None:
        container = parse_container(source, files.read_input(source, parameters), "cannot edit")
        files.check_output(source, target, force=force)
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            with attempt(source, "cannot edit"):
                if removed:
                    data = interruptible(lambda: _without(container, removed, progress, parameters))
                else:
                    assert name is not None
                    made = interruptible(
                        lambda: _edited(container, moves, fixed, name, progress, step, parameters)
                    )
                    data = made.data
            files.write_output(target, data, force=force)
        if removed:
            if as_json:
                print_json(_object_without(source, target, data, removed))
            elif not (quiet or target == files.STDIO):
                _print_removed(source, target, data, removed)
            return
        if as_json:
            print_json(_object(source, target, made))
        elif not (quiet or target == files.STDIO):
            _print_summary(source, target, made)
        if not quiet and (made.rms > _RMS or made.normal > _NORMAL):
            anchors = f"its {made.anchors} anchors are few for this edit"
            message(f"note: {display_name(source)}: {anchors}: deltamesh encode --anchors has more")

    process_all_and_exit([source], edit, as_json=as_json)


def _check_use(
    name: str | None,
    moves: Sized,
    fixed: Sized,
    step: float | None,
    removed: Sized,
) -> None:
    """Refuse options that are needed and missing, or mean nothing beside others."""
    given = {"--name": name, "--move": moves, "--fix": fixed, "--step": step}
    if removed:
        for option, value in given.items():
            if value:
                raise click.UsageError(f"{option} means nothing with --remove.")
        return
    for option in ("--name", "--move"):
        if not given[option]:
            raise click.UsageError(f"Missing option '{option}'; or --remove NAME removes a pose.")


def _without(
    container: Container,
    removed: tuple[str, ...],
    progress: Progress,
    parameters: dict[str, Any],
) -> bytes:
    from deltamesh import remove_poses

    limits = {name: parameters[name] for name in ("max_vertices", "memory")}
    return remove_poses(container, removed, progress=progress, **options.specified(limits))


def _edited(
    container: Container,
    moves: tuple[tuple[tuple[Term, ...], Motion], ...],
    fixed: tuple[tuple[Term, ...], ...],
    name: str,
    progress: Progress,
    step: float | None,
    parameters: dict[str, Any],
) -> Edited:
    from deltamesh._decode_options import DecodeOptions
    from deltamesh._editing import edit_chosen

    def chosen(mesh: PolyMesh) -> tuple[list[Move], list[Bools]]:
        handles: list[Move] = [_handle(mesh, *one) for one in moves]
        return handles, [vertices_in(mesh, one) for one in fixed]

    decoding = DecodeOptions(progress=progress, **options.specified(parameters))
    return edit_chosen(container, chosen, decoding, name=name, step=step)


def _handle(mesh: PolyMesh, terms: tuple[Term, ...], moved: Motion) -> tuple[Bools, Floats]:
    """Return the vertices of faces in a region, and where they go."""
    import numpy as np

    in_face = np.zeros(len(mesh.vertices), dtype=bool)
    in_face[mesh.corners] = True
    chosen = vertices_in(mesh, terms) & in_face
    return chosen, target_of(moved, mesh.vertices[chosen])


def _object(source: str, target: str, made: Edited) -> dict[str, object]:
    """Return what was done for `--json`; lengths are shares of the diagonal."""
    return {
        "source": source,
        "file": target,
        "bytes": len(made.data),
        "pose": made.name,
        "pose_bytes": made.size,
        "anchors": made.anchors,
        "missed": made.missed,
        "recorded_missed": made.recorded_missed,
        "rms_relative": made.rms,
        "max_relative": made.max,
        "normal_deviation_degrees": made.normal,
        "dihedral_degrees": made.dihedral,
        "recorded_dihedral_degrees": made.recorded_dihedral,
    }


def _object_without(
    source: str, target: str, data: bytes, removed: tuple[str, ...]
) -> dict[str, object]:
    """Return what was removed for `--json`."""
    return {"source": source, "file": target, "bytes": len(data), "removed": list(removed)}


def _print_removed(source: str, target: str, data: bytes, removed: tuple[str, ...]) -> None:
    names = ", ".join(map(display_name, removed))
    sizes = f"{len(data)} bytes, without pose {names}"
    click.echo(f"{display_name(source)} -> {display_name(target)}: {sizes}")


def _print_summary(source: str, target: str, made: Edited) -> None:
    sizes = f"{len(made.data)} bytes, {made.size} of them pose {display_name(made.name)}"
    click.echo(f"{display_name(source)} -> {display_name(target)}: {sizes}")
    click.echo(f"edit: dihedral angles change by {number(made.dihedral)} degrees")
    click.echo(
        f"as recorded by {made.anchors} anchors: RMS {number(made.rms)} and max {number(made.max)}"
        f" of the diagonal, normals {number(made.normal)} degrees from the edit; moved vertices"
        f" miss their places by {number(made.recorded_missed)} of the diagonal at most"
    )
