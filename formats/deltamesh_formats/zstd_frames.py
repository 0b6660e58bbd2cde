"""Zstandard frames (RFC 8878): one in memory, and a stream of several.

The standard library has them from Python 3.14 on; before, the package zstandard.
"""

from __future__ import annotations

import sys
from typing import Final, Protocol

__all__ = ["MAGIC", "ZstdError", "decompressor", "frame", "framed"]

MAGIC: Final = b"\x28\xb5\x2f\xfd"
LEVEL: Final = 19
# The bits of a frame's descriptor, the byte after the magic number.
_SINGLE_SEGMENT: Final = 0x20
_SIZE_AT: Final = 6
_OTHERS: Final = 0x1F  # a dictionary, a checksum, and what is reserved or unused
# Window_Descriptor of 8 MiB, which the RFC asks every decoder to have.
_LARGEST_WINDOW: Final = 0x68


class Decompressor(Protocol):
    """What decompresses the beginning of a stream, piece by piece."""

    @property
    def eof(self) -> bool:
        """Whether the end of the frame was met."""

    @property
    def unused_data(self) -> bytes:
        """The bytes after that end."""

    def decompress(self, data: bytes, /) -> bytes:
        """Return what the next bytes stand for."""


if sys.version_info >= (3, 14):
    from compression import zstd
    from compression.zstd import CompressionParameter, ZstdError

    def frame(data: bytes, level: int = LEVEL, *, checksum: bool = False) -> bytes:
        """Return a frame of these bytes that has their number, and their checksum if asked to."""
        options: dict[int, int] = {
            CompressionParameter.compression_level: level,
            CompressionParameter.content_size_flag: 1,
            CompressionParameter.checksum_flag: int(checksum),
            CompressionParameter.dict_id_flag: 0,
        }
        return zstd.compress(data, options=options)

    def decompressor() -> Decompressor:
        """Return a decompressor of one frame, of a window of at most 128 MiB."""
        return zstd.ZstdDecompressor()

    def _decompressed(data: bytes, size: int) -> bytes:
        one = zstd.ZstdDecompressor()
        result = one.decompress(data, size)
        # The rest may be an empty last block, which makes no byte.
        more = b"" if one.eof or one.needs_input else one.decompress(b"", 1)
        if more or not one.eof or one.unused_data:
            raise ZstdError("the frame does not end with its bytes")
        return result

else:
    import zstandard
    from zstandard import ZstdError

    def frame(data: bytes, level: int = LEVEL, *, checksum: bool = False) -> bytes:
        """Return a frame of these bytes that has their number, and their checksum if asked to."""
        compressor = zstandard.ZstdCompressor(
            level, write_content_size=True, write_checksum=checksum, write_dict_id=False
        )
        return bytes(compressor.compress(data))

    def decompressor() -> Decompressor:
        """Return a decompressor of one frame, of a window of at most 128 MiB."""
        one: Decompressor = zstandard.ZstdDecompressor().decompressobj()
        return one

    def _decompressed(data: bytes, size: int) -> bytes:
        # It allocates what the frame says, which is `size`, and refuses bytes after the frame.
        one = zstandard.ZstdDecompressor()
        return bytes(one.decompress(data, max_output_size=size, allow_extra_data=False))


def framed(data: bytes, size: int) -> bytes:
    """Return the bytes of one frame, which has to be like those of `frame`.

    Nothing is allocated before the frame has said that it holds `size` bytes.

    Parameters
    ----------
    data : bytes
    size : int
        How many bytes the frame has to hold.

    Raises
    ------
    ZstdError
        For another frame, a damaged one, and bytes after it.
    """
    _check_header(data, size)
    result = _decompressed(data, size)
    if len(result) != size:
        raise ZstdError(f"{len(result)} bytes")
    return result


def _check_header(data: bytes, size: int) -> None:
    if data[: len(MAGIC)] != MAGIC:
        raise ZstdError("no magic number of a frame")
    descriptor, *rest = data[len(MAGIC) : len(MAGIC) + 10] or b"\0"
    if descriptor & _OTHERS:
        raise ZstdError(f"descriptor {descriptor:#04x}, with more than a size")
    is_single = bool(descriptor & _SINGLE_SEGMENT)
    width = (int(is_single), 2, 4, 8)[descriptor >> _SIZE_AT]
    window, rest = ([0], rest) if is_single else (rest[:1], rest[1:])
    if not width or len(rest) < width:
        raise ZstdError("a frame without its size")
    if window > [_LARGEST_WINDOW]:
        raise ZstdError("a window of more than 8 MiB")
    held = int.from_bytes(rest[:width], "little") + (256 if width == 2 else 0)
    if held != size:
        raise ZstdError(f"a frame of {held} bytes")
