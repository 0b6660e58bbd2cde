"""Scheduling of tasks, pure functions of sizes: starting, grouping, sharing, memory."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

from deltamesh._limits import memory_for_counts
from deltamesh.batch._plan import Task
from deltamesh_formats.arguments import require_whole
from deltamesh_formats.meshfiles.formats import FORMATS, format_of_extension

_Item = TypeVar("_Item")


def memory_for_mesh_file(size: int, file_format: str) -> int:
    """Estimate the memory that encoding a mesh file takes, in bytes.

    The estimate is too high rather than too low: normals, colours and long decimal numbers make a
    file larger than its mesh.

    Parameters
    ----------
    size : int
        Of the file, in bytes.
    file_format : str
        Name or extension of its format; for an unknown one the most memory is assumed.
    """
    known = format_of_extension(file_format)
    formats = FORMATS.values() if known is None else [known]
    vertices = size // min(one.bytes_per_vertex for one in formats)
    return memory_for_counts(vertices, 2 * vertices)


def startable(waiting: Sequence[float], running: Sequence[float], jobs: int, memory: float) -> int:
    """Return how many of those that wait may start now.

    They start in order and nobody overtakes: a large one is not put off again and again by small
    ones that still fit. One that needs more than all memory, or infinitely much, runs alone.

    Parameters
    ----------
    waiting, running : sequence of float
        Memory that each needs, in bytes.
    jobs : int
        How many may run at once.
    memory : float
        How much all that run may need together, in bytes.
    """
    total, count = sum(running), len(running)
    started = 0
    for need in waiting:
        together = total + need
        fits = together <= memory and together < math.inf
        if count == jobs or (count and not fits):
            break
        total, count, started = together, count + 1, started + 1
    return started


def groups(tasks: Iterable[Task], size: int, count: int) -> Iterator[list[Task]]:
    """Put neighbours into groups of at most `count` files and `size` bytes; a larger one is alone.

    Parameters
    ----------
    tasks : iterable of Task
    size : int
        In bytes of input.
    count : int
    """
    group: list[Task] = []
    for task in tasks:
        if group and (len(group) == count or sum(t.size for t in group) + task.size > size):
            yield group
            group = []
        group.append(task)
    if group:
        yield group


def share(items: Sequence[_Item], rank: int, world_size: int) -> list[_Item]:
    """Return every `world_size`-th item from number `rank` on: what one of many machines does.

    Raises
    ------
    OptionError
        If `rank` is not one of 0 to `world_size` - 1.
    """
    require_whole("world_size", world_size, 1)
    require_whole("rank", rank, 0, world_size - 1)
    return list(items[rank::world_size])
