"""Colours as fractions from 0 to 1, which text formats and other libraries have."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.polymesh.mesh import Attribute


def is_rgb(attribute: Attribute) -> bool:
    """Return whether an attribute has three or four channels that are or stand for fractions."""
    are_fractions = attribute.normalized or attribute.values.dtype.kind == "f"
    return attribute.role == "colour" and attribute.width in (3, 4) and are_fractions


def as_fractions(values: NDArray[Any], *, normalized: bool) -> NDArray[Any]:
    """Return integers that stand for fractions (`normalized`) as these; other numbers stay."""
    if not normalized or values.dtype.kind not in "iu":
        return values
    return values / np.iinfo(values.dtype).max
