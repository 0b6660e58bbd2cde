"""`.dmesh` files: what they say of themselves, whether they are whole, from and to anywhere."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

from deltamesh._sources import Source, read_source
from deltamesh_formats.container.layout import Container
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

Target: TypeAlias = str | os.PathLike[str] | BinaryIO


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


def save(target: Target, mesh: PolyMesh, **options: Any) -> None:
    """Encode a mesh into a `.dmesh` file, with all its attributes, parts and metadata.

    A file at a path appears whole or not at all; one that exists is replaced. Nothing is written
    to a file object before all bytes are there.

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
    data = encode(mesh, **options)
    if isinstance(target, (str, os.PathLike)):
        _replace(Path(target), data)
    else:
        _write(target, data)


def _check_extension(target: str | os.PathLike[str]) -> None:
    """Refuse to write a `.dmesh` under the name of a mesh file."""
    from deltamesh_formats.meshfiles.formats import format_of_extension

    other = format_of_extension(Path(target).suffix)
    if other is not None:
        name = os.fspath(target)
        raise OptionError(f"{name}: save writes .dmesh, write_mesh writes {other.title}")


def _replace(target: Path, data: bytes) -> None:
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)


def _write(target: BinaryIO, data: bytes) -> None:
    rest = memoryview(data)
    while rest:  # a file without a buffer, such as a pipe, may take a part
        taken = target.write(rest)
        rest = rest[len(rest) if taken is None else taken :]
