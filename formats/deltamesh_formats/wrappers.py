"""Compression around a whole file: `.gz` (RFC 1952) and `.zst` (RFC 8878).

When a file is read, its first bytes decide whether something is around it, whatever its name; when
one is written, its name does.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from deltamesh_formats import zstd_frames
from deltamesh_formats.errors import FormatError, LimitError
from deltamesh_formats.remote import without_query
from deltamesh_formats.zstd_frames import Decompressor, ZstdError

__all__ = ["DEFAULT_LIMIT", "beginning", "unwrapped", "without_wrapper", "wrapped"]

# Bytes that a file may decompress to.
DEFAULT_LIMIT: Final = 16 << 30

_GZIP: Final = 31  # zlib's number of a gzip stream with the largest window
_GZIP_LEVEL: Final = 6
_ZSTD_LEVEL: Final = 3
# Four bytes of a zstandard frame may stand for 128 KiB.
_MOST_PER_BYTE: Final = 1 << 15
_FIRST_PIECE, _LEAST_PIECE, _LARGEST_PIECE = 1 << 10, 16, 1 << 14


@dataclass(frozen=True)
class _Wrapper:
    """A compression.

    Attributes
    ----------
    title : str
    begins : callable
        Whether bytes begin like a stream of it.
    decompressor : callable
        Returns a decompressor of one stream; several in a row are one file.
    compress : callable
    """

    title: str
    begins: Callable[[bytes], bool]
    decompressor: Callable[[], Decompressor]
    compress: Callable[[bytes], bytes]


def _gzip_stream(data: bytes) -> bytes:
    """Return a gzip stream without name and time: the same bytes for the same data."""
    compressor = zlib.compressobj(_GZIP_LEVEL, zlib.DEFLATED, _GZIP)
    return compressor.compress(data) + compressor.flush()


def _gzip_decompressor() -> Decompressor:
    return zlib.decompressobj(_GZIP)


def _begins_a_frame(head: bytes) -> bool:
    """Return whether bytes begin a frame; of a skippable one, four bits are free."""
    if head[:4] == zstd_frames.MAGIC:
        return True
    return len(head) > 3 and head[0] & 0xF0 == 0x50 and head[1:4] == b"\x2a\x4d\x18"


_WRAPPERS: Final = {
    ".gz": _Wrapper(
        "gzip", lambda head: head[:3] == b"\x1f\x8b\x08", _gzip_decompressor, _gzip_stream
    ),
    ".zst": _Wrapper(
        "zstandard",
        _begins_a_frame,
        zstd_frames.decompressor,
        lambda data: zstd_frames.frame(data, _ZSTD_LEVEL, checksum=True),
    ),
}


def without_wrapper(name: str) -> tuple[str, str]:
    """Return a file name without ".gz" or ".zst", and that suffix, "" if there is none.

    A URL loses its query, too: "https://example.org/a.ply?version=2" is a PLY.
    """
    name = without_query(name)
    stem, suffix = os.path.splitext(name)
    return (stem, suffix) if suffix.lower() in _WRAPPERS else (name, "")


def wrapped(name: str, data: bytes) -> bytes:
    """Return the bytes of a file of this name: compressed if it ends in ".gz" or ".zst"."""
    suffix = without_wrapper(name)[1]
    return _WRAPPERS[suffix.lower()].compress(data) if suffix else data


def unwrapped(data: bytes, limit: int = DEFAULT_LIMIT, *, partial: bool = False) -> bytes:
    """Return what is in a file, decompressed if it begins like a gzip or zstandard stream.

    Parameters
    ----------
    data : bytes
        The whole file: one stream, or several in a row.
    limit : int
        Bytes that it may decompress to. What is above is refused before much more is allocated.
    partial : bool
        Whether a stream may be cut: what is there is decompressed.

    Raises
    ------
    FormatError
        For a damaged or incomplete stream, and for other bytes after it; if it may be cut, also
        where no byte of what is in it has come.
    LimitError
        For more than the limit.
    """
    wrapper = _wrapper_of(data)
    return data if wrapper is None else _decompressed(wrapper, data, limit, partial=partial)


def beginning(data: bytes, size: int) -> bytes:
    """Return the first bytes of what is in a file, of whose own first bytes these are many.

    Parameters
    ----------
    data : bytes
    size : int
        How many bytes to return; fewer if `data` has no more of them.

    Raises
    ------
    FormatError
        For a damaged stream.
    """
    wrapper = _wrapper_of(data)
    if wrapper is None:
        return data[:size]
    stream, made = wrapper.decompressor(), b""
    for at in range(0, len(data), _FIRST_PIECE):
        if len(made) < size and not stream.eof:
            made += _next(wrapper, stream, data[at : at + _FIRST_PIECE], at)
    return made[:size]


def _wrapper_of(data: bytes) -> _Wrapper | None:
    return next((one for one in _WRAPPERS.values() if one.begins(data[:4])), None)


def _decompressed(wrapper: _Wrapper, data: bytes, limit: int, *, partial: bool) -> bytes:
    made: list[bytes] = []
    total = at = 0
    while at < len(data):
        if not wrapper.begins(data[at : at + 4]):
            raise FormatError(f"{len(data) - at} bytes follow the {wrapper.title} stream", at)
        stream, piece = wrapper.decompressor(), _FIRST_PIECE
        while not stream.eof:
            if at >= len(data):
                if partial and total:
                    return b"".join(made)
                raise FormatError(f"truncated: the file ends within its {wrapper.title} stream", at)
            size = max(_LEAST_PIECE, min(piece, (limit - total) // _MOST_PER_BYTE))
            made.append(_next(wrapper, stream, data[at : at + size], at))
            at, total = min(at + size, len(data)), total + len(made[-1])
            piece = min(2 * piece, _LARGEST_PIECE)
            if total > limit:
                raise LimitError(f"it decompresses to more than the limit of {limit} bytes")
        at -= len(stream.unused_data)
    return b"".join(made)


def _next(wrapper: _Wrapper, stream: Decompressor, piece: bytes, at: int) -> bytes:
    try:
        return stream.decompress(piece)
    except (zlib.error, ZstdError) as error:
        raise FormatError(f"its {wrapper.title} stream is damaged: {error}", at) from None
