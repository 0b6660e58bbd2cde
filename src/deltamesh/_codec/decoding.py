"""Decoder as callers see it: `decode`, from bytes to meshes."""

from __future__ import annotations

from typing import Literal, overload

from deltamesh._decode_options import DecodeOptions
from deltamesh._limits import DEFAULT_MAX_VERTICES, DEFAULT_MEMORY
from deltamesh._options import check_decoding
from deltamesh._pipeline.decoder import decode_mesh
from deltamesh._player import decode_frames
from deltamesh._prefixes import Partial, decode_prefix
from deltamesh._progress import Progress, heard
from deltamesh._sources import Bytes, bytes_of
from deltamesh_formats.arguments import is_whole, require, require_flag
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.reader import read_container, read_prefix
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh


@overload
def decode(
    data: Bytes | Container,
    *,
    frame: int = 0,
    pose: str | None = None,
    partial: Literal[False] = False,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> PolyMesh: ...


@overload
def decode(
    data: Bytes | Container,
    *,
    frame: int = 0,
    partial: Literal[True],
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> Partial: ...


def decode(
    data: Bytes | Container,
    *,
    frame: int = 0,
    pose: str | None = None,
    partial: bool = False,
    solver: str = "auto",
    threads: int | None = None,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
    progress: Progress | None = None,
) -> PolyMesh | Partial:
    """Decompress the bytes of a `.dmesh` file; `load` reads one from a path or a file.

    Parameters
    ----------
    data : bytes-like, or what `deltamesh.info` returned
        The whole file; a bytearray, mmap or array of bytes is not copied.
    frame : int
        Of a sequence, the frame, from 0. It is decoded from the first one, the key frame before it,
        and those in between; `deltamesh.frames` decodes one after the other.
    pose : str, optional
        The name of a pose, of those that `deltamesh.edit` has added. Default: the mesh at rest.
    partial : bool
        Whether the file may be cut: its beginning is decoded, as far as it reaches. The checksums
        of whole sections are verified, that of the content only of a whole file.
    solver : {"auto", "core", "rslab", "pardiso", "scipy"}
        Default: the compiled core for small meshes, else rslab or, where it is missing, scipy.
    threads : int, optional
        Of the solvers, where a mesh has many vertices. Default: one for each core. The positions do
        not depend on it.
    max_vertices, memory : int
        Refuse files with more vertices, or that would take more bytes of memory.
    progress : callable, optional
        Called with the name of each stage as it begins.

    Returns
    -------
    PolyMesh
        Polygons, attributes (as exactly as they were encoded), parts, metadata, and the words for
        what of the source is not kept; in the order of the source only with `keep_order`. Faces and
        stored integers are exact. Positions are those of any machine and solver to within a
        thousandth of a step, where anchors are interpolated; where they are weighed in least
        squares, 1e-9 of the diagonal of the bounding box; of a lossless file, bit for bit.
    Partial
        The same in its `mesh`, if `partial`, with the stage that is reached.

    Raises
    ------
    FormatError
        If the bytes are damaged or no encoder has written them; it has an offset. If `partial`,
        also where no vertex has a position yet.
    LimitError
        Before anything above the limits is allocated: by the counts of the file or, for methods
        that solve, by the entries of the factorization.
    SolveError
    OptionError
        If there is no such pose or frame, or the file may be cut; for an argument of a wrong type,
        or out of range.
    TypeError
        For anything but bytes.

    Notes
    -----
    D. Cohen-Or, O. Sorkine, "Encoding Meshes in Differential Coordinates", SCCG 2006.
    """
    check_decoding(solver, threads, max_vertices, memory)
    require_flag("partial", partial)
    require(is_whole(frame), "frame must be a whole number", frame)
    options = DecodeOptions(solver, threads, max_vertices, memory, heard(progress))
    if partial:
        if pose is not None:
            raise OptionError("a pose of a file that may be cut: poses need the whole file")
        if frame:
            raise OptionError("a file that may be cut is decoded as far as its first frame")
        prefix = data if isinstance(data, Container) else read_prefix(bytes_of(data))
        return decode_prefix(prefix, options)
    container = data if isinstance(data, Container) else read_container(bytes_of(data))
    if not 0 <= frame < container.frame_count:
        count = container.frame_count
        raise OptionError(f"there is no frame {frame}: the file has {count}, from 0 on")
    if pose is not None:
        if frame:
            raise OptionError("a pose is one of frame 0")
        return decode_mesh(container, options, pose)
    return next(decode_frames(container, [frame], options))
