"""Loading of rslab, whose threads and allocator belong to one process and one thread of it.

rslab does not survive a fork: its threads stay in the parent and its child waits for them for ever,
with one thread too. The allocator that comes with it belongs to a thread that may not be in the
child either.
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
from typing import Any

# Whether a process that this one was forked from had loaded rslab.
_inherited = False


def _after_fork() -> None:
    global _inherited
    _inherited = "rslab" in sys.modules


if hasattr(os, "register_at_fork"):  # not on Windows, which has no fork
    os.register_at_fork(after_in_child=_after_fork)


def is_inherited() -> bool:
    """Return whether a process that this one was forked from had loaded rslab: it does not work."""
    return _inherited


def load_rslab() -> Any:
    """Import rslab in a thread that lives as long as the process.

    Its allocator (mimalloc, in rslab 1.7) belongs to the thread that loads the library and crashes
    the process in the next thread, once that thread has ended.
    """
    if "rslab" not in sys.modules and threading.current_thread() is not threading.main_thread():
        loaded = threading.Event()

        def load() -> None:
            try:
                importlib.import_module("rslab")
            finally:
                loaded.set()
            threading.Event().wait()

        threading.Thread(target=load, name="rslab-allocator", daemon=True).start()
        loaded.wait()
    return importlib.import_module("rslab")
