"""Table of the formats of mesh files, and look-ups in it. It imports no reader and no writer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from deltamesh_formats.meshfiles.by_trimesh import COLLADA
from deltamesh_formats.meshfiles.file_format import FileFormat
from deltamesh_formats.meshfiles.glb import GLB
from deltamesh_formats.meshfiles.gltf import GLTF
from deltamesh_formats.meshfiles.obj import OBJ
from deltamesh_formats.meshfiles.off import OFF
from deltamesh_formats.meshfiles.plain_text import UTF8_MARK
from deltamesh_formats.meshfiles.ply import PLY
from deltamesh_formats.meshfiles.stl import STL
from deltamesh_formats.meshfiles.threemf import THREEMF
from deltamesh_formats.meshfiles.unread import ADVICE
from deltamesh_formats.meshfiles.zipped import ZIP

# Those that are written too.
FORMATS: Final[Mapping[str, FileFormat]] = {
    one.name: one for one in (OBJ, PLY, OFF, STL, GLB, GLTF, THREEMF)
}
READABLE: Final[Mapping[str, FileFormat]] = {**FORMATS, COLLADA.name: COLLADA, ZIP.name: ZIP}

EXTENSIONS: Final[Mapping[str, FileFormat]] = {
    extension: one for one in READABLE.values() for extension in one.extensions
}

# The most decimal places that a user may ask of a text.
MAX_DIGITS: Final = 20


def titles(formats: Iterable[FileFormat]) -> str:
    """Return "A, B or C", for help pages."""
    return " or ".join(", ".join(one.title for one in formats).rsplit(", ", 1))


def format_of_extension(extension: str) -> FileFormat | None:
    """Return the format of an extension, such as ".ply" or "PLY"; None for any other."""
    return EXTENSIONS.get(extension.removeprefix(".").lower())


def written_format(extension: str) -> FileFormat | None:
    """Return the format of an extension if its files are written; None for any other."""
    found = format_of_extension(extension)
    return None if found is None or found.write is None else found


def advice(extension: str) -> str:
    """Return what helps with files of an extension that is not read; "" for an unknown one."""
    return ADVICE.get(extension.removeprefix(".").lower(), "")


def format_of_beginning(data: bytes) -> FileFormat | None:
    """Return the format whose files begin like these bytes; None if there is no such format.

    A file may begin so and be damaged, or of another format after all: this is for messages.
    """
    head = data.removeprefix(UTF8_MARK)
    return next((one for one in FORMATS.values() if head.startswith(one.beginnings)), None)
