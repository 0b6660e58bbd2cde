"""`deltamesh compare`: two meshes, every metric."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TypeAlias

import click

from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.meshes import Loaded, load_any
from deltamesh_cli.output import number, print_json, shown, table
from deltamesh_cli.progress import Stage, progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.summary import bits_per_vertex, relative

if TYPE_CHECKING:
    from deltamesh.likeness import Difference

    _Errors: TypeAlias = dict[str, float | None]
    _Differences: TypeAlias = tuple[Difference, ...]

# The metrics of deltamesh.metrics.Errors, and what they are called here.
_LENGTHS = {"rms": "RMS", "max": "max", "hausdorff": "Hausdorff", "visual": "visual"}
_ANGLES = {"normal_deviation": "face normals", "dihedral": "dihedral angles"}

_METRICS = """\
Metrics, in the unit of A and as a fraction of its bounding box diagonal:
  RMS, max         distances between corresponding vertices
  Hausdorff        symmetric distance between the surfaces, by samples
  visual           0.15 Mq + 0.85 Sq of the papers: position and smoothness
and in degrees:
  face normals     mean deviation, weighted by area
  dihedral angles  mean change over the interior edges
Of each attribute of A the largest difference, of normals the largest angle."""
_EXAMPLES = """\
deltamesh compare bunny.ply bunny.ply.dmesh
deltamesh compare --json a.obj b.obj | jq .errors.hausdorff
"""


@click.command(epilog=options.epilog(_EXAMPLES, _METRICS))
@click.argument("first", type=options.FILE, metavar="A")
@click.argument("second", type=options.FILE, metavar="B")
@options.input_format
@options.solver
@options.threads
@options.limits
@options.as_json
@options.verbosity
@options.debug
def command(
    first: str,
    second: str,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Measure how far mesh B is from mesh A.

    Each is a mesh file or a .dmesh file. Vertices and faces may be in another order, repeated
    positions and isolated vertices may be gone; each position and each face counts once. Where even
    so the vertices do not correspond, for the connectivity is another one, only the distance
    between the surfaces is measured.
    """
    if first == second == files.STDIO:
        raise click.UsageError("A and B cannot both be standard input.")

    def compare(name: str) -> None:
        with progress(show_progress, verbose=verbose, quiet=quiet) as stage:
            a = load_any(name, input_format, stage, **parameters)
            b = load_any(second, input_format, stage, **parameters)
            with attempt(second, f"cannot compare with {shown(name)}"):
                errors, attributes = interruptible(lambda: _measured(a, b, stage))
        loaded = {"a": (name, a), "b": (second, b)}
        if as_json:
            described = {key: _described(*one) for key, one in loaded.items()}
            listed = None if attributes is None else [_as_object(one) for one in attributes]
            print_json({**described, "errors": _with_relatives(errors), "attributes": listed})
        elif not quiet:
            click.echo("\n".join(_line(*one) for one in loaded.values()))
            click.echo("\n" + table(_rows(errors)))
            if attributes:
                click.echo("\n" + table(_attribute_rows(attributes)))

    each([first], compare, as_json=as_json)


def _measured(a: Loaded, b: Loaded, stage: Stage) -> tuple[_Errors, _Differences | None]:
    """Return every metric by its name, None for those that need vertices that correspond.

    Beside them, how far attributes differ, None where faces do.
    """
    from deltamesh import likeness, metrics
    from deltamesh.complexes import distinct_faces
    from deltamesh.mesh import Mesh, triangulated

    stage("matching vertices")
    containers = [one.container for one in (a, b) if one.container]
    exact = any(container.parameters.method == "lossless" for container in containers)
    found = likeness.corresponding(a.mesh, b.mesh, exact)
    if found is None:
        stage("measuring surfaces")
        first, second = triangulated(a.mesh), triangulated(b.mesh)
        surfaces = {"hausdorff": metrics.hausdorff(first, second)}
        diagonal = metrics.diagonal(first.vertices)
        return {**dict.fromkeys([*_LENGTHS, *_ANGLES]), **surfaces, "diagonal": diagonal}, None
    stage("measuring")
    faces = distinct_faces(found.a.mesh.faces)
    reference = Mesh(found.a.mesh.vertices, faces)
    paired = Mesh(found.b.mesh.vertices[found.sites], faces)
    errors = vars(metrics.compare(reference, paired))
    pairs = likeness.matched_corners(a.mesh, b.mesh, found)
    return errors, None if pairs is None else likeness.differences(a.mesh, b.mesh, pairs)


def _described(name: str, loaded: Loaded) -> dict[str, object]:
    vertices, rate = len(loaded.mesh.vertices), None
    if loaded.container is not None:
        rate = bits_per_vertex(loaded.size, vertices)
    counts = {"vertices": vertices, "faces": len(loaded.mesh.sizes)}
    return {"file": name, "bytes": loaded.size, **counts, "bits_per_vertex": rate}


def _line(name: str, loaded: Loaded) -> str:
    vertices, faces = len(loaded.mesh.vertices), len(loaded.mesh.sizes)
    text = f"{shown(name)}: {loaded.size} bytes, {vertices} vertices, {faces} faces"
    if loaded.container is None:
        return text
    return f"{text}, {bits_per_vertex(loaded.size, vertices):.2f} bits per vertex"


def _relative(errors: dict[str, float | None], name: str) -> float | None:
    length = errors[name]
    return None if length is None else relative(length, errors["diagonal"] or 0.0)


def _with_relatives(errors: dict[str, float | None]) -> dict[str, object]:
    lengths = {name: errors[name] for name in _LENGTHS}
    relatives = {f"{name}_relative": _relative(errors, name) for name in _LENGTHS}
    angles = {f"{name}_degrees": errors[name] for name in _ANGLES}
    return {**lengths, **relatives, **angles, "diagonal": errors["diagonal"]}


def _rows(errors: dict[str, float | None]) -> Iterator[tuple[str, str, str]]:
    def cell(value: float | None) -> str:
        return "-" if value is None else number(value)

    yield "", "unit of A", "of the diagonal"
    for name, label in _LENGTHS.items():
        yield label, cell(errors[name]), cell(_relative(errors, name))
    yield "", "degrees", ""
    for name, label in _ANGLES.items():
        yield label, cell(errors[name]), ""


def _as_object(one: Difference) -> dict[str, object]:
    a = one.attribute
    kind = {"type": str(a.values.dtype), "width": a.width}
    return {"name": a.name, "domain": a.domain, **kind, "largest_difference": one.largest}


def _attribute_rows(attributes: _Differences) -> Iterator[tuple[str, str, str, str]]:
    yield "attribute", "of", "type", "largest difference"
    for one in attributes:
        a = one.attribute
        largest = "not in B" if one.largest is None else number(one.largest)
        yield shown(a.name), a.domain, f"{a.values.dtype} x {a.width}", largest
