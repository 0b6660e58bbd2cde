"""Sharing of the work of a kernel: every part is done once, and what ends one early comes out."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace

import pytest

from deltamesh._kernels import sharing
from deltamesh._kernels.sharing import shared


@pytest.fixture
def parts(monkeypatch):
    """Return a function that makes the core's function for a part one of Python."""

    def use(function):
        core = SimpleNamespace(part=lambda work, index: function(index.value))
        monkeypatch.setattr(sharing, "LIBRARY", core)

    return use


@pytest.mark.parametrize("threads", [2, 3, 8])
@pytest.mark.parametrize("count", [0, 1, 5, 100])
def test_every_part_is_done_once(parts, threads: int, count: int) -> None:
    done = []
    parts(done.append)
    with shared("part", threads) as each:
        assert each(1, count) == 0
        assert sorted(done) == list(range(count))
        assert each(1, count) == 0
    assert sorted(done) == sorted(2 * list(range(count)))


def test_several_threads_do_parts(parts) -> None:
    both = threading.Barrier(2)
    parts(lambda index: both.wait(timeout=30))
    with shared("part", 2) as each:
        assert each(1, 2) == 0


def test_a_single_thread_is_not_asked(parts) -> None:
    with shared("part", 1) as each:
        assert each is None


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
@pytest.mark.parametrize("at", [0, 3])
def test_what_ends_a_part_comes_out_once_all_have_ended(parts, error, at: int) -> None:
    running, status = [], []

    def part(index):
        running.append(index)
        try:
            if index == at:
                raise error
            time.sleep(0.01)
        finally:
            running.remove(index)

    def share():
        with shared("part", 3) as each:
            status.append(each(1, 9))
            assert running == []

    parts(part)
    with pytest.raises(error):
        share()
    assert status[0] != 0
