"""Progress of encoder and decoder, reported as the names of their stages."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

# Called with the name of each stage as it begins.
Progress: TypeAlias = Callable[[str], None]


def silent(stage: str) -> None:
    """Do nothing: the progress that nobody watches."""
