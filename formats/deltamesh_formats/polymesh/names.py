"""Names of which no two are alike."""

from __future__ import annotations

from collections.abc import Collection, Iterable


def distinct_names(
    names: Iterable[str], *, reserved: Collection[str] = (), stem: str = ""
) -> list[str]:
    """Return names of which no two are alike: the later of equal ones get a number, from 2.

    Parameters
    ----------
    names : iterable of str
    reserved : collection of str
        Names that are taken: what has one of them gets a number too.
    stem : str
        What stands before the number of an empty name.
    """
    names = list(names)
    taken, next_number = {*names, *reserved}, dict.fromkeys(reserved, 1)
    found = []
    for name in names:
        unique = name
        if name in next_number:
            while unique in taken:
                next_number[name] += 1
                unique = f"{name or stem}_{next_number[name]}"
        next_number.setdefault(name, 1)
        taken.add(unique)
        found.append(unique)
    return found
