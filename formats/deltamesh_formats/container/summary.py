"""Summaries of `.dmesh` files and meshes for people: as text and, for notebooks, as HTML.

Names in it come from files: control characters are escaped in the text, and all in the HTML.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from deltamesh_formats.container.container import Container, Meta, Parameters
from deltamesh_formats.container.fields import read_varint
from deltamesh_formats.container.layout import ATTRIBUTES, FRAMES, ORDER, POLYGONS, STEPS
from deltamesh_formats.container.listing import pose_lines, text_lines
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.payload_layout import PER_OCTAVE, QUARTERS
from deltamesh_formats.container.pose_table import entries_of as poses_of
from deltamesh_formats.container.regions import regions_of
from deltamesh_formats.container.stages import awaited, stage_of, stages_of
from deltamesh_formats.container.texts import texts_of
from deltamesh_formats.errors import FormatError
from deltamesh_formats.printing import html_table, number, printable, table

if TYPE_CHECKING:
    from deltamesh_formats.container.attribute_table import Entry
    from deltamesh_formats.container.frame_table import Frame

# Key frames that are listed.
_MOST_KEYS = 8


def bits_per_vertex(size: int, vertices: int) -> float:
    """Return bits per vertex of `size` bytes."""
    return 8 * size / max(vertices, 1)


def relative(length: float, diagonal: float) -> float:
    """Return a length as a fraction of the bounding box diagonal; a point has none."""
    return length / diagonal if diagonal else 0.0


def header_bytes(container: Container) -> int:
    """Return the bytes before the first section."""
    return container.size - sum(section.size for section in container.sections.values())


def polygons(container: Container) -> int:
    """Return how many polygons a file has; it may be damaged there, which decoding tells.

    Without any of more than three corners, these are the faces.
    """
    if POLYGONS not in container.sections:
        return container.triangles
    try:
        return read_varint(memoryview(container.sections[POLYGONS].payload), 0)[0]
    except FormatError:
        return container.triangles


def finest_step(container: Container) -> float:
    """Return the finest step of any vertex; it may be damaged there, which decoding tells."""
    finest = 0
    if STEPS in container.sections:
        payload = container.sections[STEPS].payload
        finest = max(payload[1 : 1 + payload[0]], default=0) if payload else 0
    octaves, quarter = divmod(finest, PER_OCTAVE)
    return container.parameters.step * QUARTERS[quarter] / (1 << octaves)


def counts(container: Container) -> str:
    """Return vertices, faces and bits per vertex, in words; of a sequence, per vertex and frame."""
    frames = container.frame_count
    rate = bits_per_vertex(container.size, container.vertices * frames)
    faces = f"{container.triangles} faces"
    if POLYGONS in container.sections:
        faces = f"{polygons(container)} polygons ({container.triangles} triangles)"
    each = " and frame" if frames > 1 else ""
    return f"{container.vertices} vertices, {faces}, {rate:.2f} bits per vertex{each}"


def achieved(meta: Meta) -> str:
    """Return the errors that the encoder measured, in words."""
    return (
        f"RMS {number(relative(meta.rms, meta.diagonal))} and"
        f" max {number(relative(meta.max, meta.diagonal))} of the diagonal,"
        f" normals {number(meta.normal)} and dihedral angles {number(meta.dihedral)} degrees"
    )


def achieved_in_worst_part(meta: Meta) -> str:
    """Return what the encoder measured of the part that is kept worst, in words."""
    return (
        f"worst of {meta.parts} parts: {printable(meta.part)}, normals"
        f" {number(meta.part_normal)} degrees, RMS {number(meta.part_rms)} of its own diagonal"
    )


def worst_frame(frames: Sequence[Frame]) -> Frame:
    """Return the frame beyond the first that is kept worst, of normals and RMS as they count alike.

    A bound of quality 5 is 1 degree for normals, and 1.5e-3 of the diagonal for the RMS distance.
    """
    return max(frames, key=lambda frame: max(frame.normal / 1.0, frame.rms / 1.5e-3))


def frame_lines(container: Container) -> Iterator[str]:
    """Yield lines about the frames of a sequence, in words; none for one mesh.

    Raises
    ------
    FormatError
        If the table of the frames is damaged.
    """
    frames = container.frames
    if not frames:
        return
    rate = "" if container.fps is None else f" at {number(container.fps)} a second"
    keys = [0, *(frame.index for frame in frames if frame.is_key)]
    shown = ", ".join(map(str, keys[:_MOST_KEYS])) + (" ..." if len(keys) > _MOST_KEYS else "")
    yield f"frames: {len(frames) + 1}{rate}, key frames {shown}"
    sizes = [frame.size for frame in frames]
    mean = sum(sizes) / len(sizes)
    most = f", {min(sizes)} to {max(sizes)}" if min(sizes) < max(sizes) else ""
    yield (
        f"bytes of a further frame: {mean:.0f}{most};"
        f" {bits_per_vertex(round(mean), container.vertices):.2f} bits per vertex"
    )
    worst = worst_frame(frames)
    yield (
        f"worst further frame: {worst.index}, RMS {number(worst.rms)} and max {number(worst.max)}"
        f" of its diagonal, normals {number(worst.normal)} and dihedral angles"
        f" {number(worst.dihedral)} degrees"
    )


def region_lines(container: Container) -> Iterator[str]:
    """Yield the errors of what is important and of the rest, if a file weighs them.

    Raises
    ------
    FormatError
    """
    r, meta = regions_of(container), container.meta
    if r is None or meta is None:
        return
    scale = meta.diagonal
    full = r.rms_full, r.max_full, r.normal_full, r.dihedral_full
    rest = r.rms_reduced, r.max_reduced, r.normal_reduced, r.dihedral_reduced
    without = f", {r.none} of them without bits" if r.none else ""
    yield f"errors are weighted: importance 1 of {r.full} vertices: {_four(full, scale)}"
    others = f"less importance of {r.reduced + r.none} vertices{without}"
    yield f"{others}: {_four(rest, scale)}"


def _four(errors: tuple[float, float, float, float], scale: float) -> str:
    rms, largest, normal, dihedral = errors
    lengths = f"RMS {number(relative(rms, scale))}, max {number(relative(largest, scale))}"
    return f"{lengths}, normals {number(normal)}, dihedral angles {number(dihedral)}"


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


def prefix_text(container: Container) -> str:
    """Return how far a file that is cut reaches, and what it lacks."""
    stage, cut, absent = stage_of(container), container.cut, awaited(container)
    text = f"stage {stage}" if stage else "no positions yet"
    text += f", {container.size} bytes" + (f", then {cut} is cut" if cut else "")
    lacking = f"; not there yet, if the file has them: {', '.join(absent)}" if absent else ""
    return text + lacking


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


def attributes_of(container: Container) -> Sequence[Entry]:
    """Return the entries of the attributes of a file.

    Raises
    ------
    FormatError
        If that is damaged.
    """
    if ATTRIBUTES not in container.sections:
        return ()
    from deltamesh_formats.container.attribute_table import entries_of  # which needs numpy

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
        # A grid of a given error has no bits.
        bits = str(entry.bits or "") if entry.coding in ("grid", "octahedral") else ""
        yield printable(entry.name), entry.domain, numbers, coding, bits, lost, str(entry.size)


def _section_rows(container: Container) -> Iterator[tuple[str, ...]]:
    sizes = [("header", header_bytes(container))]
    sizes += [(section.id, section.size) for section in container.sections.values()]
    yield "section", "bytes", "bits/vertex"
    for name, size in [*sizes, ("total", container.size)]:
        yield name, str(size), f"{bits_per_vertex(size, container.vertices):.3f}"
