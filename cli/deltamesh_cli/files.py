"""Files in and out, as zstd does it.

Never overwrite without `-f`, never write onto the input, write to a temporary file in the same
folder and rename it, so that a file with the final name is always a whole one. "-" is a pipe.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import BinaryIO, Final

import click

from deltamesh_cli.failures import Failure, attempt
from deltamesh_cli.output import shown
from deltamesh_cli.signals import stopping_cleanly

STDIO: Final = "-"
SUFFIX: Final = ".dmesh"


def extension(name: str) -> str:
    """Return the extension of a file name in lower case, without the dot; "" for none."""
    return os.path.splitext(name)[1].lower().removeprefix(".")


def chosen_output(positional: str | None, option: str | None) -> str | None:
    """Return the output that was asked for, as second argument or by `-o`."""
    if positional is not None and option is not None:
        raise click.UsageError("The output is given twice: as OUT and with -o.")
    return positional if option is None else option


def check_usage(target: str | None, as_json: bool) -> None:
    """Refuse a command line that wants two things on standard output."""
    if as_json and target == STDIO:
        raise click.UsageError("--json and OUT cannot both have standard output.")


def check_input(name: str) -> None:
    """Refuse an input that cannot be read, before anything else is looked at.

    Raises
    ------
    Failure
        It is missing, a folder, or a terminal.
    """
    with attempt(name, "cannot read"):
        if name != STDIO:
            if stat.S_ISDIR(os.stat(name).st_mode):
                raise IsADirectoryError(errno.EISDIR, "it is a folder, not a file")
        elif sys.stdin is None or sys.stdin.isatty():
            raise OSError(errno.ENOTTY, "it is a terminal, not a file or a pipe")


def read_input(name: str) -> bytes:
    """Return all bytes of a file, or of standard input.

    Raises
    ------
    Failure
        It cannot be read.
    """
    check_input(name)
    with attempt(name, "cannot read"):
        if name == STDIO:
            return sys.stdin.buffer.read()
        with open(name, "rb") as stream:
            return stream.read()


def check_output(source: str, target: str, *, force: bool, text: bool = False) -> None:
    """Refuse an output that could not be written, before the work is done.

    Parameters
    ----------
    source, target : str
        Names of the input and of the output.
    force : bool
        Whether an existing file may go, and bytes may come out on a terminal.
    text : bool
        Whether the output is text, which a terminal can show.

    Raises
    ------
    Failure
        The output exists, is the input, is a folder or in a folder that does not exist, or is a
        terminal.
    """
    if target == STDIO:
        if sys.stdout is None:
            raise _refusal("standard output", errno.EBADF, "it is closed", "-o FILE")
        if sys.stdout.isatty() and not (force or text):
            hint = "-o FILE writes a file, -f writes here all the same"
            raise _refusal("standard output", errno.ENOTTY, "it is a terminal", hint)
        return
    with attempt(target, "cannot write"):
        folder = os.path.dirname(os.path.realpath(target))
        if not os.path.isdir(folder):
            hint = f"create {shown(folder)} first"
            raise _refusal(target, errno.ENOENT, "its folder does not exist", hint)
        if os.path.isdir(target):
            raise _refusal(target, errno.EISDIR, "it is a folder", "name a file in it")
        if source != STDIO and os.path.exists(target) and os.path.samefile(source, target):
            raise _refusal(target, errno.EINVAL, "it is the input itself", "name another output")
        if _holds_data(target) and not force:
            raise _refusal(target, errno.EEXIST, "it exists already", "-f overwrites it")
        if _replaceable(target) and not os.access(folder, os.W_OK):
            raise _refusal(target, errno.EACCES, "its folder may not be written", "use another")


def _refusal(target: str, number: int, why: str, hint: str) -> Failure:
    return Failure(target, "cannot write", OSError(number, why), hint)


def _holds_data(path: str) -> bool:
    """Tell whether writing to `path` would destroy something; /dev/null and pipes hold nothing."""
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return False
    return not (stat.S_ISCHR(mode) or stat.S_ISFIFO(mode))


@contextmanager
def open_output(target: str) -> Iterator[BinaryIO]:
    """Open the output for writing; on an error or an interrupt no file is left.

    Raises
    ------
    Failure
        It cannot be written.
    """
    if target == STDIO:
        with attempt("standard output", "cannot write"):
            yield sys.stdout.buffer
            sys.stdout.buffer.flush()
        return
    with attempt(target, "cannot write"):
        path = os.path.realpath(target)  # a symbolic link stays one; what it names is written
        opened = _replacing(path) if _replaceable(path) else _in_place(path)
        with opened as stream:
            yield stream


def _replaceable(path: str) -> bool:
    """Tell whether a rename may put a file at `path`; /dev/null or a named pipe must stay."""
    try:
        return stat.S_ISREG(os.stat(path).st_mode)
    except FileNotFoundError:
        return True


@contextmanager
def _in_place(path: str) -> Iterator[BinaryIO]:
    with open(path, "wb") as stream:
        yield stream


@contextmanager
def _replacing(path: str) -> Iterator[BinaryIO]:
    """Open a temporary file that becomes `path` at the end, with the permissions `path` had.

    A new file has the permissions that the umask leaves. Its bytes are on the disk before it has
    its name: not even a power failure leaves half a file.
    """
    folder, start = _temporary(path)
    temporary = os.path.join(folder, f"{start}{secrets.token_hex(4)}.tmp")
    with stopping_cleanly():
        try:
            with open(temporary, "xb") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            with suppress(FileNotFoundError):
                shutil.copymode(path, temporary)
            os.replace(temporary, path)
        except BaseException:
            with suppress(FileNotFoundError):
                os.unlink(temporary)
            raise


def _temporary(path: str) -> tuple[str, str]:
    """Return the folder of temporary files that become `path`, and how their names begin.

    The name is short, because a long one might exceed what the file system takes, and tells what
    the file was to become, so that one that was left behind can be found.
    """
    import hashlib

    folder, name = os.path.split(path)
    digest = hashlib.sha256(os.fsencode(name)).hexdigest()
    return folder, f".deltamesh-{digest[:12]}-"


def remove_temporaries(targets: Iterable[str]) -> None:
    """Remove what killed processes have left of these outputs, which nobody may be writing now."""
    starts: dict[str, set[str]] = {}
    for target in targets:
        folder, start = _temporary(os.path.realpath(target))
        starts.setdefault(folder, set()).add(start)
    for folder, own in starts.items():
        with suppress(OSError), os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.rpartition("-")[0] + "-" in own:
                    with suppress(FileNotFoundError):
                        os.unlink(entry.path)
