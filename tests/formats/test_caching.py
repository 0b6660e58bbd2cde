"""Properties that are computed once, by threads as well, and in forked processes."""

from __future__ import annotations

import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import pytest

from deltamesh_formats.caching import cached_property

SECONDS = 30


@dataclass(frozen=True)
class Square:
    side: list[int]

    @cached_property
    def area(self) -> list[int]:
        """Area of the square."""
        return [self.side[0] ** 2]


def test_a_value_is_computed_once_for_each_instance() -> None:
    one, other = Square([2]), Square([3])
    area = one.area
    one.side[0] = 5
    assert one.area is area
    assert (area, other.area) == ([4], [9])


def test_the_class_has_the_property_itself() -> None:
    assert isinstance(Square.area, cached_property)
    assert Square.area.__doc__ == "Area of the square."


def test_what_fails_is_computed_again() -> None:
    square = Square([])
    with pytest.raises(IndexError):
        _ = square.area
    square.side.append(2)
    assert square.area == [4]


class Meeting:
    """Instances whose values are computed at the same time, or never."""

    together = threading.Barrier(2)

    @cached_property
    def value(self) -> object:
        self.together.wait(SECONDS)
        return object()


def test_instances_do_not_wait_for_each_other() -> None:
    with ThreadPoolExecutor(2) as pool:
        one, other = pool.map(lambda meeting: meeting.value, [Meeting(), Meeting()])
    assert one is not other


def test_threads_get_the_same_value() -> None:
    meeting = Meeting()
    with ThreadPoolExecutor(2) as pool:
        one, other = pool.map(lambda _: meeting.value, range(2))
    assert one is other is meeting.value


class Held:
    """Instances one of which is being computed until it is released."""

    begun, released = threading.Event(), threading.Event()

    def __init__(self, waits: bool) -> None:
        self.waits = waits

    @cached_property
    def value(self) -> int:
        if self.waits:
            self.begun.set()
            self.released.wait(SECONDS)
        return 7


@pytest.mark.skipif(not hasattr(os, "fork"), reason="POSIX only")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_child_that_is_forked_while_a_thread_computes_does_not_hang() -> None:
    thread = threading.Thread(target=lambda: Held(waits=True).value)
    thread.start()
    assert Held.begun.wait(SECONDS)
    child = os.fork()
    if child == 0:
        signal.alarm(SECONDS)
        os._exit(Held(waits=False).value)
    _, status = os.waitpid(child, 0)
    Held.released.set()
    thread.join()
    assert os.waitstatus_to_exitcode(status) == 7
