"""`deltamesh compare`: two meshes, every metric."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import click

from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.meshes import Loaded, load_any
from deltamesh_cli.output import number, print_json, shown, table
from deltamesh_cli.progress import Stage, progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.summary import bits_per_vertex, relative
from deltamesh_formats.polymesh.kinds import KIND_WORDS

if TYPE_CHECKING:
    from deltamesh._compare.likeness import Difference
    from deltamesh_formats.polymesh.kinds import Kind

    _Errors: TypeAlias = dict[str, float | None]
    _Named: TypeAlias = tuple[str, Loaded]

# The metrics of deltamesh._measures.metrics.Errors, and what they are called here.
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
Of each attribute of A the largest difference, of normals the largest angle.
Parts (objects, groups, materials) are alike where the same faces have the
same names."""
_EXAMPLES = """\
deltamesh compare bunny.ply bunny.ply.dmesh
deltamesh compare scan.glb scan.obj     what has a conversion done?
deltamesh compare --json a.obj b.obj | jq .errors.hausdorff
"""


@dataclass(frozen=True)
class _Found:
    """What was measured: None where it needs vertices or faces that correspond, and they do not.

    Attributes
    ----------
    errors : dict
        Every metric by its name.
    attributes : tuple of Difference, or None
        Of each attribute of A.
    other_parts : tuple of str, or None
        The kinds of parts of A that B has otherwise or not at all.
    """

    errors: _Errors
    attributes: tuple[Difference, ...] | None = None
    other_parts: tuple[Kind, ...] | None = None


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

    Each is a mesh file or a .dmesh file. Attributes and parts are compared too, face by face; what
    only B has is told of parts alone. Vertices and faces may be in another order, repeated
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
                found = interruptible(lambda: _measured(a, b, stage))
        if as_json:
            print_json(_as_object((name, a), (second, b), found))
        elif not quiet:
            click.echo(_as_text((name, a), (second, b), found))

    each([first], compare, as_json=as_json)


def _measured(a: Loaded, b: Loaded, stage: Stage) -> _Found:
    from deltamesh._compare import likeness
    from deltamesh._measures import metrics
    from deltamesh._mesh import TriangleMesh, triangulated
    from deltamesh._shape.complexes import distinct_faces
    from deltamesh_formats.container.layout import METHODS

    stage("matching vertices")
    containers = [one.container for one in (a, b) if one.container]
    exact = any(METHODS[container.parameters.method].exact for container in containers)
    found = likeness.corresponding(a.mesh, b.mesh, exact)
    if found is None:
        stage("measuring surfaces")
        first, second = triangulated(a.mesh), triangulated(b.mesh)
        surfaces = {"hausdorff": metrics.hausdorff(first, second)}
        diagonal = metrics.diagonal(first.vertices)
        unknown = dict.fromkeys([*_LENGTHS, *_ANGLES])
        return _Found({**unknown, **surfaces, "diagonal": diagonal})
    stage("measuring")
    faces = distinct_faces(found.a.mesh.triangles)
    reference = TriangleMesh(found.a.mesh.vertices, faces)
    paired = TriangleMesh(found.b.mesh.vertices[found.sites], faces)
    errors = vars(metrics.compare(reference, paired))
    pairs = likeness.matched_corners(a.mesh, b.mesh, found)
    if pairs is None:
        return _Found(errors)
    attributes = likeness.differences(a.mesh, b.mesh, pairs)
    return _Found(errors, attributes, likeness.other_parts(a.mesh, b.mesh, pairs))


def _as_object(a: _Named, b: _Named, found: _Found) -> dict[str, object]:
    attributes = parts = None
    if found.attributes is not None:
        attributes = [_attribute(one) for one in found.attributes]
    if found.other_parts is not None:
        keys = ("kind", "a", "b", "alike")
        told = _parts(a[1], b[1], found.other_parts)
        parts = [dict(zip(keys, one, strict=True)) for one in told]
    described = {"a": _described(*a), "b": _described(*b)}
    errors = _with_relatives(found.errors)
    return {**described, "errors": errors, "attributes": attributes, "parts": parts}


def _as_text(a: _Named, b: _Named, found: _Found) -> str:
    text = "\n".join(_line(*one) for one in (a, b))
    tables: list[list[tuple[str, ...]]] = [list(_rows(found.errors))]
    if found.attributes:
        tables.append(list(_attribute_rows(found.attributes)))
    if found.other_parts is not None and (a[1].mesh.parts or b[1].mesh.parts):
        tables.append(list(_part_rows(a[1], b[1], found.other_parts)))
    return "\n\n".join([text, *map(table, tables)])


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


def _attribute(one: Difference) -> dict[str, object]:
    a = one.attribute
    kind = {"type": str(a.values.dtype), "width": a.width}
    return {"name": a.name, "domain": a.domain, **kind, "largest_difference": one.largest}


def _attribute_rows(attributes: tuple[Difference, ...]) -> Iterator[tuple[str, str, str, str]]:
    yield "attribute", "of", "numbers", "largest difference"
    for one in attributes:
        a = one.attribute
        largest = "not in B"
        if one.largest is not None:
            unit = " degrees" if a.role == "normal" and one.largest else ""
            largest = f"{number(one.largest)}{unit}" if one.largest else "none"
        yield shown(a.name), a.domain, f"{a.width} {a.values.dtype}", largest


def _parts(a: Loaded, b: Loaded, other: tuple[Kind, ...]) -> Iterator[tuple[Kind, int, int, bool]]:
    """Yield each kind of parts that A or B has: how many there and here, and whether alike."""
    there, here = ({p.kind: len(p.names) for p in one.mesh.parts} for one in (a, b))
    for kind in dict.fromkeys([*there, *here]):
        yield kind, there.get(kind, 0), here.get(kind, 0), kind in there and kind not in other


def _part_rows(a: Loaded, b: Loaded, other: tuple[Kind, ...]) -> Iterator[tuple[str, ...]]:
    yield "parts", "in A", "in B", ""
    for kind, there, here, alike in _parts(a, b, other):
        yield KIND_WORDS[kind], str(there), str(here), "alike" if alike else "not alike"
