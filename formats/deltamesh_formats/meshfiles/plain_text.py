"""Text of mesh files as UTF-8 with line feeds, whatever its encoding and its line ends are.

Programs put a byte-order mark at the beginning, write UTF-16, end lines in carriage returns, or
some lines in these and others in line feeds where two programs have had a file, and leave NUL or
Ctrl-Z at the end. Every line keeps its number.
"""

from __future__ import annotations

from typing import Final

from deltamesh_formats.errors import MeshError

UTF8_MARK: Final = b"\xef\xbb\xbf"
# The marks of 32 bits come first: one of them begins with a mark of 16 bits.
_WIDE_MARKS: Final = (
    (b"\xff\xfe\0\0", "utf-32-le"),
    (b"\0\0\xfe\xff", "utf-32-be"),
    (b"\xff\xfe", "utf-16-le"),
    (b"\xfe\xff", "utf-16-be"),
)
# Bytes from which UTF-16 without a mark is known: every second one of them is 0.
_HEAD: Final = 8
_END_MARKS: Final = b"\0\x1a"
_BLANKS: Final = b" \t\r\n"
_TAIL: Final = 1 << 12


def wide_encoding(data: bytes) -> str | None:
    """Return the name of the encoding of a text in UTF-16 or UTF-32, None for other bytes."""
    for mark, name in _WIDE_MARKS:
        if data.startswith(mark):
            return name
    head = data[: min(_HEAD, len(data) & ~1)]
    even, odd = head[::2], head[1::2]
    if len(head) >= 4 and all(even) and not any(odd):
        return "utf-16-le"
    if len(head) >= 4 and all(odd) and not any(even):
        return "utf-16-be"
    return None


def utf8(data: bytes) -> bytes:
    """Return a text without its byte-order mark, and in UTF-8 if it is UTF-16 or UTF-32.

    Raises
    ------
    MeshError
        For a text that is not valid in the encoding that its beginning announces.
    """
    encoding = wide_encoding(data)
    if encoding is None:
        return data.removeprefix(UTF8_MARK)
    try:
        return data.decode(encoding).removeprefix("\ufeff").encode()
    except UnicodeError as error:
        name = encoding[:6].upper()
        raise MeshError(f"it is {name} text, but not valid ({error})") from None


def with_line_feeds(data: bytes) -> bytes:
    """Return a text in which every line end has a line feed; no byte moves.

    CR CR LF, which a program makes that turns each LF of CR LF into CR LF, is one line end.
    """
    if data.count(b"\r") == data.count(b"\r\n"):
        return data
    paired = data.replace(b"\r\r\n", b"  \n").replace(b"\r\n", b" \n")
    return paired.replace(b"\r", b"\n")


def without_inner_marks(data: bytes) -> bytes:
    """Return a text with blanks for the byte-order marks of files that were appended to another."""
    inner = b"\n" + UTF8_MARK
    return data.replace(inner, b"\n   ") if inner in data else data


def without_end_marks(data: bytes) -> bytes:
    """Return a text without the NUL and Ctrl-Z that some programs leave at its end."""
    if not any(mark in _END_MARKS for mark in data[-_TAIL:]):
        return data
    kept = data.rstrip(_END_MARKS + _BLANKS)
    is_marked = any(mark in _END_MARKS for mark in data[len(kept) :])
    return kept + b"\n" if is_marked else data


def plain(data: bytes) -> bytes:
    """Return a text as UTF-8 with line feeds, without marks at its beginning and its end."""
    return without_end_marks(without_inner_marks(with_line_feeds(utf8(data))))
