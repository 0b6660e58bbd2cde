"""Columns that programs compute from decimals or from integers, of each kind that is found."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from places import BENCHMARKS

sys.path.append(str(BENCHMARKS))
_benchmark: Any = importlib.import_module("conversions")

Column = NDArray[np.float64]
KINDS, as_single = _benchmark.KINDS, _benchmark.as_single


def walk(count: int, seed: int) -> Column:
    """Numbers of which each is near the one before, as those of neighbours are."""
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.normal(size=count)) / 2 + rng.normal(size=count)


def made(kind: str, count: int, seed: int = 0) -> tuple[bool, Column]:
    """Return whether values of a kind are float32, and these."""
    single, function = KINDS[kind]
    decimals = walk(count, seed).round(3)
    return single, function(as_single(decimals) if single else decimals)
