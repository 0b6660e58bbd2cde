"""What a writer returns."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple


class Written(NamedTuple):
    """The bytes of a mesh file, and words for what of the mesh they do not hold."""

    data: bytes
    lost: tuple[str, ...]


def numbered(names: Sequence[str], what: str, reserved: Collection[str] = ("",)) -> list[str]:
    """Return names of which no two are alike: to the later ones, and the reserved, add a number."""
    taken, next_number, found = {*names, *reserved}, dict.fromkeys(reserved, 1), []
    for name in names:
        unique = name
        if name in next_number:
            while unique in taken:
                next_number[name] += 1
                unique = f"{name or what}_{next_number[name]}"
        next_number.setdefault(name, 1)
        taken.add(unique)
        found.append(unique)
    return found
