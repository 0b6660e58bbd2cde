"""Meshes in files: parsing, decoding and writing them, with failures that name the file."""

from __future__ import annotations

import io
import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from deltamesh._progress import Progress
from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt
from deltamesh_cli.output import display_name, message
from deltamesh_cli.signals import interruptible
from deltamesh_formats.container.layout import MAGIC
from deltamesh_formats.meshfiles.formats import (
    advice,
    format_of_beginning,
    format_of_extension,
)
from deltamesh_formats.places import parent

if TYPE_CHECKING:
    from deltamesh._measures.report import Report
    from deltamesh_formats.container.container import Container
    from deltamesh_formats.polymesh.mesh import PolyMesh


# A least-squares mesh that keeps less of its area has collapsed: on well-known meshes, that happens
# below 0.1 to 0.3 % of anchors. With 1 % they keep nine tenths of it.
COLLAPSED: Final = 0.75
ENOUGH_ANCHORS: Final = 0.01


@dataclass(frozen=True)
class LoadedMesh:
    """A mesh, the size of its file in bytes, and the sections of the file if it is a `.dmesh`."""

    mesh: PolyMesh
    size: int
    container: Container | None


def parse_mesh(name: str, data: bytes, file_format: str | None, progress: Progress) -> PolyMesh:
    """Return the mesh in the bytes of a file; without `file_format`, its name determines it.

    Raises
    ------
    Failure
        If the bytes are not a mesh.
    """
    progress("reading")
    named = file_format or files.extension(name)
    with attempt(name, "cannot read", _format_hint(named, data)):
        from deltamesh_formats.meshfiles.files import read_mesh

        folder = None if name == files.STDIO else parent(name)
        return read_mesh(io.BytesIO(data), named, folder=folder)


def _format_hint(named: str, data: bytes) -> str:
    """Return a remedy for a file that cannot be read as the format `named`."""
    if data.startswith(MAGIC):
        return "deltamesh decode turns it into a mesh file"
    known, likely = format_of_extension(named), format_of_beginning(data)
    if likely not in (None, known):
        return f"it begins like {likely.title}: --input-format {likely.name}"
    return "" if known is not None or advice(named) else "--input-format names the format"


def write_mesh_file(
    name: str, mesh: PolyMesh, file_format: str, digits: int | None, *, force: bool
) -> tuple[str, ...]:
    """Write a mesh file, or a mesh to standard output, and describe what the format cannot hold.

    `digits` are the decimal places of positions in a text. With `force` an existing file is
    overwritten.

    Raises
    ------
    Failure
        If it cannot be written.
    """
    from deltamesh_formats.meshfiles.files import written

    with attempt(name, "cannot write"):
        made = written(mesh, file_format, digits)
    files.write_output(name, made.data, force=force)
    return made.lost


def note_not_kept(name: str, lost: Collection[str], *, quiet: bool) -> None:
    """Note on standard error, in one line, the content of a mesh that is not kept."""
    if lost and not quiet:
        listed = ", ".join(map(display_name, lost))
        message(f"note: {display_name(name)}: {listed} are not kept")


def note_prefix(name: str, container: Container, *, quiet: bool) -> None:
    """Note on standard error how far a file that is cut reaches, and what it lacks."""
    if container.is_whole or quiet:
        return
    from deltamesh_formats.container.lines import prefix_text

    told = f"{prefix_text(container)}; the checksum of its content cannot be verified"
    message(f"note: {display_name(name)}: {told}")


def note_faces(name: str, report: Report | None, *, quiet: bool) -> None:
    """Note on standard error the faces that have lost their area, or have turned over."""
    if report is None or quiet:
        return
    fates = ((report.lost, "lost their area"), (report.turned, "turned over"))
    told = [f"that {fate}: {len(of)}, the first in face {of[0]}" for of, fate in fates if len(of)]
    if told:
        message(f"note: {display_name(name)}: triangles {', '.join(told)}")


