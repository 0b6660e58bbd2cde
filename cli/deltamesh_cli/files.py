"""Input and output files of a command, with the rules of zstd.

An existing file is overwritten only with `-f`, and the input never. A file with the final name is
always complete, because `deltamesh_formats.atomic` writes it. "-" stands for a pipe.

Around any of them there may be gzip or zstandard: inputs show it by their first bytes, outputs get
it by their names.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Mapping
from typing import Any, Final

import click

from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.output import display_name, print_json
from deltamesh_cli.signals import stopping_cleanly
from deltamesh_formats.atomic import found_at, write_file
from deltamesh_formats.errors import LimitError
from deltamesh_formats.meshfiles.beside import read_with
from deltamesh_formats.places import exists, read_bytes, status
from deltamesh_formats.remote import is_url
from deltamesh_formats.wrappers import DEFAULT_LIMIT, unwrapped, without_wrapper, wrapped

STDIO: Final = "-"
_STDOUT: Final = "/dev/stdout"
SUFFIX: Final = ".dmesh"


def extension(name: str) -> str:
    """Return the extension of a file name in lower case and without the dot, or "".

    Of a name that ends in ".gz" or ".zst", that is the one before.
    """
    return os.path.splitext(without_wrapper(name)[0])[1].lower().removeprefix(".")


def without_suffix(name: str) -> str | None:
    """Return the name of a `.dmesh` file without that suffix, or None if it does not end so.

    A ".gz" or ".zst" after it is left out, too.
    """
    stem, suffix = os.path.splitext(without_wrapper(name)[0])
    return stem if suffix.lower() == SUFFIX else None


def named_after(source: str, suffix: str) -> str:
    """Return the name of what is made of a file, beside it, or here where that is at a URL."""
    return f"{os.path.basename(source) if is_url(source) else source}{suffix}"


def print_written(
    kind: str, source: str, target: str, size: int, *, as_json: bool, quiet: bool
) -> None:
    """Print what has been made of a file, of some kind, and how many bytes it has."""
    if as_json:
        print_json({"file": source, kind: target, "bytes": size})
    elif not quiet and target != STDIO:
        click.echo(f"{display_name(target)}: {size} bytes")


def chosen_output(positional: str | None, option: str | None) -> str | None:
    """Return the output that the user named, either as second argument or with `-o`."""
    if positional is not None and option is not None:
        raise click.UsageError("The output is given twice: as OUT and with -o.")
    chosen = positional if option is None else option
    return STDIO if chosen == _STDOUT else chosen


def check_name_of_dmesh(target: str) -> None:
    """Refuse an output of another name than one of a `.dmesh` file: it may be somebody's mesh.

    A pipe or a device may have any name, and a folder is refused later.
    """
    is_special = os.path.exists(target) and not os.path.isfile(target)
    if target != STDIO and without_suffix(target) is None and not is_special:
        raise click.UsageError(
            f"{display_name(target)} does not end in {SUFFIX}. deltamesh batch encodes several"
            f" files; --force-name writes a {SUFFIX} file with any name."
        )


def check_stdout_has_one_use(target: str | None, as_json: bool) -> None:
    """Refuse a command line that sends both OUT and JSON to standard output."""
    if as_json and target == STDIO:
        raise click.UsageError("--json and OUT cannot both have standard output.")


def check_input(name: str) -> None:
    """Refuse an input that cannot be read, before any other check.

    Raises
    ------
    Failure
        If it is missing, a folder, or a terminal.
    """
    if is_url(name):
        return  # who reads it will say so
    hint = "deltamesh batch takes folders" if os.path.isdir(name) else ""
    with attempt(name, "cannot read", hint):
        if name != STDIO:
            if stat.S_ISDIR(os.stat(name).st_mode):
                raise IsADirectoryError(errno.EISDIR, "it is a folder, not a file")
        elif sys.stdin is None or sys.stdin.isatty():
            raise OSError(errno.ENOTTY, "it is a terminal, not a file or a pipe")


def read_input(
    name: str, limits: Mapping[str, Any] | None = None, *, partial: bool = False
) -> bytes:
    """Return what is in a file, or comes from standard input, without compression around it.

    Parameters
    ----------
    name : str
    limits : mapping, optional
        The options of a command that has --memory, which also limits what is decompressed.
    partial : bool
        Whether the compression may be cut.

    Raises
    ------
    Failure
        If it cannot be read, its compression is damaged, or it is larger than allowed.
    """
    return unwrapped_input(name, read_raw(name), limits, partial=partial)


def unwrapped_input(
    name: str, data: bytes, limits: Mapping[str, Any] | None = None, *, partial: bool = False
) -> bytes:
    """Return what is in the bytes of a file; parameters and failures are those of `read_input`."""
    memory = None if limits is None else limits.get("memory")
    with attempt(name, "cannot read"):
        try:
            return unwrapped(data, DEFAULT_LIMIT if memory is None else memory, partial=partial)
        except LimitError as error:
            hint = "decompress it first" if limits is None else "--memory raises the limit"
            raise Failure(name, "cannot read", error, hint) from error


def read_raw(name: str) -> bytes:
    """Return all bytes of a file, or of standard input.

    Raises
    ------
    Failure
        If it cannot be read.
    """
    check_input(name)
    with attempt(name, "cannot read"):
        if name == STDIO:
            return sys.stdin.buffer.read()
        return read_bytes(name)


def source_size(name: str, raw: bytes, file_format: str | None) -> int:
    """Return the bytes of a mesh file, and of those that are read with it, as a glTF has buffers.

    Parameters
    ----------
    name : str
    raw : bytes
        All bytes of the file.
    file_format : str or None
        Format of the file; None if its name determines it.
    """
    beside = () if name == STDIO else read_with(name, file_format or "")
    return len(raw) + sum(status(one)[0] for one in beside)


def check_output(source: str, target: str, *, force: bool, text: bool = False) -> None:
    """Refuse an output that cannot be written, before the work begins.

    Parameters
    ----------
    source, target : str
        Names of the input and of the output.
    force : bool
        Whether an existing file may be overwritten, and bytes may be printed on a terminal.
    text : bool
        Whether the output is text, which a terminal can show.

    Raises
    ------
    Failure
        If the output exists, is the input, a folder or a terminal, or its folder does not exist or
        may not be written.
    """
    if target == STDIO:
        if sys.stdout is None:
            raise _refusal("standard output", errno.EBADF, "it is closed", "-o FILE")
        if sys.stdout.isatty() and not (force or text):
            hint = "-o FILE writes a file, -f writes to the terminal anyway"
            raise _refusal("standard output", errno.ENOTTY, "it is a terminal", hint)
        return
    with attempt(target, "cannot write"):
        if is_url(target):
            if target == source:
                raise _refusal(
                    target, errno.EINVAL, "it is the input itself", "name another output"
                )
            if not force and exists(target):
                raise _exists_already(target)
            return
        folder = os.path.dirname(os.path.realpath(target))
        if not os.path.isdir(folder):
            hint = f"create {display_name(folder)} first"
            raise _refusal(target, errno.ENOENT, "its folder does not exist", hint)
        if os.path.isdir(target):
            raise _refusal(target, errno.EISDIR, "it is a folder", "name a file in it")
        is_file = source != STDIO and not is_url(source)
        if is_file and os.path.exists(target) and os.path.samefile(source, target):
            raise _refusal(target, errno.EINVAL, "it is the input itself", "name another output")
        existing = found_at(target)
        if existing in ("file", "other") and not force:
            raise _exists_already(target)
        if existing in ("file", "nothing") and not os.access(folder, os.W_OK):
            raise _refusal(
                target, errno.EACCES, "its folder may not be written", "use another folder"
            )


def _refusal(target: str, number: int, reason: str, hint: str) -> Failure:
    return Failure(target, "cannot write", OSError(number, reason), hint)


def _exists_already(target: str) -> Failure:
    return _refusal(target, errno.EEXIST, "it exists already", "-f overwrites it")


def write_output(target: str, data: bytes, *, force: bool) -> None:
    """Write the output; after an error or an interrupt, no part of it remains.

    Parameters
    ----------
    target : str
        Name of the output; if it ends in ".gz" or ".zst", the file is compressed.
    data : bytes
    force : bool
        Whether an existing file may be overwritten, even one that appeared during the work. A file
        with the same bytes is no obstacle in any case: another process has made the same output,
        such as a worker of a batch that died before it could report.

    Raises
    ------
    Failure
        If it cannot be written.
    """
    if target == STDIO:
        with attempt("standard output", "cannot write"):
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
        return
    data = wrapped(target, data)
    with attempt(target, "cannot write"), stopping_cleanly():
        try:
            write_file(target, data, overwrite=force)
        except FileExistsError:
            if read_raw(target) != data:
                raise _exists_already(target) from None
