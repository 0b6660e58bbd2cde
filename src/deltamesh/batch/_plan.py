"""Names of outputs, and tasks of an input and an output each."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

from deltamesh_formats.errors import OptionError
from deltamesh_formats.places import base_name, joined, path_below
from deltamesh_formats.remote import is_url


@dataclass(frozen=True)
class Task:
    """One file to work on.

    Attributes
    ----------
    source, target : str
        Names of the input and of the output, paths or URLs.
    size : int
        Of the input, in bytes.
    need : float
        Memory that the work is estimated to take, in bytes.
    overwrite : bool
        Whether an output that is there when the work is done is replaced.
    """

    source: str
    target: str
    size: int
    need: float = 0.0
    overwrite: bool = True


def flat(folder: str, name: str) -> str:
    """Return the place of a file when all go into one folder."""
    return joined(folder, base_name(name))


def mirrored(folder: str, name: str) -> str:
    """Return the place of a file when the folders above it are made anew in `folder`.

    The name of a file counts as it was given, without the root: `scans/a.ply` and `/scans/a.ply`
    have the same place. Of a URL, the part above the path counts as a folder:
    `s3://bucket/a.ply` is `bucket/a.ply`.

    Raises
    ------
    OptionError
        If the name leads out of the current folder.
    """
    path = path_below(name)
    if path.split(os.sep)[0] == os.pardir:
        raise OptionError(f"{name!r} is not below this folder, and has no place in a mirror of it")
    return joined(folder, path)


def check_targets(pairs: Iterable[tuple[str, str]]) -> None:
    """Refuse a plan in which two files have one output, or an output is an input.

    Parameters
    ----------
    pairs : iterable of (source, target)

    Raises
    ------
    OptionError
        It names the first two files.
    """
    pairs = list(pairs)
    sources = {_place(source): source for source, _ in pairs}
    targets: dict[str, str] = {}
    for source, target in pairs:
        place = _place(target)
        if place in sources:
            raise OptionError(f"{target!r} would be written, but is an input")
        other = targets.setdefault(place, source)
        if other != source:
            raise OptionError(f"{other!r} and {source!r} would both be written to {target!r}")


def _place(name: str) -> str:
    """Return what two names of one file have in common; the file itself may be a link."""
    if is_url(name):
        return name
    folder, last = os.path.split(os.path.abspath(name))
    return os.path.normcase(os.path.join(_real(folder), last))


_real = cache(os.path.realpath)
