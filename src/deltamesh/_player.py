"""Player of sequences: frames of a file, in any order, each decoded from what it is predicted from.

A frame needs frame 0, the key frame before it, and those in between; the next one after the last
that was decoded needs nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from deltamesh._content import Content
from deltamesh._decode_options import DecodeOptions
from deltamesh._geometry.frames import absolute
from deltamesh._geometry.methods import frame_codec
from deltamesh._geometry.prediction import Reference, predicted
from deltamesh._geometry.systems import Systems
from deltamesh._limits import memory_to_solve
from deltamesh._mesh import LARGEST
from deltamesh._pipeline.decoder import decode_mesh, proven_content, to_precision_of
from deltamesh._sections.frames import frame_integers, frame_parameters
from deltamesh._sections.trials import has_scale
from deltamesh._vectors import largest
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.frame_table import Frame
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh

# The largest coordinate that a frame may have.
FURTHEST: Final = 100 * LARGEST


def decode_frames(
    container: Container,
    wanted: Iterable[int],
    options: DecodeOptions,
) -> Iterator[PolyMesh]:
    """Decompress some frames of a file, one after the other; see `deltamesh.frames`."""
    if not container.frames:
        yield decode_mesh(container, options)
        return
    progress = options.progress
    content = proven_content(container, options.max_vertices, options.memory, progress)
    progress("positions")
    parameters, surface = container.parameters, content.structure.surface
    memory = memory_to_solve(container, options.memory)
    systems = Systems(surface, options.solver, options.threads, memory)
    precise = to_precision_of(container, systems)
    coder = frame_codec(parameters.method)
    points = coder.reconstruct(surface, parameters, content.integers, precise)
    mesh = content.mesh(points, parameters.single, container.margin)
    player = Player(container, content, systems, points)
    for index in wanted:
        if index:
            progress(f"frame {index}")
        yield content.moved(mesh, player.positions(index)) if index else mesh


class Player:
    """Decoder of the frames of a file, in any order; the next one after the last costs the least.

    Parameters
    ----------
    container : Container
    content : Content
    systems : Systems
    first : float64 (p, 3)
        The decoded positions of frame 0.
    """

    def __init__(
        self, container: Container, content: Content, systems: Systems, first: Floats
    ) -> None:
        self._container, self._content, self._systems = container, content, systems
        self._frames = container.frames
        self._first = self._last = Reference(container.parameters, content.integers, first)
        self._at = 0

    def positions(self, index: int) -> Floats:
        """Return the decoded positions of a frame, float64 (p, 3).

        Raises
        ------
        FormatError, SolveError
        """
        if index < self._at:
            self._at, self._last = 0, self._first
        keys = (frame.index for frame in self._frames[:index] if frame.is_key)
        key = max(keys, default=0)
        if key > self._at:
            self._at, self._last = key - 1, self._first
        while self._at < index:
            self._last = self._decoded(self._frames[self._at])
            self._at += 1
        return self._last.vertices

    def _decoded(self, frame: Frame) -> Reference:
        reference = self._first if frame.is_key else self._last
        surface, first = self._content.structure.surface, self._first.parameters
        motion, seen = frame_integers(self._container, self._content, frame)
        parameters = frame_parameters(self._container, frame)
        integers = absolute(parameters, seen, reference)
        if not has_scale(parameters, integers):
            raise self._too_large(frame)
        prediction = predicted(surface, first, reference, motion, self._systems)
        coder = frame_codec(first.method)
        W = coder.reconstruct(surface, parameters, integers, self._systems, prediction)
        if not largest(W) <= FURTHEST:
            raise self._too_large(frame)
        return Reference(parameters, integers, W)

    @staticmethod
    def _too_large(frame: Frame) -> FormatError:
        reason = f"frame {frame.index}: positions that are too large"
        return FormatError(reason, frame.offset)