def note_collapse(name: str, report: Report | None, container: Container, *, quiet: bool) -> None:
    """Note on standard error a surface of 0 bits that has too few anchors to keep its shape."""
    parameters = container.parameters
    is_bare = parameters.anchor_count > 0 and not parameters.step
    if report is None or quiet or not is_bare or report.area >= COLLAPSED:
        return
    enough = max(2 * parameters.anchor_count, math.ceil(ENOUGH_ANCHORS * container.vertices))
    few = f"with 0 bits and anchors as few as {parameters.anchor_count}"
    left = f"{100 * report.area:.0f} % of the area is left"
    advice = f"--anchors {min(enough, container.vertices)} keeps more of the shape"
    message(f"note: {display_name(name)}: {few}, {left}: {advice}")


def memory_notes(name: str, container: Container) -> list[str]:
    """Return a note, if decoding takes more memory than the default limit."""
    from deltamesh._limits import DEFAULT_MEMORY, memory_needed

    needed = memory_needed(container)
    if needed <= DEFAULT_MEMORY:
        return []
    text = "decoding needs more memory than its default limit"
    return [f"{display_name(name)}: {text}: give deltamesh decode --memory {-(-needed >> 30)}G"]


def parse_container(name: str, data: bytes, problem: str, *, partial: bool = False) -> Container:
    """Return the sections of a `.dmesh` file, checked but not decoded; it may be cut if `partial`.

    Raises
    ------
    Failure
        If the bytes are not a valid file; `problem` names the step that is impossible then.
    """
    from deltamesh_formats.container.reader import read_container, read_prefix

    with attempt(name, problem):
        return read_prefix(data) if partial else read_container(data)


def decode_container(
    name: str, container: Container, progress: Progress, *, partial: bool = False, **parameters: Any
) -> PolyMesh:
    """Return the mesh of a `.dmesh` file; `parameters` are the keywords of `deltamesh.decode`.

    A file that is cut is decoded as far as it goes if `partial`.

    Raises
    ------
    Failure
        If it cannot be decoded, or exceeds the limits.
    """
    with attempt(name, "cannot decode"):
        import deltamesh
        from deltamesh._machine import return_freed_memory

        return_freed_memory()
        keywords = options.specified(parameters) | {"progress": progress}
        mesh: PolyMesh
        if partial:
            mesh = interruptible(lambda: deltamesh.decode(container, partial=True, **keywords).mesh)
        else:
            mesh = interruptible(lambda: deltamesh.decode(container, **keywords))
        return mesh


def further_frames(name: str, container: Container) -> tuple[str, ...]:
    """Return a description of the frames beyond the first, none if there is one.

    Raises
    ------
    Failure
        If the table of the frames is damaged.
    """
    with attempt(name, "cannot decode"):
        count = container.frame_count
    return (f"frames 1 to {count - 1} of a sequence",) if count > 1 else ()


def load_mesh(
    name: str,
    file_format: str | None,
    progress: Progress,
    *,
    quiet: bool = False,
    **parameters: Any,
) -> LoadedMesh:
    """Read a mesh file or decode a `.dmesh`; its first bytes decide which, not its name.

    Of a sequence that is frame 0; a note says so unless it is to be `quiet`.

    Raises
    ------
    Failure
        If it is neither, or exceeds the limits.
    """
    from deltamesh._mesh import LARGEST
    from deltamesh_formats.polymesh.validation import checked

    raw = files.read_raw(name)
    data = files.unwrapped_input(name, raw, parameters)
    if data[: len(MAGIC)] == MAGIC:
        container = parse_container(name, data, "cannot decode")
        mesh = decode_container(name, container, progress, **parameters)
        for others in () if quiet else further_frames(name, container):
            message(f"note: {display_name(name)}: frame 0, without {others}")
        return LoadedMesh(mesh, len(raw), container)
    mesh = parse_mesh(name, data, file_format, progress)
    with attempt(name, "cannot read"):
        size = files.source_size(name, raw, file_format)
        return LoadedMesh(checked(mesh, LARGEST), size, None)
