"""Compilation of kernels, and the cache of their machine code.

numba's own cache notices an edit of a kernel, but not of a kernel that it calls in another file
(numba manual, "Notes on Caching"). A codec that runs a stale kernel writes wrong bytes, so the
cache lives in a folder named by a digest of all the kernels' sources: any edit means a new folder.
The folder is `__pycache__` beside the sources or, where an installation is read-only, the user's
cache folder. `NUMBA_CACHE_DIR` overrides both, as numba documents.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numba
from numba.core import config

# An integer in a kernel. mypy knows no type that is int and np.int64 both, as all are to numba.
# A constant argument is written np.int64(C): numba compiles a function anew for each literal one.
Int: TypeAlias = Any
Flag: TypeAlias = Any  # a bool for the same reason

_Function = TypeVar("_Function", bound=Callable[..., object])

_SOURCES = Path(__file__).parent


def _digest() -> str:
    """Return a short digest of every kernel source, in sorted order."""
    digest = hashlib.blake2b(digest_size=8)
    for path in sorted(_SOURCES.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _user_cache() -> Path:
    """Return the per-user cache folder, by the conventions of XDG and of Windows."""
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(base) if base else Path.home() / ".cache") / "deltamesh"


def _writable(folder: Path) -> bool:
    """Tell by trying: permission bits lie for root and on read-only mounts."""
    probe = folder / f".probe-{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError:
        return False
    return True


def cache_folder() -> Path | None:
    """Return the folder that holds the compiled kernels, or None when none can be written."""
    name = f"kernels-{_digest()}"
    candidates = (_SOURCES / "__pycache__" / name, _user_cache() / name)
    return next((folder for folder in candidates if _writable(folder)), None)


CACHE_FOLDER = cache_folder()


def _compile(function: _Function, inline: bool) -> _Function:
    previous: str = vars(config)["CACHE_DIR"]
    if not previous and CACHE_FOLDER is not None:
        vars(config)["CACHE_DIR"] = str(CACHE_FOLDER)
    try:
        compiled: Any = numba.njit(
            cache=bool(previous) or CACHE_FOLDER is not None,
            nogil=True,
            error_model="numpy",  # a division cannot raise: kernels need no exception paths
            forceinline=inline,
        )(function)
    finally:
        vars(config)["CACHE_DIR"] = previous
    return compiled  # type: ignore[no-any-return]


def kernel(function: _Function) -> _Function:
    """Compile a function of flat arrays at its first call; keep the machine code for later runs."""
    return _compile(function, inline=False)


def inlined(function: _Function) -> _Function:
    """Compile a function into those that call it.

    A tuple of arrays is passed by value, seven words an array: small functions that take one, and
    larger ones that are called in one place, cost more to call than to run.
    """
    return _compile(function, inline=True)
