"""Blocks of bytes, deflated or in a zstandard frame where that is smallest; SPEC.md 5.15."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from typing import Final

from deltamesh_formats.container.fields import Buffer, read_varint, take, write_varint
from deltamesh_formats.container.payload_layout import BLOCK_DEFLATED, BLOCK_PLAIN, BLOCK_ZSTD
from deltamesh_formats.errors import FormatError
from deltamesh_formats.zstd_frames import ZstdError, frame, framed

_WINDOW_BITS: Final = -15  # no header and no checksum: a section has its own


def packed(data: bytes) -> bytes:
    """Return a block that holds these bytes, in the form that takes the fewest."""
    size, blocks = write_varint(len(data)), [(BLOCK_PLAIN, b"", data)]
    for form, small in ((BLOCK_DEFLATED, _deflated(data)), (BLOCK_ZSTD, frame(data))):
        if len(small) < len(data):
            blocks.append((form, write_varint(len(small)), small))
    form, length, body = min(blocks, key=lambda block: len(block[1]) + len(block[2]))
    return bytes([form]) + size + length + body


def unpacked_size(view: Buffer, position: int) -> int:
    """Return how many bytes a block says that it holds; nothing else of it is looked at."""
    return read_varint(view, position + len(take(view, position, 1)))[0]


def unpacked(view: Buffer, position: int, most: int) -> tuple[bytes, int]:
    """Return what a block holds, and the position after it.

    Parameters
    ----------
    view : bytes-like
    position : int
    most : int
        Bytes that it may hold; nothing is allocated for more.

    Raises
    ------
    FormatError
    """
    form = take(view, position, 1)[0]
    if form != BLOCK_PLAIN and form not in _UNPACKERS:
        raise FormatError(f"unknown form {form} of a block", position)
    size, at = read_varint(view, position + 1)
    if size > most:
        raise FormatError(f"a block of {size} bytes, more than {most}", position + 1)
    if form == BLOCK_PLAIN:
        return bytes(take(view, at, size)), at + size
    length, at = read_varint(view, at)
    if length >= size:
        raise FormatError(f"a block of {size} bytes packed into {length}", position)
    return _UNPACKERS[form](take(view, at, length), size, at), at + length


def _deflated(data: bytes) -> bytes:
    compressor = zlib.compressobj(9, zlib.DEFLATED, _WINDOW_BITS, 9)
    return compressor.compress(data) + compressor.flush()


def _inflated(data: Buffer, size: int, position: int) -> bytes:
    """Return what a deflate stream of so many bytes, and nothing after it, stands for."""
    inflater = zlib.decompressobj(_WINDOW_BITS)
    try:
        result = inflater.decompress(data, size)
        # The rest may be the end of the stream, which makes no byte.
        more = inflater.decompress(inflater.unconsumed_tail, 1)
    except zlib.error as error:
        raise FormatError(f"invalid deflate stream: {error}", position) from None
    if len(result) != size or more or not inflater.eof or inflater.unused_data:
        raise FormatError(f"a deflate stream of another size than {size} bytes", position)
    return result


def _framed(data: Buffer, size: int, position: int) -> bytes:
    """Return what a frame of so many bytes, and nothing after it, stands for."""
    try:
        return framed(bytes(data), size)
    except ZstdError as error:
        text = f"invalid zstandard frame for a block of {size} bytes: {error}"
        raise FormatError(text, position) from None


_UNPACKERS: Final[Mapping[int, Callable[[Buffer, int, int], bytes]]] = {
    BLOCK_DEFLATED: _inflated,
    BLOCK_ZSTD: _framed,
}
