"""Files in `.dmesh` format, at paths and in file objects: read, verified, described, written."""

from __future__ import annotations

import functools
import io
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Literal, Unpack, overload

from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._options import EncodeOptions, check_decoding
from deltamesh._prefixes import Partial
from deltamesh._sources import Source, read_file, read_source
from deltamesh_formats.arguments import require_flag
from deltamesh_formats.atomic import PathOrFile, require_file, write_file
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.reader import read_container, read_prefix
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.wrappers import without_wrapper, wrapped


def info(source: Source, *, partial: bool = False) -> Container:
    """Return the container of a file: counts, sections, parameters, achieved errors.

    Every checksum of the bytes is verified; nothing is decoded. `decode` takes what is returned,
    and does not read the file again.

    Parameters
    ----------
    source : path, binary file object or bytes-like
        Around a file there may be gzip or zstandard.
    partial : bool
        Whether the file may be cut: the sections that have come are described.

    Raises
    ------
    FormatError, LimitError
    """
    require_flag("partial", partial)
    read = read_prefix if partial else read_container
    return read(read_source(source, partial=partial))


def verify(
    source: Source | Container,
    *,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Callable[[str], None] | None = None,
) -> Container:
    """Decode a file, all of its frames, and return its container; damage of any kind raises.

    Parameters
    ----------
    source : path, binary file object, bytes-like, or what `info` returned
    solver, threads, max_vertices, memory, progress
        As in `deltamesh.decode`.

    Raises
    ------
    FormatError, LimitError, OptionError, SolveError, OSError
    """
    check_decoding(solver, threads, max_vertices, memory)
    container = _container_of(source, memory)
    for _ in frames(
        container,
        solver=solver,
        threads=threads,
        max_vertices=max_vertices,
        memory=memory,
        progress=progress,
    ):
        pass
    return container


def frames(
    source: Source | Container,
    *,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Callable[[str], None] | None = None,
) -> Iterator[PolyMesh]:
    """Decode the frames of a sequence, one after the other, as they are asked for.

    A file of one mesh has one frame. The meshes share all arrays but those of their positions.

    Parameters
    ----------
    source : path, URL, binary file object, bytes-like, or what `info` returned
        It is read before the first frame is.
    solver, threads, max_vertices, memory, progress
        As in `deltamesh.decode`, which decodes one frame of any number.

    Yields
    ------
    PolyMesh

    Raises
    ------
    FormatError, LimitError, OptionError, SolveError, OSError
    """
    from deltamesh._decode_options import DecodeOptions
    from deltamesh._player import decode_frames
    from deltamesh._progress import heard

    check_decoding(solver, threads, max_vertices, memory)
    container = _container_of(source, memory)
    options = DecodeOptions(solver, threads, max_vertices, memory, heard(progress))
    yield from decode_frames(container, range(container.frame_count), options)


def _container_of(source: Source | Container, memory: int) -> Container:
    if isinstance(source, Container):
        return source
    return read_container(read_source(source, memory))


@overload
def load(
    source: PathOrFile,
    *,
    frame: int = 0,
    pose: str | None = None,
    partial: Literal[False] = False,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Callable[[str], None] | None = None,
) -> PolyMesh: ...


@overload
def load(
    source: PathOrFile,
    *,
    frame: int = 0,
    partial: Literal[True],
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Callable[[str], None] | None = None,
) -> Partial: ...


def load(
    source: PathOrFile,
    *,
    frame: int = 0,
    pose: str | None = None,
    partial: bool = False,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Callable[[str], None] | None = None,
) -> PolyMesh | Partial:
    """Decode a `.dmesh` file: polygons, attributes, parts and metadata of what was encoded.

    Vertices and faces come in the order of the source only if that was kept (`keep_order`).

    Parameters
    ----------
    source : path, URL or binary file object
        URLs take the extra `remote`. A file object is read from where it is to its end, and need
        not be seekable. Around the file there may be gzip or zstandard; what it decompresses to is
        within `memory`, too.
    frame : int
        Of a sequence, the frame, from 0.
    partial : bool
        Whether the file may be cut; what is returned is a `Partial` then.
    pose, solver, threads, max_vertices, memory, progress
        As in `deltamesh.decode`, which does the same with bytes.

    Raises
    ------
    FormatError, LimitError, SolveError, OSError
    OptionError
        For a frame, or a pose, that the file does not have, and for arguments of a wrong type, or
        out of range.
    TypeError
        For anything but a path or a file that is open in binary mode.
    """
    from deltamesh._codec.decoding import decode

    check_decoding(solver, threads, max_vertices, memory)
    require_flag("partial", partial)
    # Each overload of `decode` has one of these.
    run = functools.partial(decode, partial=True) if partial else decode
    return run(
        read_file(source, memory, partial=partial),
        frame=frame,
        pose=pose,
        solver=solver,
        threads=threads,
        max_vertices=max_vertices,
        memory=memory,
        progress=progress,
    )


def save(
    target: PathOrFile, mesh: PolyMesh | Iterable[PolyMesh], **options: Unpack[EncodeOptions]
) -> None:
    """Encode a mesh, or the frames of a sequence, into a `.dmesh` file.

    All attributes, parts and metadata of a mesh are kept, and those that are alike in all frames.

    A file at a path appears whole or not at all, whoever else writes it at the same time. One that
    exists is replaced and keeps its permissions; of a symbolic link, what it names. Pipes and
    devices are written in place. Nothing is written to a file object before all bytes are there.

    Parameters
    ----------
    target : path, URL or binary file object
        A path or URL that ends in ".gz" or ".zst" gets a compressed file; a file object gets
        the bytes as they are.
    mesh : PolyMesh, or iterable of PolyMesh
        `deltamesh.from_arrays` makes one, `deltamesh.read_mesh` reads one. Several are frames, of
        the same faces.
    **options
        Those of `deltamesh.encode`.

    Raises
    ------
    MeshError, OptionError, TargetError, SolveError, RuntimeError, OSError
    TypeError
        For anything but a path or a file that is open in binary mode.
    """
    from deltamesh._codec.encoding import encode

    require_file(target, "write")
    if isinstance(target, (str, os.PathLike)):
        _check_extension(target)
    if isinstance(target, io.TextIOBase):
        raise TypeError(f"a file to write to has to be open in binary mode: {target!r}")
    data = encode(mesh, **options)
    if isinstance(target, (str, os.PathLike)):
        data = wrapped(os.fspath(target), data)
    write_file(target, data)


def _check_extension(target: str | os.PathLike[str]) -> None:
    """Refuse to write a `.dmesh` under the name of a mesh file."""
    from deltamesh_formats.meshfiles.formats import format_of_extension

    other = format_of_extension(Path(without_wrapper(os.fspath(target))[0]).suffix)
    if other is not None:
        name = os.fspath(target)
        raise OptionError(f"{name}: save writes .dmesh, write_mesh writes {other.title}")
