"""Names of the temporary files that become outputs, and removal of those that were left behind.

A name tells the machine and the process that writes the file. A process that is killed cannot
remove its file; the next one that writes to the folder does. Only regular files with such a name
are ever removed: ".deltamesh-", digests, the process, random digits, ".tmp".
"""

from __future__ import annotations

import os
import re
import stat
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Final

from deltamesh_formats.remote import is_url

_NAME: Final = re.compile(
    r"\.deltamesh-(?P<target>[0-9a-f]{12})-(?P<machine>[0-9a-f]{8})"
    r"-(?P<process>[1-9][0-9]*)-[0-9a-f]{16}\.tmp"
)

# Nobody here can ask for a process of another machine, nor of this one before it was started
# again. A file is written within minutes: after a day it is not being written any more.
_SECONDS: Final = 24 * 3600

# Folders that this process has looked through; once is enough.
_seen: set[str] = set()


def temporary_of(path: str) -> str:
    """Return the path of a new temporary file, for this process and thread alone.

    It is in the folder of `path`, since a rename does not cross file systems. Its name is short,
    whatever the length of the other one, because file systems take 255 bytes and some less.
    """
    folder, name = os.path.split(path)
    made = f".deltamesh-{_target(name)}-{_machine()}-{os.getpid()}-{os.urandom(8).hex()}.tmp"
    return os.path.join(folder, made)


def remove_left_behind(folder: str) -> None:
    """Remove the temporary files in a folder that were left by processes which are gone.

    Each process does so once in each folder. Errors do not matter here.
    """
    if folder not in _seen:
        _seen.add(folder)
        _remove(folder)


def remove_temporaries(targets: Iterable[str]) -> None:
    """Remove what was left of these outputs; nobody on another machine may be writing them now.

    URLs have none here: `deltamesh_formats.remote` writes them.
    """
    found: dict[str, set[str]] = {}
    for target in targets:
        if is_url(target):
            continue
        folder, name = os.path.split(os.path.realpath(target))
        found.setdefault(folder, set()).add(_target(name))
    for folder, digests in found.items():
        _remove(folder, digests)


def _remove(folder: str, targets: set[str] | None = None) -> None:
    """Remove what was left in a folder: of some targets, or of all of which that is certain."""
    machine, now = _machine(), time.time()
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            name = _NAME.fullmatch(entry.name)
            if name is None or not (targets is None or name["target"] in targets):
                continue
            with suppress(OSError):
                status = entry.stat(follow_symlinks=False)
                if name["machine"] == machine:
                    left = not _runs(int(name["process"]))
                else:
                    left = targets is not None or now - status.st_mtime > _SECONDS
                if left and stat.S_ISREG(status.st_mode):
                    os.unlink(entry.path)


def _target(name: str) -> str:
    return _digest(os.fsencode(name), 12)


def _machine() -> str:
    """Return digits for what the number of a process refers to.

    That is the machine and, on Linux, the time since it was started and the name space of
    processes: containers may share a folder and a host name, but number processes on their own.
    """
    words = [_host()]
    with suppress(OSError), open("/proc/sys/kernel/random/boot_id") as file:
        words.append(file.read())
    with suppress(OSError):
        words.append(os.readlink("/proc/self/ns/pid"))
    return _digest("\n".join(words).encode("utf-8", "surrogateescape"), 8)


def _host() -> str:
    """Return the name of this machine."""
    if hasattr(os, "uname"):
        return os.uname().nodename
    import socket  # which takes milliseconds

    return socket.gethostname()


def _digest(data: bytes, digits: int) -> str:
    import hashlib

    return hashlib.sha256(data).hexdigest()[:digits]


def _runs(process: int) -> bool:
    """Return whether there is a process of this number.

    Windows refuses to remove a file that is open, so that nobody needs to know; and there
    `os.kill` ends a process.
    """
    if os.name == "nt":
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True
