"""Lines, tokens and numbers of text files, as arrays.

Nothing here loops over lines in Python: each byte is a separator or not, and a token begins where a
byte of a token follows a separator. `numpy.fromstring` then reads all numbers in one call, each to
the nearest float64.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.errors import MeshError

Bytes = NDArray[np.uint8]

_NUMBER: Final = re.compile(
    rb"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan(?:\(\w*\))?|inf(?:inity)?)", re.IGNORECASE
)
# What the C library of Microsoft printed, up to 2013, behind "1." for numbers that are not finite;
# "#J" and so on are "#INF" and "#IND" whose letters it rounded to fewer places.
MSVC_LETTERS: Final = rb"#(?:(INF)|IND|[QS]NAN|IO|J|QO|QNB)0*(?!\S)"
_MSVC_NUMBER: Final = re.compile(rb"(?<!\S)([+-]?)1\." + MSVC_LETTERS)
# Fortran prints an exponent of double precision as D.
_FORTRAN_EXPONENT: Final = re.compile(rb"(?<=[\d.])[dD](?=[+-]?\d)")
_INTEGER: Final = re.compile(rb"[+-]?\d+")
# Names may be in any encoding: bytes that are not UTF-8 come back when they are written.
ENCODING: Final = ("utf-8", "surrogateescape")


@dataclass(frozen=True)
class Lines:
    """Lines of a text that have tokens, and these tokens, as indices into its bytes.

    Attributes
    ----------
    buffer : uint8 (b,)
        Bytes of the text; comments may be blank, but every byte is where it is in the file.
    starts : int64 (l + 1,)
        First byte of each line, which ends where the next one begins.
    first : int64 (l + 1,)
        First token of each line.
    token_starts, token_ends : int64 (t,)
        First byte of each token, and the byte after its last.
    """

    buffer: Bytes
    starts: Ints
    first: Ints
    token_starts: Ints
    token_ends: Ints

    @property
    def counts(self) -> Ints:
        """Number of tokens of each line, int64 (l,)."""
        return np.diff(self.first)

    def keywords(self) -> NDArray[np.uint64]:
        """Return the first token of each line as `keyword` does, uint64 (l,)."""
        return keywords(self.buffer, self.token_starts, self.token_ends, self.first[:-1])

    def error(self, token: int, message: str) -> MeshError:
        """Return an error about a token, which names the line of the file."""
        return MeshError(f"line {self.number(int(self.token_starts[token]))}: {message}")

    def number(self, offset: int) -> int:
        """Return the number of the line of a byte, from 1."""
        return int(np.count_nonzero(self.buffer[:offset] == ord("\n"))) + 1

    def token(self, i: int) -> bytes:
        """Return the bytes of a token."""
        return self.buffer[self.token_starts[i] : self.token_ends[i]].tobytes()


def keyword(text: bytes) -> np.uint64:
    """Return the first eight bytes of a keyword as a number, so that arrays of them compare."""
    return np.uint64(int.from_bytes(text[:8], "little"))


def keywords(buffer: Bytes, starts: Ints, ends: Ints, tokens: Ints) -> NDArray[np.uint64]:
    """Return the first eight bytes of some tokens as `keyword` does, uint64 (len(tokens),)."""
    found = np.zeros(len(tokens), dtype=np.uint64)
    starts, lengths = starts[tokens], ends[tokens] - starts[tokens]
    for i in range(8):
        has = lengths > i
        found[has] |= buffer[starts[has] + i].astype(np.uint64) << np.uint64(8 * i)
    return found


def blanked(pattern: re.Pattern[bytes], data: bytes) -> bytes:
    """Replace each match of a pattern by as many spaces, so that every other byte stays put."""
    return pattern.sub(lambda found: b" " * len(found[0]), data)


def split_lines(data: bytes) -> Lines:
    """Return the lines and tokens of a text."""
    buffer = np.frombuffer(data, dtype=np.uint8)
    token_starts, token_ends = token_bounds(buffer)
    begins = np.concatenate(([0], np.flatnonzero(buffer == ord("\n")) + 1))
    first = np.searchsorted(token_starts, begins)
    has = np.diff(first, append=len(token_starts)) > 0
    starts = np.append(begins[has], len(buffer))
    starts[0] = 0
    return Lines(buffer, starts, np.append(first[has], len(token_starts)), token_starts, token_ends)


def token_bounds(buffer: Bytes) -> tuple[Ints, Ints]:
    """Return the first byte of each token and the byte after its last; white space separates."""
    inside = np.zeros(len(buffer) + 2, dtype=bool)
    np.logical_not((buffer == 32) | ((buffer >= 9) & (buffer <= 13)), out=inside[1:-1])
    changes = np.flatnonzero(inside[1:] != inside[:-1])
    return changes[::2], changes[1::2]


def without_first_tokens(lines: Lines, chosen: Bools) -> tuple[Bytes, Ints]:
    """Return the text of some lines with blanks for their first tokens.

    Parameters
    ----------
    lines : Lines
    chosen : bool (l,)

    Returns
    -------
    text : uint8
    tokens : int64
        The tokens of `lines` that are left in it.
    """
    copy = lines.buffer.copy()
    firsts = lines.first[:-1][chosen]
    blank_tokens(copy, lines, firsts)
    is_first = np.zeros(len(lines.token_starts), dtype=bool)
    is_first[firsts] = True
    tokens = np.flatnonzero(np.repeat(chosen, lines.counts) & ~is_first)
    return copy[np.repeat(chosen, np.diff(lines.starts))], tokens


def blank_tokens(buffer: Bytes, lines: Lines, tokens: Ints) -> None:
    """Write spaces over some tokens, in the buffer itself."""
    starts = lines.token_starts[tokens]
    lengths = lines.token_ends[tokens] - starts
    for i in range(int(lengths.max(initial=0))):
        buffer[starts[lengths > i] + i] = ord(" ")


def read_numbers(text: Bytes, lines: Lines, tokens: Ints, dtype: type = float) -> NDArray[Any]:
    """Return the numbers of a text, one for each of its tokens.

    Parameters
    ----------
    text : uint8
    lines : Lines
        Lines that the text is a part of.
    tokens : int64 (t,)
        Tokens of `lines` that are in the text, in its order.
    dtype : {float, int}

    Raises
    ------
    MeshError
        For a token that is not such a number; the line is named.
    """
    if not len(tokens):
        return np.empty(0, dtype=dtype)
    raw = text.tobytes()
    found = _parsed(raw, dtype)
    if found is None and dtype is float:
        found = _parsed(_respelled(raw), dtype)
    if found is None or len(found) != len(tokens):
        form, what = (_NUMBER, "number") if dtype is float else (_INTEGER, "whole number")
        for i in tokens.tolist():
            if not form.fullmatch(_respelled(token := lines.token(i))):
                raise lines.error(i, f"{quoted(token)} is not a {what}")
        raise MeshError("its text has numbers without a separator between them")
    return found


def _respelled(text: bytes) -> bytes:
    """Return a text with the usual spelling of numbers of Microsoft's C library and of Fortran."""
    if b"#" in text:
        text = _MSVC_NUMBER.sub(lambda x: x[1] + (b"inf" if x[2] else b"nan"), text)
    return _FORTRAN_EXPONENT.sub(b"e", text)


def _parsed(text: bytes, dtype: type = float) -> NDArray[Any] | None:
    """Return all numbers of a text that is not blank, or None when it has other tokens too."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # numpy 2.0 to 2.2 only warn
        try:
            return np.fromstring(text, dtype=dtype, sep=" ")
        except (ValueError, DeprecationWarning):
            return None


def quoted(token: bytes) -> str:
    """Return a token, or its beginning, in quotes for a message."""
    return repr(as_text(token[:40]).encode("utf-8", "replace").decode())


def as_text(raw: bytes) -> str:
    """Return a name or a comment as text; `ENCODING` makes the same bytes of it."""
    return raw.decode(*ENCODING)


def one_line(name: str) -> str:
    """Return a name or a comment on one line, which does not continue on the next one."""
    line = " ".join(re.split(r"[\r\n]+", name))
    return f"{line} " if line.endswith("\\") else line
