"""Progress of encoder and decoder, reported as the names of their stages."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from deltamesh_formats.arguments import require

# Called with the name of each stage as it begins.
Progress: TypeAlias = Callable[[str], None]


def silent(stage: str) -> None:
    """Do nothing: the progress that nobody watches."""


def heard(progress: Progress | None) -> Progress:
    """Return the progress that a user has given, or one that nobody watches.

    Raises
    ------
    OptionError
        If it cannot be called.
    """
    if progress is None:
        return silent
    require(callable(progress), "progress must be callable", progress)
    return progress
