"""Summaries of `.dmesh` files for people: as text and, for notebooks, as HTML.

Names in it come from files: control characters are escaped in the text, and all in the HTML.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.container.figures import (
    attributes_of,
    bits_per_vertex,
    finest_step,
    header_bytes,
)
from deltamesh_formats.container.layout import FRAMES, ORDER
from deltamesh_formats.container.lines import (
    achieved,
    achieved_in_worst_part,
    counts,
    frame_lines,
    prefix_text,
    region_lines,
)
from deltamesh_formats.container.listing import pose_lines, text_lines
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.pose_table import entries_of as poses_of
from deltamesh_formats.container.stages import stages_of
from deltamesh_formats.container.texts import texts_of
from deltamesh_formats.printing import html_table, number, printable, table

if TYPE_CHECKING:
    from deltamesh_formats.container.attribute_entry import Entry


def container_text(container: Container) -> str:
    """Return everything about a file, as `deltamesh info` prints it after the name."""
    lines = [_headline(container), *(f"  {line}" for line in _lines(container))]
    lines += ["", table(_section_rows(container))]
    if attributes := attributes_of(container):
        lines += ["", table(_attribute_rows(attributes))]
    return "\n".join(lines)


def container_html(container: Container) -> str:
    """Return the same for a notebook."""
    from html import escape  # a large table, which texts do not need

    lines = "<br>\n".join(map(escape, [_headline(container), *_lines(container)]))
    head, *rows = _section_rows(container)
    tables = [html_table(rows, head)]
    if attributes := attributes_of(container):
        head, *rows = _attribute_rows(attributes)
        tables.append(html_table(rows, head))
    return "\n".join(["<div>", lines, *tables, "</div>"])


def _headline(container: Container) -> str:
    return f"{container.size} bytes, {counts(container)}"


def _lines(container: Container) -> Iterator[str]:
    meta = container.meta
    yield from _described(container.parameters, finest_step(container))
    yield from frame_lines(container)
    yield from _stages(container)
    if ORDER in container.sections:
        yield "order of vertices and faces: that of the source"
    yield from text_lines(texts_of(container))
    yield from pose_lines(poses_of(container))
    if meta is not None:
        source = f", from {meta.source}" if meta.source else ""
        source += ", positions in float32" if container.parameters.single else ""
        whose = "errors of frame 0" if FRAMES in container.sections else "errors"
        yield f"{whose}: {achieved(meta)}"
        if meta.parts > 1:
            yield achieved_in_worst_part(meta)
        yield from region_lines(container)
        if meta.lost or meta.turned:
            yield f"triangles that lost their area: {meta.lost}, that turned over: {meta.turned}"
        yield f"written by {meta.encoder}{source}; format version {container.version}"


def _stages(container: Container) -> Iterator[str]:
    """Yield the stages of a file, and what a prefix lacks."""
    reached = stages_of(container)
    if len(reached) > 1:
        sizes = (f"{stage} {size}" for stage, size in reached.items())
        yield f"stages, by their bytes: {', '.join(sizes)}"
    if not container.is_whole:
        yield prefix_text(container)


def _described(parameters: Parameters, finest: float) -> Iterator[str]:
    method = METHODS[parameters.method]
    facts = [] if parameters.bits is None else [f"{parameters.bits} bits"]
    if parameters.step:
        down = f" down to {number(finest)}" if finest < parameters.step else ""
        facts.append(f"step {number(parameters.step)}{down}")
        if method.coarse:
            facts.append(f"deltas {number(parameters.coarse)} times as coarse")
        if method.anchored:
            facts.append("error diffusion" if parameters.diffusion else "plain rounding")
    yield ": ".join(filter(None, (method.title, ", ".join(facts))))
    if parameters.anchor_method is not None:
        seed = f", seed {parameters.seed}" if parameters.anchor_method == "random" else ""
        chosen = f"{parameters.anchor_count}, {parameters.anchor_method}{seed}"
        yield f"anchors: {chosen}, {parameters.solution}"
    if parameters.isolated:
        yield f"isolated vertices: {parameters.isolated}"


def _attribute_rows(attributes: Sequence[Entry]) -> Iterator[tuple[str, ...]]:
    yield "attribute", "of", "numbers", "coding", "bits", "largest error", "bytes"
    for entry in attributes:
        numbers = f"{entry.width} {entry.dtype}"
        if entry.coding == "octahedral":
            lost = f"{number(entry.error)} degrees"
        else:
            lost = number(entry.error) if entry.error else "none"
        coding = entry.coding if entry.palette is None else f"{entry.coding}, palette"
        # A grid of a given error has no bits.
        bits = str(entry.bits or "") if entry.coding in ("grid", "octahedral") else ""
        yield printable(entry.name), entry.domain, numbers, coding, bits, lost, str(entry.size)


def _section_rows(container: Container) -> Iterator[tuple[str, ...]]:
    sizes = [("header", header_bytes(container))]
    sizes += [(section.id, section.size) for section in container.sections.values()]
    yield "section", "bytes", "bits/vertex"
    for name, size in [*sizes, ("total", container.size)]:
        yield name, str(size), f"{bits_per_vertex(size, container.vertices):.3f}"
