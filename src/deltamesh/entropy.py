"""Setting up the entropy coder; its arithmetic is in `deltamesh.kernels.coder`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.coder import (
    MASK32,
    MAX_INPUTS,
    POSITION,
    RANGE,
    STATE_SIZE,
    UNKNOWN,
    WEIGHTS,
    Coder,
    finish_encoding,
    start_decoding,
)
from deltamesh_formats.errors import FormatError

# Small files learn faster from a mixer that starts a little above the mean of its inputs, which
# are all too careful at first, than from one that starts at zero.
INITIAL_WEIGHT_SUM = 1.2

# No element takes more: three numbers of 31 + 31 + 1 bits, each of at most log2(65536 / P_MIN)
# = 11.5. What is reserved and not written costs no memory.
ELEMENT_BYTES = 280


def _coder(data: NDArray[np.uint8], slots: int, inputs: Sequence[int]) -> Coder:
    state = np.zeros(STATE_SIZE, dtype=np.int64)
    state[RANGE] = MASK32
    state[WEIGHTS] = slots
    sums = [1.0 if n == 1 else INITIAL_WEIGHT_SUM for n in inputs]
    weights = [round(65536 * total / n) for total, n in zip(sums, inputs, strict=True)]
    memory = np.concatenate([np.full(slots, UNKNOWN), np.repeat(weights, MAX_INPUTS)])
    return Coder(state, memory.astype(np.int64), data)


def encoder(elements: int, slots: int, inputs: Sequence[int]) -> Coder:
    """Return a coder for that many vertices, faces or points; `inputs` are those of each mixer."""
    coder = _coder(np.zeros(1024 + ELEMENT_BYTES * elements, dtype=np.uint8), slots, inputs)
    coder.state[POSITION] = -1  # the first byte that leaves LOW is always zero: not stored
    return coder


def decoder(payload: bytes | memoryview, slots: int, inputs: Sequence[int]) -> Coder:
    """Return a coder that reads `payload`."""
    # A copy: a read-only array would be another type, and every kernel compiled for it again.
    coder = _coder(np.frombuffer(payload, dtype=np.uint8).copy(), slots, inputs)
    start_decoding(coder)
    return coder


def finish(coder: Coder) -> bytes:
    """Flush an encoder and return what it has written."""
    length = finish_encoding(coder)
    return coder.data[:length].tobytes()


def check_end(coder: Coder, offset: int) -> None:
    """Refuse a stream of which a decoder has left bytes unread.

    Raises
    ------
    FormatError
        With the place of the first unread byte; `offset` is where the stream begins.
    """
    position = int(coder.state[POSITION])
    if position < len(coder.data):
        raise FormatError("bytes are left over after the end of a stream", offset + position)
