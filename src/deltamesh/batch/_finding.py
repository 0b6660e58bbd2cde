"""Search for files: names, folders and patterns in, a sorted list of files out."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

from deltamesh_formats.places import absolute, parent, path_below
from deltamesh_formats.remote import files_below, is_folder, is_url, matching, without_query
from deltamesh_formats.wrappers import without_wrapper

_MAGIC = frozenset("*?[")


@dataclass(frozen=True)
class Selection:
    """Rules by which files are taken.

    Attributes
    ----------
    extensions : tuple of str
        Of the files that are taken from a folder, in lower case and without the dot; `.gz` or
        `.zst` may follow it. Files that are named are taken whatever their extension.
    include, exclude : tuple of str
        Patterns of the shell. One with a slash is compared with the whole path as it was given, one
        without with the last part of it. A file has to match one of `include`, if there are any,
        and none of `exclude`; a folder that matches `exclude` is not looked into.
    recursive : bool
        Whether folders within folders are looked into.
    never : str
        A folder that is not looked into, unless it was named: where the output goes.
    """

    extensions: tuple[str, ...]
    include: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    recursive: bool = False
    never: str | None = None


def find(
    names: Iterable[str],
    selection: Selection,
    *,
    patterns: bool = True,
    failed: Callable[[OSError], None] | None = None,
) -> list[str]:
    """Return the files that are meant, each once, sorted by name.

    Parameters
    ----------
    names : iterable of str
        Files, folders, patterns such as `scans/**/*.ply`, and the same as URLs. A file that is not
        there is returned all the same: whoever opens it will say so.
    selection : Selection
    patterns : bool
        Whether `*`, `?` and `[` mean anything in names of files that are not there.
    failed : callable, optional
        Called with the error of each folder that cannot be listed; without it, the error is raised.

    Returns
    -------
    list of str
        A folder stands for the files directly in it or, if `selection` is recursive, at any depth.
        Links to files are files. Links to folders are not followed, unless named: a folder that
        links to itself is walked once.
    """
    found: dict[str, str] = {}
    for name in names:
        for file in _expanded(name, selection, patterns, failed or _raise):
            if _taken(file, selection):
                found.setdefault(absolute(file), file)
    return sorted(found.values())


def _raise(error: OSError) -> None:
    raise error


def _expanded(
    name: str, selection: Selection, patterns: bool, failed: Callable[[OSError], None]
) -> Iterator[str]:
    if is_url(name):
        yield from _expanded_url(name, selection, patterns, failed)
    elif os.path.isdir(name):
        yield from _walk(name, selection, failed)
    elif patterns and _MAGIC & set(name) and not os.path.lexists(name):
        matches = [path for path in _glob(name) if not os.path.isdir(path)]
        yield from matches or [name]
    else:
        yield name


def _expanded_url(
    name: str, selection: Selection, patterns: bool, failed: Callable[[OSError], None]
) -> Iterator[str]:
    """Yield the files that a URL stands for; a question mark begins its query."""
    try:
        if patterns and _MAGIC & set(without_query(name)):
            yield from matching(name) or [name]
        elif _extension(name) in selection.extensions or not is_folder(name):
            yield name
        else:
            yield from _walk_url(name, selection)
    except OSError as error:
        failed(error)


def _walk_url(folder: str, selection: Selection) -> Iterator[str]:
    """Yield the files in a folder of a store; what it lists of other places is not taken."""
    top = path_below(folder)
    never = path_below(selection.never) if selection.never and is_url(selection.never) else None
    for file in files_below(folder, recursive=selection.recursive):
        if _extension(file) not in selection.extensions:
            continue
        above = parent(file)
        while is_url(above) and path_below(above) not in (top, never):
            if _matches(above, selection.exclude):
                break
            above = parent(above)
        if path_below(above) == top:
            yield file


def _glob(pattern: str) -> Iterator[str]:
    """Yield what matches; unlike glob.glob, `**` of pathlib follows no links, hence no loops."""
    from pathlib import Path

    path = Path(pattern)
    top = Path(path.anchor)
    yield from map(str, top.glob(str(path.relative_to(path.anchor))))


def _walk(folder: str, selection: Selection, failed: Callable[[OSError], None]) -> Iterator[str]:
    never = selection.never and os.path.realpath(selection.never)
    waiting = [folder]
    while waiting:
        top = waiting.pop()
        try:
            with os.scandir(top) as scan:
                entries = list(scan)
        except OSError as error:
            failed(error)
            continue
        for entry in entries:
            path = entry.name if top == os.curdir else entry.path
            if entry.is_dir(follow_symlinks=False):
                if not selection.recursive or _matches(path, selection.exclude):
                    continue
                if os.path.realpath(path) != never:
                    waiting.append(path)
            elif _extension(path) in selection.extensions and _is_file(entry):
                yield path


def _is_file(entry: os.DirEntry[str]) -> bool:
    """Return whether it is a file, or a link to nowhere, which somebody should hear of."""
    return entry.is_file() or (entry.is_symlink() and not os.path.exists(entry.path))


def _extension(path: str) -> str:
    return os.path.splitext(without_wrapper(path)[0])[1].lower().removeprefix(".")


def _taken(path: str, selection: Selection) -> bool:
    included = not selection.include or _matches(path, selection.include)
    return included and not _matches(path, selection.exclude)


def _matches(path: str, patterns: tuple[str, ...]) -> bool:
    whole, name = path.replace(os.sep, "/"), os.path.basename(path)
    return any(fnmatchcase(whole if "/" in pattern else name, pattern) for pattern in patterns)
