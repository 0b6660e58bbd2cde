"""Readers and writer of `.dmesh` files, from and to anywhere."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

from deltamesh._sources import Source, open_container
from deltamesh_formats.container.container import Container
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh

Target: TypeAlias = str | os.PathLike[str] | BinaryIO


def info(source: Source) -> Container:
    """Return the container of a file: counts, sections, parameters, achieved errors.

    Every checksum of the bytes is verified; nothing is decoded. `decode` takes what is returned,
    and does not read the file again.

    Parameters
    ----------
    source : path, binary file object or bytes-like

    Raises
    ------
    FormatError
    """
    return open_container(source)


def verify(source: Source | Container, **options: Any) -> Container:
    """Decode a file and return its container; damage of any kind raises.

    Parameters
    ----------
    source : path, binary file object, bytes-like, or what `info` returned
    **options
        Those of `deltamesh.decode`.

    Raises
    ------
    FormatError, LimitError, SolveError
    """
    from deltamesh._codec import decode

    container = open_container(source)
    decode(container, **options)
    return container


def load(source: Source | Container, **options: Any) -> PolyMesh:
    """Decode a `.dmesh` file: polygons, attributes, parts and metadata of what was encoded.

    Vertices and faces come in the order of the source only if that was kept (`keep_order`).

    Parameters
    ----------
    source : path, binary file object, bytes-like, or what `info` returned
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
    from deltamesh_formats.meshfiles.files import FORMATS

    extension = Path(target).suffix.lower().removeprefix(".")
    if extension in FORMATS:
        what = extension.upper()
        raise OptionError(f"{os.fspath(target)}: save writes .dmesh, write_mesh writes {what}")


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
