"""Sequences of different numbers, most of which are the next one left."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.coding.remaining import all_of, count_below, next_left, remove, select
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, kernel
from deltamesh_formats.array_types import Ints

SLOTS = 8
MIXERS = ((1, 255),)
MODEL = Model(SLOTS, MIXERS)


@kernel
def code_choices(c: Coder, numbers: Ints, count: Int) -> Flag:
    """Code different numbers below `count`, filled in when decoding; at most so many.

    Return whether each that was the next one left was coded so.
    """
    left = all_of(np.int64(count))
    previous, history = np.int64(-1), np.int64(0)
    for i in range(len(numbers)):
        following = next_left(left, previous + 1)
        number = numbers[i]
        c.state[CONTEXT] = history
        bit = code_bit(c, np.int64(number == following), np.int64(0))
        if bit == 1:
            number = following
        else:
            number = select(left, code_below(c, count_below(left, number), count - i))
            if number == following:
                return False
        remove(left, number)
        numbers[i], previous = number, number
        history = (2 * history + bit) % SLOTS
    return True
