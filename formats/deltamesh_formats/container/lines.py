"""Lines about a `.dmesh` file for people: its counts, errors, frames and regions, in words.

Names in them come from files: control characters are escaped.
"""

from __future__ import annotations

from collections.abc import Iterator

from deltamesh_formats.container.container import Container, Meta
from deltamesh_formats.container.figures import bits_per_vertex, polygons, relative, worst_frame
from deltamesh_formats.container.layout import POLYGONS
from deltamesh_formats.container.regions import regions_of
from deltamesh_formats.container.stages import awaited, stage_of
from deltamesh_formats.printing import number, printable

# Key frames that are listed.
_MOST_KEYS = 8


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


def prefix_text(container: Container) -> str:
    """Return how far a file that is cut reaches, and what it lacks."""
    stage, cut, absent = stage_of(container), container.cut, awaited(container)
    text = f"stage {stage}" if stage else "no positions yet"
    text += f", {container.size} bytes" + (f", then {cut} is cut" if cut else "")
    lacking = f"; not there yet, if the file has them: {', '.join(absent)}" if absent else ""
    return text + lacking
