"""Payloads that no encoder has written, what a reader makes of them, and streams in one."""

from __future__ import annotations

from itertools import accumulate, pairwise

import meshes

from deltamesh._shape.surface import surface_of
from deltamesh_formats.container.container import Section
from deltamesh_formats.errors import FormatError

SPHERE = meshes.icosphere(1)[1]
SURFACE = surface_of(SPHERE, 42, 3)


def section_of(name, payload):
    return Section(name, 50, payload)


def read_or_refused(reader, parameters, **payloads):
    """What a reader makes of payloads, None where it refuses them."""
    sections = {name: section_of(name, payload) for name, payload in payloads.items()}
    offset = None
    try:
        return reader(SURFACE, parameters, sections)
    except FormatError as error:
        offset = error.offset
    assert 50 <= offset <= 60 + max(map(len, payloads.values()))
    return None


def joined(streams: list[bytes], before: bytes = b"") -> tuple[memoryview, list[tuple[int, int]]]:
    """Streams one after the other, and where each begins and ends."""
    places = pairwise(accumulate(map(len, streams), initial=len(before)))
    return memoryview(before + b"".join(streams)), list(places)
