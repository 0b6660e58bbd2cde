"""Entropy coder: streams of a model; the arithmetic is in `deltamesh._kernels.coding.coder`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from deltamesh._kernels.coding.coder import Coder, finish_encoding, is_finished, new_coder
from deltamesh._kernels.coding.models import Mixers, Model
from deltamesh_formats.errors import FormatError

# No element takes more: three numbers of 31 + 31 + 1 bits, each of at most log2(65536 / P_MIN)
# = 11.5. Reserved bytes that are not written cost no memory.
ELEMENT_BYTES = 280

_Result = TypeVar("_Result")


def encode_with(model: Model, elements: int, run: Callable[[Coder], object]) -> bytes:
    """Return the stream that a kernel writes.

    Parameters
    ----------
    model : Model
    elements : int
        Number of vertices, faces or points that are coded.
    run : callable
        Runs the kernel with the encoder that it is given.
    """
    coder = encoder(elements, *model)
    run(coder)
    return finish(coder)


def decode_with(
    model: Model, payload: bytes | memoryview, run: Callable[[Coder], _Result], offset: int = 0
) -> _Result:
    """Return what a kernel reads from a stream, and check that the stream ends there.

    Parameters
    ----------
    model : Model
    payload : bytes or memoryview
        The stream.
    run : callable
        Runs the kernel with the decoder that it is given, and returns the result.
    offset : int
        Position of the stream in its section.

    Raises
    ------
    FormatError
        If the stream ends before or after the last element; its offset counts from the beginning
        of the section.
    """
    coder = decoder(payload, *model)
    result = run(coder)
    check_end(coder, offset)
    return result


def encoder(elements: int, slots: int, mixers: Mixers) -> Coder:
    """Return a coder for that many vertices, faces or points; each mixer is (inputs, limit)."""
    data = np.zeros(1024 + ELEMENT_BYTES * elements, dtype=np.uint8)
    return new_coder(Model(slots, mixers), data, decoding=False)


def decoder(payload: bytes | memoryview, slots: int, mixers: Mixers) -> Coder:
    """Return a coder that reads `payload`."""
    return new_coder(Model(slots, mixers), np.frombuffer(payload, dtype=np.uint8), decoding=True)


def finish(coder: Coder) -> bytes:
    """Flush an encoder and return its stream."""
    length = finish_encoding(coder)
    return coder.data[:length].tobytes()


def check_end(coder: Coder, offset: int) -> None:
    """Refuse a stream that does not end at the position of its decoder.

    Raises
    ------
    FormatError
        With the position; `offset` is that of the stream.
    """
    size, position = len(coder.data), int(coder.registers.position)
    if size and coder.data[-1] == 0:
        raise FormatError("a zero byte at the end of a stream", offset + size - 1)
    if position < size or not is_finished(coder):
        raise FormatError(
            "a stream that does not end where it should", offset + min(position, size)
        )
