"""Valences, joins and the ends of joins that the region grower codes; `src/core/valence.h`."""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import call, number

MODEL = model_of("valence")
SLOTS, MIXERS = MODEL


def code_below(c: Coder, value: int, bound: int) -> int:
    """Code a number in [0, bound), all equally likely, in the fewest bits or one more."""
    coded = number()
    call("dm_below", c.pointer, value, bound, byref(coded))
    return coded.value
