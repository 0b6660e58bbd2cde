"""Exceptions in one tree, by which a caller knows whose fault a failure is.

`MeshError`: the mesh that was handed in. `FormatError`: the bytes of a file. `LimitError`: a
limit that the caller set. `TargetError`: a quality that cannot be had. `SolveError`: the linear
solver.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class DeltameshError(Exception):
    """Base of everything that deltamesh raises on purpose.

    Attributes
    ----------
    frame : int or None
        Of a sequence, the frame at fault, from 0, if one is.
    """

    frame: int | None = None


class MeshError(DeltameshError, ValueError):
    """The mesh, or its file, cannot be encoded; the message names the first element at fault."""


class NoSurfaceError(MeshError):
    """The mesh has no faces: it is a cloud of points, or a set of lines."""


class FormatError(DeltameshError, ValueError):
    """The bytes are not a valid `.dmesh` file, or the compression around a file is damaged.

    Parameters
    ----------
    message : str
        What is wrong.
    offset : int or None
        Where, in bytes from the start of the file, as far as it is known.
    """

    def __init__(self, message: str, offset: int | None = None) -> None:
        super().__init__(message if offset is None else f"{message} (at byte {offset})")
        self.reason = message
        self.offset = offset


def in_frame(error: DeltameshError, index: int) -> DeltameshError:
    """Return an error of the same kind that names the frame at fault in its message."""
    made = type(error)(f"frame {index}: {error}")
    made.frame = index
    return made


@contextmanager
def located(start: int, prefix: str = "") -> Iterator[None]:
    """Context in which offsets of a `FormatError` count from byte `start` of what is outside it.

    Parameters
    ----------
    start : int
        Where the bytes that are read inside begin, in those that are read outside.
    prefix : str
        Put before the message.

    Raises
    ------
    FormatError
        The one that was raised inside, with the offset that it has outside.
    """
    try:
        yield
    except FormatError as error:
        offset = start + (error.offset or 0)
        raise FormatError(prefix + error.reason, offset) from None


class LimitError(DeltameshError):
    """Decoding would need more than the caller allows; nothing has been allocated."""


class TargetError(DeltameshError):
    """The quality that was asked for cannot be reached."""


class SolveError(DeltameshError):
    """The least-squares system could not be factored or solved."""


class OptionError(DeltameshError, ValueError):
    """An option that is out of range, or that does not go with another one."""


# Users know them as `deltamesh.MeshError` and so on, so that is what a traceback says.
for _error in (
    DeltameshError,
    MeshError,
    NoSurfaceError,
    FormatError,
    LimitError,
    TargetError,
    SolveError,
    OptionError,
):
    _error.__module__ = "deltamesh"
del _error
