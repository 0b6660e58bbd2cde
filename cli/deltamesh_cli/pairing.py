"""Pairs of files for `deltamesh compare`: each of one set, and that of its name in a folder."""

from __future__ import annotations

import errno
import os
from collections import defaultdict
from collections.abc import Iterable

from deltamesh_cli import files
from deltamesh_cli.failures import attempt
from deltamesh_cli.inputs import EITHER, Choice, Input
from deltamesh_formats.meshfiles.formats import format_of_extension
from deltamesh_formats.wrappers import without_wrapper


class Folder:
    """Mesh files and `.dmesh` files of a folder, to be found by the names of others.

    Parameters
    ----------
    path : str
    recursive : bool
        Whether folders within it are searched.
    """

    def __init__(self, path: str, *, recursive: bool) -> None:
        self.path = path
        self.paths: set[str] = set()
        self._by_key: defaultdict[tuple[int, str], list[str]] = defaultdict(list)
        for one in Choice(recursive).inputs([path], EITHER):
            if one.problem is None:
                self.paths.add(one.path)
                for key in _keys(one.name):
                    self._by_key[key].append(one.path)

    def counterpart(self, one: Input) -> str:
        """Return the path of the file that has the name of an input.

        The same name counts most, then the same name without the endings of compression and
        ".dmesh", then that without the extension of a mesh file.

        Raises
        ------
        Failure
            If there is none, or there are several.
        """
        with attempt(one.path, "cannot compare"):
            for key in _keys(one.name):
                found = self._by_key.get(key, [])
                if len(found) > 1:
                    listed = " and ".join(os.path.relpath(path, self.path) for path in found[:2])
                    raise OSError(errno.EINVAL, f"{listed} in {self.path} both have its name")
                if found:
                    return found[0]
            raise FileNotFoundError(errno.ENOENT, f"no file in {self.path} has its name")

    def without(self, paired: Iterable[str]) -> list[str]:
        """Return the files of the folder but those that have a counterpart, sorted."""
        return sorted(self.paths.difference(paired))


def _keys(name: str) -> list[tuple[int, str]]:
    """Return a name, what is left of it without endings, and without an extension, numbered."""
    bare = files.without_suffix(name) or without_wrapper(name)[0]
    stem, extension = os.path.splitext(bare)
    known = format_of_extension(extension) is not None
    return list(enumerate((name, bare, stem if known else bare)))
