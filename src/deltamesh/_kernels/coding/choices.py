"""Sequences of different numbers, most of which are the next one left; `src/core/choices.c`."""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import OK, call, ints_out, scratch
from deltamesh_formats.array_types import Ints

MODEL = model_of("choices")
SLOTS, MIXERS = MODEL


def code_choices(c: Coder, numbers: Ints, count: int) -> bool:
    """Code different numbers below `count`, filled in when decoding; at most so many.

    Return whether each that was the next one left was coded so.
    """
    length = len(numbers)
    memory = scratch(count + 1), scratch(count + 1)
    arrays = ints_out(numbers, length), length, count, *memory
    return call("dm_code_choices", c.pointer, *arrays) == OK
