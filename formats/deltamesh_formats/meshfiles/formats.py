"""Table of the formats of mesh files, and look-ups in it. It imports no reader and no writer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from deltamesh_formats.meshfiles.file_format import FileFormat
from deltamesh_formats.meshfiles.glb import GLB
from deltamesh_formats.meshfiles.obj import OBJ
from deltamesh_formats.meshfiles.off import OFF
from deltamesh_formats.meshfiles.plain_text import UTF8_MARK
from deltamesh_formats.meshfiles.ply import PLY
from deltamesh_formats.meshfiles.stl import STL

FORMATS: Final[Mapping[str, FileFormat]] = {one.name: one for one in (OBJ, PLY, OFF, STL, GLB)}

EXTENSIONS: Final[Mapping[str, FileFormat]] = {
    extension: one for one in FORMATS.values() for extension in one.extensions
}

# The most decimal places that a user may ask of a text.
MAX_DIGITS: Final = 20

# "A, B or C", for help pages.
TITLES: Final = " or ".join(", ".join(one.title for one in FORMATS.values()).rsplit(", ", 1))


def format_of_extension(extension: str) -> FileFormat | None:
    """Return the format of an extension, such as ".ply" or "PLY"; None for any other."""
    return EXTENSIONS.get(extension.removeprefix(".").lower())


def format_of_beginning(data: bytes) -> FileFormat | None:
    """Return the format whose files begin like these bytes; None if there is no such format.

    A file may begin so and be damaged, or of another format after all: this is for messages.
    """
    head = data.removeprefix(UTF8_MARK)
    return next((one for one in FORMATS.values() if head.startswith(one.beginnings)), None)
