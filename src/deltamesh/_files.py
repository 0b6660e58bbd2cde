"""`.dmesh` files: what they say of themselves, whether they are whole, from and to anywhere."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

from deltamesh._sources import Source, read_source
from deltamesh_formats.atomic import PathOrFile, write_file
from deltamesh_formats.container.layout import Container
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh


def info(source: Source) -> Container:
    """Return what a file says of itself: counts, sections, parameters, achieved errors.

    Every checksum of the bytes is verified; nothing is decoded.

    Parameters
    ----------
    source : path, binary file object or bytes-like

    Raises
    ------
    FormatError
    """
    return read_container(read_source(source))


def verify(source: Source, **options: Any) -> Container:
    """Decode a file and return what it says of itself; damage of any kind raises.

    Parameters
    ----------
    source : path, binary file object or bytes-like
    **options
        Those of `deltamesh.decode`.

    Raises
    ------
    FormatError, LimitError, SolveError
    """
    from deltamesh._codec import decode

    data = read_source(source)
    decode(data, **options)
    return read_container(data)


def load(source: Source, **options: Any) -> PolyMesh:
    """Decode a `.dmesh` file: polygons, attributes, parts and metadata of what was encoded.

    Vertices and faces come in the order of the source only if that was kept (`keep_order`).

    Parameters
    ----------
    source : path, binary file object or bytes-like
    **options
        Those of `deltamesh.decode`, which is the same.

    Raises
    ------
    FormatError, LimitError, SolveError, OSError
    """
    from deltamesh._codec import decode

    return decode(source, **options)


def save(target: PathOrFile, mesh: PolyMesh, **options: Any) -> None:
    """Encode a mesh into a `.dmesh` file, with all its attributes, parts and metadata.

    A file at a path appears whole or not at all, whoever else writes it at the same time. One that
    exists is replaced and keeps its permissions; of a symbolic link, what it names. Pipes and
    devices are written in place. Nothing is written to a file object before all bytes are there.

    Parameters
    ----------
    target : path or binary file object
    mesh : PolyMesh
        `deltamesh.from_arrays` makes one, `deltamesh.read_mesh` reads one.
    **options
        Those of `deltamesh.encode`.

    Raises
    ------
    MeshError, OptionError, TargetError, SolveError, OSError
    """
    from deltamesh._codec import encode

    if isinstance(target, (str, os.PathLike)):
        _check_extension(target)
    if isinstance(target, io.TextIOBase):
        raise TypeError(f"a file to write to has to be open in binary mode: {target!r}")
    write_file(target, encode(mesh, **options))


def _check_extension(target: str | os.PathLike[str]) -> None:
    """Refuse to write a `.dmesh` under the name of a mesh file."""
    from deltamesh_formats.meshfiles.files import FORMATS

    extension = Path(target).suffix.lower().removeprefix(".")
    if extension in FORMATS:
        what = extension.upper()
        raise OptionError(f"{os.fspath(target)}: save writes .dmesh, write_mesh writes {what}")
