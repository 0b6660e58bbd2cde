"""Settings of encoders whose files have as many bytes as wanted."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

# A file counts as one of as many bytes when it is no larger and at most 1 % smaller.
CLOSE = 0.99
MOST_DOUBLINGS, MOST_TRIES = 10, 12


def nearest_bits(sizes: Mapping[int, int], budget: float) -> int:
    """Return the bits whose file is nearest to a number of bytes."""
    return min(sizes, key=lambda bits: abs(sizes[bits] - budget))


def fitting(size_of: Callable[[float], int], budget: int, start: float) -> float:
    """Return a setting whose file has as many bytes as allowed, or up to 1 % less.

    Parameters
    ----------
    size_of : callable
        Bytes at a setting; they fall as it grows.
    budget : int
    start : float
        Where to begin. Settings have four digits, so that they can be typed.

    Raises
    ------
    LookupError
        If no file is so small, or all are.
    """
    fine = coarse = rounded(start)
    for _ in range(MOST_DOUBLINGS):
        if size_of(fine) > budget:
            break
        coarse, fine = fine, rounded(fine / 2)
    for _ in range(MOST_DOUBLINGS):
        if size_of(coarse) <= budget:
            break
        fine, coarse = coarse, rounded(coarse * 2)
    if not size_of(coarse) <= budget < size_of(fine):
        raise LookupError(f"no file of {budget} bytes between settings {fine:g} and {coarse:g}")
    for _ in range(MOST_TRIES):
        small, large = size_of(coarse), size_of(fine)
        if small >= CLOSE * budget:
            break
        share = math.log(large / (math.sqrt(CLOSE) * budget)) / math.log(large / small)
        setting = rounded(fine * (coarse / fine) ** min(max(share, 0.1), 0.9))
        if setting in (fine, coarse):
            break
        fine, coarse = (fine, setting) if size_of(setting) <= budget else (setting, coarse)
    return coarse


def rounded(setting: float) -> float:
    """Return a number of four digits."""
    return float(f"{setting:.4g}")
