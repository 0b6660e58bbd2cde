"""Public names of a package that are imported from their modules when they are first used."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from importlib import import_module
from typing import Any


def lazy_names(
    package: str, names: Mapping[str, Collection[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package.

    Type checkers do not see them: the package also imports the names `if TYPE_CHECKING`.

    Parameters
    ----------
    package : str
        Its `__name__`.
    names : mapping of str to collection of str
        Public names by the modules that they are in.
    """
    home = {name: module for module, some in names.items() for name in some}
    public = sorted(home)

    def get(name: str) -> Any:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(home[name]), name)

    return get, public.copy, public
