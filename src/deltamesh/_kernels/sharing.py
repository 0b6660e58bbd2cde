"""Sharing of the work of a kernel by several threads, part by part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, c_int, c_int64, c_void_p
from typing import TYPE_CHECKING, Any, Final

from deltamesh._kernels.core import LIBRARY

if TYPE_CHECKING:
    from concurrent.futures import Future

# What the core calls to have parts done, of a work and so many of them. It returns 0 once all are
# done; else the core gives up.
_SHARER: Final = CFUNCTYPE(c_int, c_void_p, c_int64)


@contextmanager
def shared(part: str, threads: int) -> Iterator[Any]:
    """Yield what the core calls to have parts done by several threads; None for a single one.

    Parameters
    ----------
    part : str
        The function of the core that does a part, given the work and an index.
    threads : int
        All of them, this one included, which does parts as well.

    Raises
    ------
    BaseException
        At the end, what ended a part early, such as an interrupt from the keyboard.
    """
    if threads < 2:
        yield None
        return
    from concurrent.futures import ThreadPoolExecutor  # which a single thread need not wait for

    do = getattr(LIBRARY, part)
    errors: list[BaseException] = []
    with ThreadPoolExecutor(threads - 1) as pool:

        def share(work: int, count: int) -> int:
            left = iter(range(count))

            def go() -> None:
                for index in left:
                    do(c_void_p(work), c_int64(index))

            others = [pool.submit(go) for _ in range(min(threads, count) - 1)]
            try:
                go()
            except BaseException as error:
                errors.append(error)
            errors.extend(_ended(others))
            return len(errors)

        yield _SHARER(share)
    if errors:
        raise errors[0]


def _ended(futures: Iterable[Future[None]]) -> Iterator[BaseException]:
    """Wait for futures whatever interrupts it: they use the memory of this thread's work."""
    from concurrent.futures import wait

    for future in futures:
        while not future.done():
            try:
                wait([future])
            except BaseException as error:
                yield error
        if (failed := future.exception()) is not None:
            yield failed
