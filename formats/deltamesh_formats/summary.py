"""What a `.dmesh` file or a mesh is, for people: as text and, for notebooks, as HTML.

Names in it come from files: control characters are escaped in the text, and all in the HTML.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, Final

from deltamesh_formats.errors import FormatError
from deltamesh_formats.layout import ATTRIBUTES, ORDER, POLYGONS, Container, Meta, Parameters
from deltamesh_formats.listing import printable, text_lines
from deltamesh_formats.reader import read_varint
from deltamesh_formats.texts import texts_of

if TYPE_CHECKING:
    from deltamesh_formats.attribute_table import Entry
    from deltamesh_formats.polymesh import PolyMesh

METHODS: Final = {
    "highpass": "high-pass",
    "refined": "refined high-pass",
    "cartesian": "Cartesian",
    "lossless": "lossless",
}
_FACES: Final = {3: "triangles", 4: "quads"}


def bits_per_vertex(size: int, vertices: int) -> float:
    """Return bits per vertex of `size` bytes."""
    return 8 * size / max(vertices, 1)


def relative(length: float, diagonal: float) -> float:
    """Return a length as a fraction of the bounding box diagonal; a point has none."""
    return length / diagonal if diagonal else 0.0


def number(value: float) -> str:
    """Return a measured number with four significant digits."""
    return f"{value:.4g}"


def table(rows: Iterable[Sequence[str]], indent: str = "  ") -> str:
    """Return rows as aligned columns: the first to the left, all others to the right."""
    cells = [list(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join((indent + "  ".join(_aligned(row, widths))).rstrip() for row in cells)


def _aligned(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    first = row[0].ljust(widths[0])
    return [first, *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True))]


def header_bytes(container: Container) -> int:
    """Return the bytes before the first section."""
    return container.size - sum(section.size for section in container.sections.values())


def polygons(container: Container) -> int:
    """Return how many polygons a file has; it may be damaged there, which decoding tells.

    Without any of more than three corners, these are the faces.
    """
    if POLYGONS not in container.sections:
        return container.faces
    try:
        return read_varint(memoryview(container.sections[POLYGONS].payload), 0)[0]
    except FormatError:
        return container.faces


def counts(container: Container) -> str:
    """Return vertices, faces and bits per vertex, in words."""
    rate = bits_per_vertex(container.size, container.vertices)
    faces = f"{container.faces} faces"
    if POLYGONS in container.sections:
        faces = f"{polygons(container)} polygons ({container.faces} triangles)"
    return f"{container.vertices} vertices, {faces}, {rate:.2f} bits per vertex"


def achieved(meta: Meta) -> str:
    """Return the errors that the encoder measured, in words."""
    return (
        f"RMS {number(relative(meta.rms, meta.diagonal))} and"
        f" max {number(relative(meta.max, meta.diagonal))} of the diagonal,"
        f" normals {number(meta.normal)} and dihedral angles {number(meta.dihedral)} degrees"
    )


def container_text(container: Container) -> str:
    """Return everything about a file, as `deltamesh info` prints it after the name."""
    lines = [_headline(container), *(f"  {line}" for line in _lines(container))]
    lines += ["", table(_section_rows(container))]
    if attributes := attributes_of(container):
        lines += ["", table(_attribute_rows(attributes))]
    return "\n".join(lines)


def container_html(container: Container) -> str:
    """Return the same for a notebook."""
    lines = "<br>\n".join(map(escape, [_headline(container), *_lines(container)]))
    head, *rows = _section_rows(container)
    tables = [_html_table(rows, head)]
    if attributes := attributes_of(container):
        head, *rows = _attribute_rows(attributes)
        tables.append(_html_table(rows, head))
    return "\n".join(["<div>", lines, *tables, "</div>"])


def _headline(container: Container) -> str:
    return f"{container.size} bytes, {counts(container)}"


def _lines(container: Container) -> Iterator[str]:
    meta = container.meta
    yield from _described(container.parameters)
    if ORDER in container.sections:
        yield "order of vertices and faces: that of the source"
    yield from text_lines(texts_of(container))
    if meta is not None:
        source = f", from {meta.source}" if meta.source else ""
        source += ", positions in float32" if container.parameters.single else ""
        yield f"errors: {achieved(meta)}"
        yield f"written by {meta.encoder}{source}; format version {container.version}"


def _described(parameters: Parameters) -> Iterator[str]:
    words = [] if parameters.bits is None else [f"{parameters.bits} bits"]
    if parameters.step:
        words.append(f"step {number(parameters.step)}")
        if parameters.method == "refined":
            words.append(f"deltas {number(parameters.coarse)} times as coarse")
        if parameters.method != "cartesian":
            words.append("error diffusion" if parameters.diffusion else "plain rounding")
    yield ": ".join(filter(None, (METHODS[parameters.method], ", ".join(words))))
    if parameters.anchor_method is not None:
        seed = f", seed {parameters.seed}" if parameters.anchor_method == "random" else ""
        yield f"anchors: {parameters.anchor_count}, {parameters.anchor_method}{seed}"
    if parameters.isolated:
        yield f"isolated vertices: {parameters.isolated}"


def attributes_of(container: Container) -> Sequence[Entry]:
    """Return what a file tells of its attributes.

    Raises
    ------
    FormatError
        If that is damaged.
    """
    if ATTRIBUTES not in container.sections:
        return ()
    from deltamesh_formats.attribute_table import entries_of  # which needs numpy

    return entries_of(container)


def _attribute_rows(attributes: Sequence[Entry]) -> Iterator[tuple[str, ...]]:
    yield "attribute", "of", "numbers", "coding", "bits", "largest error", "bytes"
    for entry in attributes:
        numbers = f"{entry.width} {entry.dtype}"
        if entry.coding == "octahedral":
            lost = f"{number(entry.error)} degrees"
        else:
            lost = number(entry.error) if entry.error else "none"
        coding = entry.coding if entry.palette is None else f"{entry.coding}, palette"
        bits = str(entry.bits) if entry.coding in ("grid", "octahedral") else ""
        yield printable(entry.name), entry.domain, numbers, coding, bits, lost, str(entry.size)


def _section_rows(container: Container) -> Iterator[tuple[str, ...]]:
    sizes = [("header", header_bytes(container))]
    sizes += [(section.id, section.size) for section in container.sections.values()]
    yield "section", "bytes", "bits/vertex"
    for name, size in [*sizes, ("total", container.size)]:
        yield name, str(size), f"{bits_per_vertex(size, container.vertices):.3f}"


def mesh_text(mesh: PolyMesh) -> str:
    """Return one line about a mesh: counts, and what else it holds."""
    facts = [f"{what} {words}" for what, words in _mesh_facts(mesh)]
    return f"<PolyMesh: {'; '.join([_mesh_counts(mesh), *facts])}>"


def mesh_html(mesh: PolyMesh) -> str:
    """Return the same for a notebook."""
    rows = [(what.removesuffix(":"), words) for what, words in _mesh_facts(mesh)]
    return f"<div>\n{escape(_mesh_counts(mesh))}\n{_html_table(rows)}\n</div>"


def _mesh_counts(mesh: PolyMesh) -> str:
    sizes = mesh.sizes
    least, most = (int(sizes.min()), int(sizes.max())) if len(sizes) else (3, 3)
    what = _FACES.get(least, f"faces of {least} corners")
    if most > least:
        what = f"faces of {least} to {most} corners"
    return f"{len(mesh.vertices)} vertices, {len(sizes)} {what}"


def _mesh_facts(mesh: PolyMesh) -> Iterator[tuple[str, str]]:
    for domain in ("vertex", "corner", "face"):
        words = [_array(a.name, a.values) for a in mesh.attributes if a.domain == domain]
        if words:
            yield f"{domain} data:", ", ".join(words)
    for parts in mesh.parts:
        yield f"{parts.kind}:", f"{len(parts.names)} parts"
    if mesh.metadata:
        yield "metadata:", ", ".join(map(printable, mesh.metadata))
    if mesh.lost:
        yield "lost:", ", ".join(map(printable, mesh.lost))


def _array(name: str, values: Any) -> str:
    width = f" x {values.shape[1]}" if values.shape[1] != 1 else ""
    return f"{printable(name)} ({values.dtype}{width})"


def _html_table(rows: Iterable[Sequence[str]], head: Sequence[str] = ()) -> str:
    lines = [_html_row(head, "th")] if head else []
    return "\n".join(["<table>", *lines, *(_html_row(row, "td") for row in rows), "</table>"])


def _html_row(cells: Sequence[str], tag: str) -> str:
    return f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells)}</tr>"
