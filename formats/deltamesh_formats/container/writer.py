"""Writer of the `.dmesh` container: a `Container` becomes bytes."""

from __future__ import annotations

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.header import write_header
from deltamesh_formats.container.sections import write_section


def write_container(container: Container) -> bytes:
    """Return the bytes of a `.dmesh` file; `reader.read_container` takes them apart again.

    Parameters
    ----------
    container : Container
        From `building.build_container` or `reader.read_container`. The payloads of its sections are
        written as they are.
    """
    c = container
    header = write_header(c.version, c.vertices, c.triangles)
    return b"".join([header, *map(write_section, c.sections.values())])
