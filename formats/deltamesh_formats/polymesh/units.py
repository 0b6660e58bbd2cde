"""Units of length: their names in mesh files, and what they are in metres."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Final

# By the names of the 3MF Core Specification, which `PolyMesh.metadata` has under "units".
METRES: Final[Mapping[str, float]] = {
    "micron": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "inch": 0.0254,
    "foot": 0.3048,
    "meter": 1.0,
}
# As people write them.
SYMBOLS: Final[Mapping[str, str]] = {
    "um": "micron",
    "µm": "micron",
    "mm": "millimeter",
    "cm": "centimeter",
    "in": "inch",
    "ft": "foot",
    "m": "meter",
}
_NAMED: Final = re.compile(r"(?:([0-9.e+-]+) )?(\w+)")


def metres(unit: str) -> float | None:
    """Return the length of a unit such as "inch" or "0.3 meter" in metres; None if it has none."""
    found = _NAMED.fullmatch(unit)
    if found is None or found[2] not in METRES:
        return None
    try:
        length = float(found[1] or 1) * METRES[found[2]]
    except ValueError:
        return None
    return length if 0 < length < math.inf else None
