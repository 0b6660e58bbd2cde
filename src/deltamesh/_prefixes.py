"""Beginnings of files: what has come of one, decoded as far as it goes; SPEC.md 6.

The first sections make a shape, and each that follows a better one. A file that is cut anywhere is
decoded up to its last whole section, and a stream again and again, as its bytes come.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import BinaryIO, Final

from deltamesh._decode_options import DecodeOptions
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._methods import HIGHPASS, METHODS
from deltamesh._options import check_decoding
from deltamesh._pipeline.decoder import check_scale, positioned, proven_content, read_content
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import CELLS, NORMALS
from deltamesh_formats.container.reader import progress_of, read_prefix
from deltamesh_formats.container.stages import POSITIONS, WHOLE, awaited, stage_of
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh

# Bytes that are asked of a stream at once; fewer come where fewer are there.
_PIECE: Final = 1 << 16


@dataclass(frozen=True)
class Partial:
    """What the beginning of a file holds.

    Attributes
    ----------
    mesh : PolyMesh
    stage : str
        How far it reaches: "anchors", "deltas", "refinements", "positions", or "whole".
    absent : tuple of str
        What has not come, or would not have, if the file has it: "refinements", "attributes" ...
    size : int
        The bytes that are decoded: up to the end of the last whole section.
    """

    mesh: PolyMesh = field(repr=False)
    stage: str
    absent: tuple[str, ...]
    size: int

    @property
    def is_whole(self) -> bool:
        """Whether it is the whole file, whose checksum is right."""
        return self.stage == WHOLE


def decode_prefix(container: Container, options: DecodeOptions) -> Partial:
    """Decompress what has come of a file; see `deltamesh.decode`."""
    limits = options.max_vertices, options.memory, options.progress
    if container.is_whole:
        come, content = container, proven_content(container, *limits)
    else:
        come = solvable(container)
        content = read_content(come, *limits)
        check_scale(come, content.integers)
    mesh = positioned(come, content, options)
    return Partial(mesh, stage_of(container), awaited(container), container.size)


def solvable(container: Container) -> Container:
    """Return a prefix as a file of what it holds, from which positions follow.

    Until the vectors of the cells have come, positions are those of least squares: anchors that are
    interpolated without them show as spikes. Without refinements, a refined file is a high-pass one
    of coarse steps.

    Raises
    ------
    FormatError
        If there are no positions yet.
    """
    parameters, sections = container.parameters, container.sections
    method, stage = METHODS[parameters.method].layout, stage_of(container)
    if not stage:
        first = method.geometry[0]
        reason = f"truncated: section {first} has not come, without which no vertex has a position"
        raise FormatError(reason, container.size)
    if stage != POSITIONS and CELLS not in sections:
        parameters = replace(parameters, interpolated=False)
    if method.coarse and NORMALS not in sections:
        parameters = replace(parameters, method=HIGHPASS.layout.name)
    return replace(container, parameters=parameters)


def stages(
    stream: BinaryIO,
    *,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
) -> Iterator[Partial]:
    """Decode a stream as its bytes come, and yield the mesh of each stage that it reaches.

    A stage is left out where the next one is there as soon. The last one is "whole", unless the
    stream ends before.

    Parameters
    ----------
    stream : binary file object
        Such as an HTTP response, or standard input; read to its end, as far as bytes are there
        at once where it has `read1`.
    solver, threads, max_vertices, memory
        As in `deltamesh.decode`.

    Yields
    ------
    Partial

    Raises
    ------
    FormatError
        If bytes that have come are not the beginning of an undamaged file, or if the stream ends
        before any vertex has a position.
    LimitError, OptionError, SolveError, OSError
    TypeError
        For anything but a binary file.
    """
    check_decoding(solver, threads, max_vertices, memory)
    if not hasattr(stream, "read"):
        raise TypeError(f"a binary file is needed, not {type(stream).__name__}")
    options = DecodeOptions(solver, threads, max_vertices, memory)
    read = getattr(stream, "read1", stream.read)
    data, seen, reached = bytearray(), (0, False), ""
    while piece := read(_PIECE):
        data += piece
        come = progress_of(data, seen[0])
        if come == seen:
            continue
        seen, container = come, read_prefix(bytes(data))
        if stage_of(container) not in ("", reached):
            reached = stage_of(container)
            yield decode_prefix(container, options)
    if not reached:
        solvable(read_prefix(bytes(data)))
