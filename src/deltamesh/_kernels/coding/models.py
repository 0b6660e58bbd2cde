"""Probability models of kernels: slots and mixers, as the core has them."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import POINTER, c_char_p, c_int32, c_int64
from typing import ClassVar, NamedTuple

from deltamesh._kernels.core import LIBRARY

# Number of inputs of each mixer, and the bound of the counts of its slots.
Mixers = Sequence[tuple[int, int]]


class Model(NamedTuple):
    """Memory of a coder.

    Attributes
    ----------
    slots : int
        Number of adaptive probabilities.
    mixers : Mixers
    """

    slots: int
    mixers: Mixers


class _Mixers(ctypes.Structure):
    _fields_: ClassVar = [("count", c_int32), ("inputs", c_int32), ("limit", c_int32)]


class _Range(ctypes.Structure):
    _fields_: ClassVar = [("name", c_char_p), ("first", c_int64)]


class _Model(ctypes.Structure):
    _fields_: ClassVar = [
        ("name", c_char_p),
        ("slots", c_int64),
        ("mixers", POINTER(_Mixers)),
        ("mixers_count", c_int64),
        ("ranges", POINTER(_Range)),
        ("ranges_count", c_int64),
    ]


LIBRARY.dm_find_model.restype = POINTER(_Model)


def _find(name: str) -> _Model:
    found = LIBRARY.dm_find_model(name.encode())
    if not found:
        raise KeyError(name)
    model: _Model = found.contents
    return model


def model_of(name: str) -> Model:
    """Return a model of the core by its name."""
    found = _find(name)
    kinds = found.mixers[: found.mixers_count]
    return Model(
        found.slots, tuple((kind.inputs, kind.limit) for kind in kinds for _ in range(kind.count))
    )


def ranges_of(name: str) -> dict[str, int]:
    """Return the first slot of each range of contexts of a model."""
    found = _find(name)
    return {row.name.decode(): row.first for row in found.ranges[: found.ranges_count]}
