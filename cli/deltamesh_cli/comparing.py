"""Comparison of two meshes for `deltamesh compare`: metrics, attributes and parts, and their print.

The library measures; here the results get the names that `--json` and the tables use.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from deltamesh._measures.table import METRICS
from deltamesh._progress import Progress
from deltamesh_cli.meshes import LoadedMesh
from deltamesh_cli.output import display_name, number, table
from deltamesh_cli.summary import part_object
from deltamesh_formats.container.figures import bits_per_vertex, relative
from deltamesh_formats.polymesh.kinds import KIND_WORDS

if TYPE_CHECKING:
    from deltamesh._compare.likeness import Correspondence, Difference
    from deltamesh._measures.report import Report
    from deltamesh._mesh import TriangleMesh
    from deltamesh_formats.array_types import Floats, Ints
    from deltamesh_formats.polymesh.kinds import Kind
    from deltamesh_formats.polymesh.mesh import PolyMesh

    _Errors: TypeAlias = dict[str, float | None]

_LENGTHS: Final = {metric.name: metric.title for metric in METRICS if metric.is_length}
_ANGLES: Final = {metric.name: metric.title for metric in METRICS if not metric.is_length}


@dataclass(frozen=True)
class Comparison:
    """Result of comparing mesh B with mesh A.

    Attributes
    ----------
    a, b : LoadedMesh
    errors : dict
        Every metric by its name; None if it needs corresponding vertices and there are none.
    attributes : tuple of Difference, or None
        The difference of each attribute of A; None if the faces do not correspond.
    other_parts : tuple of str, or None
        The kinds of parts of A that differ in B or are missing there; None if the faces do not
        correspond.
    report : Report or None
        What became of the parts and faces of A; None if the vertices do not correspond.
    match : Correspondence or None
        The vertices that correspond, if they do.
    """

    a: LoadedMesh
    b: LoadedMesh
    errors: _Errors
    attributes: tuple[Difference, ...] | None = None
    other_parts: tuple[Kind, ...] | None = None
    report: Report | None = None
    match: Correspondence | None = None


def compare_meshes(a: LoadedMesh, b: LoadedMesh, progress: Progress) -> Comparison:
    """Measure mesh B against mesh A."""
    from deltamesh._compare import likeness
    from deltamesh._measures import metrics
    from deltamesh._mesh import TriangleMesh, triangulated
    from deltamesh._shape.complexes import distinct_faces
    from deltamesh_formats.container.method_layouts import METHODS

    progress("matching vertices")
    containers = [one.container for one in (a, b) if one.container]
    exact = any(METHODS[container.parameters.method].exact for container in containers)
    match = likeness.corresponding(a.mesh, b.mesh, exact)
    if match is None:
        progress("measuring surfaces")
        first, second = triangulated(a.mesh), triangulated(b.mesh)
        surfaces = {"hausdorff": metrics.hausdorff(first, second)}
        diagonal = metrics.diagonal(first.vertices)
        unknown = dict.fromkeys([*_LENGTHS, *_ANGLES])
        return Comparison(a, b, {**unknown, **surfaces, "diagonal": diagonal})
    progress("measuring")
    cut = match.a.mesh.triangulation()
    kept = distinct_faces(cut.faces)
    reference = TriangleMesh(match.a.mesh.vertices, cut.faces[kept])
    paired = TriangleMesh(match.b.mesh.vertices[match.sites], reference.faces)
    errors = vars(metrics.compare(reference, paired))
    report = _report(a.mesh, reference, cut.polygon[kept], paired.vertices)
    pairs = likeness.matched_corners(a.mesh, b.mesh, match)
    if pairs is None:
        return Comparison(a, b, errors, report=report, match=match)
    attributes = likeness.differences(a.mesh, b.mesh, pairs)
    other_parts = likeness.other_parts(a.mesh, b.mesh, pairs)
    return Comparison(a, b, errors, attributes, other_parts, report, match)


def _report(mesh: PolyMesh, reference: TriangleMesh, polygons: Ints, others: Floats) -> Report:
    """Return what becomes of the parts and faces of a mesh at other positions of its sites."""
    from deltamesh._graph.adjacency import components_of_faces
    from deltamesh._measures.measure import Measure
    from deltamesh._measures.named_parts import named_parts
    from deltamesh._measures.report import report_of

    V, F = reference.vertices, reference.faces
    named = named_parts(mesh, F, polygons, components_of_faces(F, len(V)))
    return report_of(Measure(V, F, named.parts)(others), named)


def comparison_object(name_a: str, name_b: str, comparison: Comparison) -> dict[str, object]:
    """Return a comparison for `--json`; the names are those of the files."""
    attributes = parts = None
    if comparison.attributes is not None:
        attributes = [_attribute_object(one) for one in comparison.attributes]
    if comparison.other_parts is not None:
        keys = ("kind", "a", "b", "alike")
        parts = [dict(zip(keys, row, strict=True)) for row in _parts(comparison)]
    return {
        "a": _file_object(name_a, comparison.a),
        "b": _file_object(name_b, comparison.b),
        "errors": {
            **_errors_object(comparison.errors),
            **_report_object(comparison.report),
        },
        "attributes": attributes,
        "parts": parts,
    }


def comparison_text(name_a: str, name_b: str, comparison: Comparison) -> str:
    """Return a comparison as text for people; the names are those of the files."""
    lines = f"{_file_line(name_a, comparison.a)}\n{_file_line(name_b, comparison.b)}"
    return "\n\n".join([lines, *map(table, comparison_tables(comparison))])


def comparison_tables(comparison: Comparison) -> list[list[tuple[str, ...]]]:
    """Return the rows of the tables that show a comparison; the first row of most is a head."""
    a, b = comparison.a, comparison.b
    tables: list[list[tuple[str, ...]]] = [list(_error_rows(comparison.errors))]
    if comparison.attributes:
        tables.append(list(_attribute_rows(comparison.attributes)))
    if comparison.report is not None and (rows := list(_report_rows(comparison.report))):
        tables.insert(1, rows)
    if comparison.other_parts is not None and (a.mesh.parts or b.mesh.parts):
        tables.append(list(_part_rows(comparison)))
    return tables


def _file_object(name: str, loaded: LoadedMesh) -> dict[str, object]:
    vertices, rate = len(loaded.mesh.vertices), None
    if loaded.container is not None:
        rate = bits_per_vertex(loaded.size, vertices)
    counts = {"vertices": vertices, "faces": len(loaded.mesh.sizes)}
    return {"file": name, "bytes": loaded.size, **counts, "bits_per_vertex": rate}


def _file_line(name: str, loaded: LoadedMesh) -> str:
    vertices, faces = len(loaded.mesh.vertices), len(loaded.mesh.sizes)
    text = f"{display_name(name)}: {loaded.size} bytes, {vertices} vertices, {faces} faces"
    if loaded.container is None:
        return text
    return f"{text}, {bits_per_vertex(loaded.size, vertices):.2f} bits per vertex"


def _relative(errors: _Errors, name: str) -> float | None:
    length = errors[name]
    return None if length is None else relative(length, errors["diagonal"] or 0.0)


def _errors_object(errors: _Errors) -> dict[str, object]:
    lengths = {name: errors[name] for name in _LENGTHS}
    relatives = {f"{name}_relative": _relative(errors, name) for name in _LENGTHS}
    angles = {f"{name}_degrees": errors[name] for name in _ANGLES}
    return {**lengths, **relatives, **angles, "diagonal": errors["diagonal"]}


def _error_rows(errors: _Errors) -> Iterator[tuple[str, str, str]]:
    def cell(value: float | None) -> str:
        return "-" if value is None else number(value)

    yield "", "unit of A", "of the diagonal"
    for name, label in _LENGTHS.items():
        yield label, cell(errors[name]), cell(_relative(errors, name))
    yield "", "degrees", ""
    for name, label in _ANGLES.items():
        yield label, cell(errors[name]), ""


def _report_object(report: Report | None) -> dict[str, object]:
    keys = ("triangles_lost", "triangles_turned", "parts", "worst_part")
    if report is None:
        return dict.fromkeys(keys)
    worst = report.worst
    part = None if worst is None else part_object(**vars(worst))
    values = (len(report.lost), len(report.turned), report.parts, part)
    return dict(zip(keys, values, strict=True))


def _report_rows(report: Report) -> Iterator[tuple[str, ...]]:
    worst = report.worst
    if worst is not None:
        yield f"worst of {report.parts} parts", display_name(worst.name)
        yield "  face normals, degrees", number(worst.normal_deviation)
        yield "  RMS, of its own diagonal", number(worst.relative_rms)
    for faces, fate in ((report.lost, "lost their area"), (report.turned, "turned over")):
        if len(faces):
            yield f"triangles that {fate}", f"{len(faces)}, the first in face {faces[0]}"


def _attribute_object(one: Difference) -> dict[str, object]:
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
        yield display_name(a.name), a.domain, f"{a.width} {a.values.dtype}", largest


def _parts(comparison: Comparison) -> Iterator[tuple[Kind, int, int, bool]]:
    """Yield each kind of parts that A or B has, its numbers in A and B, and whether they agree."""
    counts_a, counts_b = (
        {part.kind: len(part.names) for part in one.mesh.parts}
        for one in (comparison.a, comparison.b)
    )
    other = comparison.other_parts or ()
    for kind in dict.fromkeys([*counts_a, *counts_b]):
        alike = kind in counts_a and kind not in other
        yield kind, counts_a.get(kind, 0), counts_b.get(kind, 0), alike


def _part_rows(comparison: Comparison) -> Iterator[tuple[str, ...]]:
    yield "parts", "in A", "in B", ""
    for kind, count_a, count_b, alike in _parts(comparison):
        yield KIND_WORDS[kind], str(count_a), str(count_b), "alike" if alike else "not alike"
