"""Text files as arrays of lines and tokens, and the numbers in them, read all at once.

Nothing here loops over lines in Python: a byte is a separator or not, a token begins where a byte
that is none follows one that is. `numpy.fromstring` then reads all numbers in one call, each to
the nearest float64.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.errors import MeshError

Bytes = NDArray[np.uint8]
Indices = NDArray[np.int64]

_NUMBER: Final = re.compile(
    rb"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|inf(?:inity)?)", re.IGNORECASE
)
_INTEGER: Final = re.compile(rb"[+-]?\d+")
# Names may be in any encoding: the bytes that are no UTF-8 come back when they are written.
ENCODING: Final = ("utf-8", "surrogateescape")


@dataclass(frozen=True)
class Lines:
    """The lines of a text that have tokens, as indices into its bytes.

    Attributes
    ----------
    buffer : uint8 (b,)
        The text; comments may be blank, but every byte is where it is in the file.
    starts : int64 (l + 1,)
        Where each line begins, up to the next one's beginning.
    first : int64 (l + 1,)
        The first token of each line.
    token_starts, token_ends : int64 (t,)
    """

    buffer: Bytes
    starts: Indices
    first: Indices
    token_starts: Indices
    token_ends: Indices

    @property
    def counts(self) -> Indices:
        """Tokens of each line."""
        return np.diff(self.first)

    def words(self) -> NDArray[np.uint64]:
        """Return the first eight bytes of the first token of each line as numbers, as `word`."""
        return words(self.buffer, self.token_starts, self.token_ends, self.first[:-1])

    def error(self, token: int, message: str) -> MeshError:
        """Return the refusal of a token, with the line of the file that it is in."""
        return MeshError(f"line {self.number(int(self.token_starts[token]))}: {message}")

    def number(self, offset: int) -> int:
        """Return the number of the line, from 1, that a byte is in."""
        return int(np.count_nonzero(self.buffer[:offset] == ord("\n"))) + 1

    def token(self, i: int) -> bytes:
        """Return a token."""
        return self.buffer[self.token_starts[i] : self.token_ends[i]].tobytes()


def word(text: bytes) -> np.uint64:
    """Return a keyword of at most eight bytes as a number."""
    return np.uint64(int.from_bytes(text, "little"))


def words(buffer: Bytes, starts: Indices, ends: Indices, tokens: Indices) -> NDArray[np.uint64]:
    """Return the first eight bytes of these tokens, each as a number."""
    found = np.zeros(len(tokens), dtype=np.uint64)
    starts, lengths = starts[tokens], ends[tokens] - starts[tokens]
    for i in range(8):
        has = lengths > i
        found[has] |= buffer[starts[has] + i].astype(np.uint64) << np.uint64(8 * i)
    return found


def normal_ends(data: bytes) -> bytes:
    """Return a text whose lines end in line feeds, as old Macintosh files do not."""
    return data.replace(b"\r", b"\n") if b"\r" in data and b"\n" not in data else data


def blanked(pattern: re.Pattern[bytes], data: bytes) -> bytes:
    """Replace what matches a pattern by as many spaces, so that every other byte stays put."""
    return pattern.sub(lambda found: b" " * len(found[0]), data)


def split(data: bytes) -> Lines:
    """Find the lines and tokens of a text."""
    buffer = np.frombuffer(data, dtype=np.uint8)
    token_starts, token_ends = tokens_of(buffer)
    begins = np.concatenate(([0], np.flatnonzero(buffer == ord("\n")) + 1))
    first = np.searchsorted(token_starts, begins)
    has = np.diff(first, append=len(token_starts)) > 0
    starts = np.append(begins[has], len(buffer))
    starts[0] = 0
    return Lines(buffer, starts, np.append(first[has], len(token_starts)), token_starts, token_ends)


def tokens_of(buffer: Bytes) -> tuple[Indices, Indices]:
    """Return where each run of bytes that are no white space begins and ends."""
    inside = np.zeros(len(buffer) + 2, dtype=bool)
    np.logical_not((buffer == 32) | ((buffer >= 9) & (buffer <= 13)), out=inside[1:-1])
    changes = np.flatnonzero(inside[1:] != inside[:-1])
    return changes[::2], changes[1::2]


def cut_out(lines: Lines, chosen: NDArray[np.bool_]) -> tuple[Bytes, Indices]:
    """Return the text of some lines without their first tokens, and the tokens it has.

    Parameters
    ----------
    lines : Lines
    chosen : bool (l,)
    """
    copy = lines.buffer.copy()
    firsts = lines.first[:-1][chosen]
    blank(copy, lines, firsts)
    is_first = np.zeros(len(lines.token_starts), dtype=bool)
    is_first[firsts] = True
    tokens = np.flatnonzero(np.repeat(chosen, lines.counts) & ~is_first)
    return copy[np.repeat(chosen, np.diff(lines.starts))], tokens


def blank(buffer: Bytes, lines: Lines, tokens: Indices) -> None:
    """Write spaces over some tokens."""
    starts = lines.token_starts[tokens]
    lengths = lines.token_ends[tokens] - starts
    for i in range(int(lengths.max(initial=0))):
        buffer[starts[lengths > i] + i] = ord(" ")


def numbers(text: Bytes, lines: Lines, tokens: Indices, dtype: type = float) -> NDArray[Any]:
    """Return the numbers of a text, one for each of its tokens.

    Parameters
    ----------
    text : uint8
        The text.
    lines : Lines
        What it was cut out of.
    tokens : int64 (t,)
        The tokens of `lines` that it has, in its order.
    dtype : {float, int}

    Raises
    ------
    MeshError
        For a token that is no such number; the line is named.
    """
    if not len(tokens):
        return np.empty(0, dtype=dtype)
    found = parsed(text, dtype)
    if found is None or len(found) != len(tokens):
        form, what = (_NUMBER, "number") if dtype is float else (_INTEGER, "whole number")
        for i in tokens.tolist():
            if not form.fullmatch(token := lines.token(i)):
                raise lines.error(i, f"{shown(token)} is not a {what}")
        raise MeshError("its text has numbers that cannot be told apart")
    return found


def parsed(text: Bytes, dtype: type = float) -> NDArray[Any] | None:
    """Return all numbers of a text that is not blank, or None when it has something else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # numpy 2.0 to 2.2 only warn
        try:
            return np.fromstring(text.tobytes(), dtype=dtype, sep=" ")
        except (ValueError, DeprecationWarning):
            return None


def shown(token: bytes) -> str:
    """Return a token fit for a message."""
    return repr(decoded(token[:40]).encode("utf-8", "replace").decode())


def decoded(raw: bytes) -> str:
    """Return a name or a comment as text."""
    return raw.decode(*ENCODING)


def one_line(name: str) -> str:
    """Return a name or a comment without ends of lines, that does not continue in the next."""
    line = " ".join(re.split(r"[\r\n]+", name))
    return f"{line} " if line.endswith("\\") else line
