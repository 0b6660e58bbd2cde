"""Processor cores and memory that this process may use."""

from __future__ import annotations

import os
from contextlib import suppress


def physical_memory() -> int | None:
    """Return the memory of this machine or container in bytes; None if unknown."""
    known = []
    with suppress(AttributeError, ValueError, OSError):
        known.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    # Not there, or not a number, outside containers and in those without a limit.
    with suppress(OSError, ValueError), open("/sys/fs/cgroup/memory.max") as file:
        known.append(int(file.read()))
    return min(known, default=None)


def available_cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
