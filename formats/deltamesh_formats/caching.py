"""Properties that are computed once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Self, TypeVar, overload

_T = TypeVar("_T")


class cached_property(Generic[_T]):  # noqa: N801
    """Property that an instance computes when it is first read, and keeps.

    That of `functools` takes a lock in Python 3.11, one for all instances: threads wait for each
    other, and a process that is forked meanwhile waits for ever. Here, threads that read at once
    all compute, and all get the same value.

    Parameters
    ----------
    function : callable
        Method of a class whose instances have a `__dict__`.
    """

    def __init__(self, function: Callable[[Any], _T]) -> None:
        self.function = function
        self.__doc__ = function.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> Self: ...
    @overload
    def __get__(self, instance: object, owner: type) -> _T: ...
    def __get__(self, instance: object | None, owner: type) -> Self | _T:
        if instance is None:
            return self
        found: _T = vars(instance).setdefault(self.name, self.function(instance))
        return found
