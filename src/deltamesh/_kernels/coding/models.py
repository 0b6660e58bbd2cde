"""Probability models of kernels: slots and mixers, and the layout of the slots."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import NamedTuple


class Model(NamedTuple):
    """Memory of a coder.

    Attributes
    ----------
    slots : int
        Number of adaptive probabilities.
    mixers : sequence of (int, int)
        Number of inputs of each mixer, and the bound of the counts of its slots.
    """

    slots: int
    mixers: Sequence[tuple[int, int]]


def layout(*ranges: tuple[int, ...]) -> tuple[int, ...]:
    """Return the first slot of each range of contexts, one range after the other, and the end.

    Parameters
    ----------
    *ranges : tuple of int
        The sizes of the dimensions of each range. In its product, a context (i, j, k) of the sizes
        (a, b, c) has the slot begin + (i * b + j) * c + k.
    """
    begins = [0]
    for sizes in ranges:
        begins.append(begins[-1] + prod(sizes))
    return tuple(begins)
