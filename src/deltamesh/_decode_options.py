"""Options of the decoder, as functions hand them on: how to solve, and how much to allow."""

from __future__ import annotations

from dataclasses import dataclass

from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._progress import Progress, silent


@dataclass(frozen=True)
class DecodeOptions:
    """Options of the decoder; `deltamesh.decode` documents each."""

    solver: str = "auto"
    threads: int | None = None
    max_vertices: int = DEFAULT_MAX_VERTICES
    memory: int = DEFAULT_MEMORY
    progress: Progress = silent
