"""Packed blocks of bytes that no encoder has written."""

from __future__ import annotations

import zlib

from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.payload_layout import BLOCK_PLAIN


def plain(raw: bytes) -> bytes:
    return bytes([BLOCK_PLAIN]) + write_varint(len(raw)) + raw


def deflated(raw: bytes, size: int, more: bytes = b"") -> bytes:
    compressor = zlib.compressobj(9, zlib.DEFLATED, -15)
    small = compressor.compress(raw) + compressor.flush() + more
    return b"\1" + write_varint(size) + write_varint(len(small)) + small
