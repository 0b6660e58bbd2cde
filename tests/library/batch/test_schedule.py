"""Who starts when, and what goes together."""

from __future__ import annotations

import math
import sys
from itertools import chain, pairwise

import children
import pytest
from hypothesis import given
from hypothesis import strategies as st
from works import task

from deltamesh._limits import memory_for_counts, memory_needed
from deltamesh._machine import available_cores, physical_memory
from deltamesh.batch import Task, run_in_processes
from deltamesh.batch._schedule import (
    groups,
    memory_for_mesh_file,
    share,
    startable,
)
from deltamesh_formats.container.container import Container
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import from_triangles

GB = 1 << 30


def test_as_many_as_there_are_jobs() -> None:
    assert startable([1, 1, 1], [], 2, math.inf) == 2
    assert startable([1, 1, 1], [1], 2, math.inf) == 1
    assert startable([1, 1, 1], [1, 1], 2, math.inf) == 0
    assert startable([], [1], 2, math.inf) == 0


def test_large_ones_do_not_run_beside_each_other() -> None:
    assert startable([3 * GB, 3 * GB], [], 4, 5 * GB) == 1
    assert startable([3 * GB], [2 * GB], 4, 5 * GB) == 1
    assert startable([3 * GB], [2 * GB + 1], 4, 5 * GB) == 0


def test_nobody_overtakes() -> None:
    assert startable([5 * GB, 1, 1], [1 * GB], 4, 5 * GB) == 0


def test_what_needs_more_than_there_is_runs_alone() -> None:
    assert startable([9 * GB, 1], [], 4, 5 * GB) == 1
    assert startable([9 * GB, 1], [1], 4, 5 * GB) == 0
    assert startable([1], [9 * GB], 4, 5 * GB) == 0
    assert startable([math.inf, 1], [], 4, math.inf) == 1
    assert startable([math.inf], [1], 4, math.inf) == 0
    assert startable([1], [math.inf], 4, math.inf) == 0


@given(
    needs=st.lists(st.tuples(st.integers(0, 12), st.integers(1, 5)), max_size=30),
    jobs=st.integers(1, 5),
    memory=st.integers(1, 10),
)
def test_a_whole_run(needs: list[tuple[int, int]], jobs: int, memory: int) -> None:
    """Simulate: everything runs, in order, within the limits unless alone; no core is idle."""
    waiting, running, started = list(needs), [], []
    while waiting or running:
        count = startable([n for n, _ in waiting], [n for n, _ in running], jobs, memory)
        assert count or running
        running += waiting[:count]
        started += waiting[:count]
        waiting = waiting[count:]
        total = sum(n for n, _ in running)
        assert len(running) <= jobs
        assert total <= memory or len(running) == 1
        if waiting and len(running) < jobs:
            assert total + waiting[0][0] > memory
        running = [(n, left - 1) for n, left in running if left > 1]
    assert started == needs


def test_estimates_are_those_of_the_limits() -> None:
    from deltamesh_formats.container.container import Parameters

    parameters = Parameters("highpass", True, None, 8, 0.5, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)
    container = Container(1, 1000, 2000, parameters, None, {}, b"")
    assert memory_for_counts(1000, 2000) == memory_needed(container)


def test_a_file_is_not_taken_for_smaller_than_it_is() -> None:
    from meshes import icosphere

    from deltamesh_formats.meshfiles.files import mesh_bytes
    from deltamesh_formats.meshfiles.formats import FORMATS

    V, F = icosphere(4)
    for file_format in FORMATS:
        size = len(mesh_bytes(from_triangles(V.round(3), F), file_format))
        estimate = memory_for_mesh_file(size, file_format)
        assert memory_for_counts(len(V), len(F)) <= estimate * 1.02, file_format
        assert estimate <= memory_for_mesh_file(size, "unknown")


def test_groups() -> None:
    tasks = [task(str(i), size=size) for i, size in enumerate([1, 1, 1, 9, 1, 20, 1])]
    sizes = [[t.size for t in group] for group in groups(tasks, size=10, count=2)]
    assert sizes == [[1, 1], [1, 9], [1], [20], [1]]
    assert list(groups([], 10, 2)) == []


@given(st.lists(st.integers(0, 20), max_size=40), st.integers(1, 30), st.integers(1, 5))
def test_groups_are_all_tasks_in_order(sizes: list[int], size: int, count: int) -> None:
    tasks = [task(str(i), size=n) for i, n in enumerate(sizes)]
    made = list(groups(tasks, size, count))
    assert [t for group in made for t in group] == tasks
    for group in made:
        assert len(group) == 1 or (len(group) <= count and sum(t.size for t in group) <= size)
    for one, other in pairwise(made):
        assert len(one) == count or sum(t.size for t in one) + other[0].size > size


@given(st.integers(0, 50), st.integers(1, 12))
def test_shares_are_all_and_equal(count: int, world: int) -> None:
    items = list(range(count))
    shares = [share(items, rank, world) for rank in range(world)]
    assert sorted(chain.from_iterable(shares)) == items
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


def test_a_rank_beyond_the_world_is_refused() -> None:
    for rank in (-1, 4):
        with pytest.raises(OptionError, match=r"rank must lie in 0\.\.3"):
            share([1, 2], rank, 4)


def test_the_machine() -> None:
    assert available_cores() >= 1
    memory = physical_memory()
    assert memory is None or memory > 1 << 26


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a setting of glibc")
def test_freed_memory_is_returned_where_that_is_asked() -> None:
    """The last of 20 arrays is kept: a heap would keep the others, once it has seen such ones."""
    code = """
import sys
import numpy as np
from deltamesh._machine import RETURNED, return_freed_memory
return_freed_memory()
def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096
for _ in range(2):
    arrays = [np.ones(RETURNED + 1, dtype=np.uint8) for _ in range(20)]
    before, last = resident(), arrays[-1]
    del arrays
sys.exit(resident() > before - 18 * RETURNED)
"""
    assert children.run([sys.executable, "-c", code]).returncode == 0


def test_other_numbers_are_refused_by_their_names() -> None:
    """Without jobs, tasks would wait for ever."""
    for rank, world in (("a", 4), (0.5, 4), (True, 4)):
        with pytest.raises(OptionError, match="rank"):
            share([1, 2], rank, world)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="world_size must be a whole number from 1 on, not 0"):
        share([1, 2], 0, 0)
    waiting = [Task("a", "b", 1)]
    for wrong in ({"jobs": 0}, {"jobs": "a"}, {"memory": "a"}, {"timeout": float("nan")}):
        with pytest.raises(OptionError, match=next(iter(wrong))):
            next(run_in_processes(waiting, print, **{"jobs": 1, **wrong}))  # type: ignore[arg-type]
