"""Compiled core: the library of `src/core`, and the checks before it gets a pointer.

It is loaded without Python's headers, so that one library serves every Python, and a call releases
the interpreter lock. Nothing is compiled here: an installation has done that.
"""

from __future__ import annotations

import ctypes
import sys
from ctypes import c_double, c_int64, c_void_p
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_SUFFIX: Final = {"win32": "dll", "darwin": "dylib"}.get(sys.platform, "so")
PATH: Final = Path(__file__).with_name(f"_core.{_SUFFIX}")


def _load() -> ctypes.CDLL:
    try:
        return ctypes.CDLL(str(PATH))
    except OSError as error:
        raise ImportError(
            f"the compiled core cannot be loaded ({error}); an installation compiles it, and so "
            "does `python src/core/build.py` in a checkout"
        ) from error


LIBRARY: Final = _load()


def constant(name: str) -> int:
    """Return a number of the core by its name."""
    value = c_int64()
    if LIBRARY.dm_find_constant(name.encode(), ctypes.byref(value)):
        raise KeyError(name)
    return value.value


# Status of a call; see `src/core/deltamesh_core.h`.
OK, INVALID = constant("DM_OK"), constant("DM_INVALID")


def _pointer(
    array: NDArray[Any], dtype: type[np.generic], shape: tuple[int, ...], written: bool
) -> c_void_p:
    if (
        array.dtype != dtype
        or array.shape != shape
        or not array.flags.c_contiguous
        or (written and not array.flags.writeable)
    ):
        raise ValueError(
            f"an array of {array.dtype}, {array.shape}, where the core takes a contiguous one of "
            f"{np.dtype(dtype)}, {shape}"
        )
    return address(array)


def address(array: NDArray[Any]) -> c_void_p:
    """Return the pointer to an array of any kind, which it keeps; the caller has checked it."""
    pointer = c_void_p(array.__array_interface__["data"][0])
    pointer.array = array  # type: ignore[attr-defined]
    return pointer


def ints(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to int64 numbers of a shape, to be read.

    Raises
    ------
    ValueError
        If the array is another one.
    """
    return _pointer(array, np.int64, shape, written=False)


def ints_out(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to int64 numbers of a shape, to be written; see `ints`."""
    return _pointer(array, np.int64, shape, written=True)


def floats(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to float64 numbers of a shape, to be read; see `ints`."""
    return _pointer(array, np.float64, shape, written=False)


def floats_out(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to float64 numbers of a shape, to be written; see `ints`."""
    return _pointer(array, np.float64, shape, written=True)


def shorts(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to int32 numbers of a shape, to be read; see `ints`."""
    return _pointer(array, np.int32, shape, written=False)


def shorts_out(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to int32 numbers of a shape, to be written; see `ints`."""
    return _pointer(array, np.int32, shape, written=True)


def singles(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to float32 numbers of a shape, to be read; see `ints`."""
    return _pointer(array, np.float32, shape, written=False)


def singles_out(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to float32 numbers of a shape, to be written; see `ints`."""
    return _pointer(array, np.float32, shape, written=True)


def bools(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to flags of a shape, to be read; see `ints`."""
    return _pointer(array, np.bool_, shape, written=False)


def bools_out(array: NDArray[Any], *shape: int) -> c_void_p:
    """Return the pointer to flags of a shape, to be written; see `ints`."""
    return _pointer(array, np.bool_, shape, written=True)


def scratch(*shape: int) -> c_void_p:
    """Return a pointer to int64 numbers that a call may use, of any value."""
    return address(np.empty(shape, dtype=np.int64))


def graph(indptr: NDArray[Any], indices: NDArray[Any], n: int) -> tuple[object, ...]:
    """Return the four arguments that the neighbours of n vertices are; see `adjacency`."""
    entries = len(indices)
    return shorts(indptr, n + 1), n, shorts(indices, entries), entries


def number() -> c_int64:
    """Return a place for a number that a call sets."""
    return c_int64()


def call(name: str, *arguments: object) -> int:
    """Call a function of the core; return its status, OK or that of a corrupt stream.

    Parameters
    ----------
    name : str
    *arguments : int, float, or what `ctypes` takes
        Integers are passed as of 64 bits.

    Raises
    ------
    ValueError
        If the core finds that the arguments contradict each other.
    """
    status = invoke(name, *arguments)
    if status == INVALID:
        raise ValueError(f"{name}: arguments that contradict each other")
    return status


def invoke(name: str, *arguments: object) -> int:
    """Call a function of the core, and return what it does; for the arguments, see `call`."""
    result: int = getattr(LIBRARY, name)(*map(_converted, arguments))
    return result


def _converted(argument: object) -> object:
    if isinstance(argument, float):
        return c_double(argument)
    if isinstance(argument, int | np.integer):
        return c_int64(int(argument))
    return argument


def table(name: str, dtype: type[np.generic], size: int) -> NDArray[Any]:
    """Return a table of the core, read-only."""
    memory = (ctypes.c_char * (size * np.dtype(dtype).itemsize)).in_dll(LIBRARY, name)
    return np.frombuffer(memoryview(memory).toreadonly(), dtype=dtype)
