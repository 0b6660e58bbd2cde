"""Proof of a written file: a decoder has read all of it but positions, and the digest is right."""

from __future__ import annotations

import sys

from deltamesh._pipeline.decoder import proven_content
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import FRAMES, MAX_COUNT
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError


def proven(data: bytes) -> Container:
    """Return the container of a file, once a decoder, given any memory, has read all but positions.

    Raises
    ------
    RuntimeError
        If it cannot be read, or if what is read is not what its digest was made of.
    """
    try:
        container = read_container(data)
        content = proven_content(container, max_vertices=MAX_COUNT, memory=sys.maxsize)
        if FRAMES in container.sections:
            from deltamesh._sections.frames import frame_integers

            for frame in container.frames:
                frame_integers(container, content, frame)
    except (FormatError, LimitError) as error:
        raise RuntimeError(f"the encoded file cannot be decoded: {error}") from error
    return container
