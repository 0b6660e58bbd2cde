"""Processor cores and memory that this process may use."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Final

# Blocks of so many bytes are returned to the system as soon as they are freed. Below, the first use
# of each page costs more than it saves.
RETURNED: Final = 8 << 20
_M_MMAP_THRESHOLD: Final = -3  # of glibc's malloc.h


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


def return_freed_memory() -> None:
    """Let this process return the memory of large arrays to the system once they are freed.

    By itself, the allocator of glibc keeps up to 32 MB a block, in pieces that later arrays do not
    fit into: of a mesh of half a million vertices, 4 % of the peaks of encoder and decoder. The
    setting is that of a whole process, so it is for programs, not for a library, to make.
    """
    if not sys.platform.startswith("linux"):
        return
    import ctypes

    setting = getattr(ctypes.CDLL(None), "mallopt", None)  # other libraries have none
    if setting is not None:
        setting(_M_MMAP_THRESHOLD, RETURNED)
