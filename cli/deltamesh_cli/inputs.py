"""Input files of a command: those that are named, those in folders, and those in lists.

All commands that take more than one file have these options, and mean the same files by them.
"""

from __future__ import annotations

import errno
import functools
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import click

from deltamesh.batch import Selection, find
from deltamesh_cli import files, options
from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.value_types import FILE
from deltamesh_formats.meshfiles.formats import EXTENSIONS


class Kind(NamedTuple):
    """A kind of files: its name in messages, and the extensions by which folders are searched."""

    title: str
    extensions: tuple[str, ...]


MESH: Final = Kind("mesh file", tuple(EXTENSIONS))
DMESH: Final = Kind(f"{files.SUFFIX} file", (files.SUFFIX.removeprefix("."),))
EITHER: Final = Kind("mesh file", MESH.extensions + DMESH.extensions)


@dataclass(frozen=True)
class Input:
    """One file to work on, or a folder or a list that gives none.

    Attributes
    ----------
    path : str
    name : str
        The path below the folder that was searched; of a file that was named, its last part.
    in_folder : bool
        Whether it was found in a folder, or is a folder.
    problem : OSError, Failure or None
        The reason why there is nothing to work on.
    hint : str
        A remedy for the problem.
    """

    path: str
    name: str
    in_folder: bool = False
    problem: OSError | Failure | None = None
    hint: str = ""

    def checked(self) -> str:
        """Return the path.

        Raises
        ------
        Failure
            If it is a list that cannot be read, or a folder that cannot be or has no such file.
        """
        with attempt(self.path, "cannot read", self.hint):
            if self.problem is not None:
                raise self.problem
        return self.path


@dataclass(frozen=True)
class Choice:
    """Options that choose files, as the user gave them.

    Attributes
    ----------
    recursive : bool
        Whether folders within folders are searched.
    lists : tuple of str
        Files with names of files.
    null : bool
        Whether a NUL ends each name in a list, rather than a line end.
    include, exclude : tuple of str
        Patterns, as in `deltamesh.batch.Selection`.
    """

    recursive: bool = False
    lists: tuple[str, ...] = ()
    null: bool = False
    include: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()

    def selection(self, kind: Kind, never: str | None = None) -> Selection:
        """Return the rules by which files of a kind are taken, but not from the folder `never`."""
        return Selection(kind.extensions, self.include, self.exclude, self.recursive, never)

    def listed(self) -> list[str]:
        """Return the file names in all lists.

        Raises
        ------
        Failure
            If a list cannot be read.
        """
        return [name for one in self.lists for name in self._names_in(one)]

    def _names_in(self, name: str) -> list[str]:
        data = files.read_input(name)
        parts = data.split(b"\0" if self.null else b"\n")
        ending = b"" if self.null else b"\r"
        return [os.fsdecode(part) for one in parts if (part := one.removesuffix(ending))]

    def require(self, names: Iterable[str]) -> None:
        """Refuse a command line that names nothing."""
        if not (tuple(names) or self.lists):
            raise click.UsageError("No file, folder or --filelist is given.")

    def inputs(self, names: Iterable[str], kind: Kind) -> list[Input]:
        """Return the files that are meant, each once, in the order of their names; see `find`.

        Parameters
        ----------
        names : iterable of str
            Files, folders and patterns from the command line.
        kind : Kind
            Of the files that are taken from folders.
        """
        found: dict[str, Input] = {}
        for one in self._meant(names, kind):
            found.setdefault(os.path.abspath(one.path), one)
        return list(found.values())

    def _meant(self, names: Iterable[str], kind: Kind) -> Iterator[Input]:
        selection = self.selection(kind)
        for name in names:
            yield from _inputs_of(name, selection, kind, patterns=True)
        for one in self.lists:
            try:
                listed = self._names_in(one)
            except Failure as failure:
                yield Input(one, one, problem=failure)
                continue
            for name in listed:
                yield from _inputs_of(name, selection, kind, patterns=False)


def _inputs_of(source: str, selection: Selection, kind: Kind, *, patterns: bool) -> Iterator[Input]:
    problems: list[OSError] = []
    paths = find([source], selection, patterns=patterns, failed=problems.append)
    is_folder = os.path.isdir(source)
    for path in paths:
        below = os.path.relpath(path, source) if is_folder else os.path.basename(path)
        yield Input(path, below.replace(os.sep, "/"), is_folder)
    for problem in problems:
        yield Input(problem.filename, problem.filename, is_folder, problem)
    if is_folder and not (paths or problems):
        missing = FileNotFoundError(errno.ENOENT, f"there is no {kind.title} in this folder")
        hint = "" if selection.recursive else "-r searches its folders"
        yield Input(source, source, is_folder, missing, hint)


_FLAGS: Final = options.combined(
    click.option(
        "-r", "--recursive", is_flag=True, help="Search the folders in a FOLDER, at any depth."
    ),
    click.option(
        "--filelist",
        "lists",
        type=FILE,
        metavar="LIST",
        multiple=True,
        help="Also take the files that LIST names, one per line; - stands for standard input.",
    ),
    click.option(
        "-0",
        "--null",
        is_flag=True,
        help="Expect a NUL after each name in LIST, as find -print0 writes it.",
    ),
    click.option(
        "--include",
        metavar="PATTERN",
        multiple=True,
        help="Take only files that match, such as '*.stl'. A PATTERN with a slash has to match the"
        " whole path.",
    ),
    click.option(
        "--exclude",
        metavar="PATTERN",
        multiple=True,
        help="Leave out files and folders that match.",
    ),
)


def chosen_files(command: options.Command) -> options.Command:
    """Add the options that choose files; the command gets them as one keyword, `choice`."""

    @functools.wraps(command)
    def with_choice(
        recursive: bool,
        lists: tuple[str, ...],
        null: bool,
        include: tuple[str, ...],
        exclude: tuple[str, ...],
        **parameters: Any,
    ) -> object:
        choice = Choice(recursive, lists, null, include, exclude)
        return command(choice=choice, **parameters)

    return _FLAGS(with_choice)


def on_checked(action: Callable[[str], object]) -> Callable[[Input], object]:
    """Return an action on inputs that does `action` with the path of each, if there is one."""
    return lambda one: action(one.checked())
