"""Temporary files as processes leave them that are killed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from deltamesh_formats.temporaries import temporary_of


def dead_process() -> int:
    """The number of a process that is gone."""
    with subprocess.Popen([sys.executable, "-S", "-c", ""]) as process:
        process.wait(timeout=60)
    return process.pid


def left_of(target: str | Path, process: int, machine: str | None = None) -> Path:
    """Make a temporary file of a process of this or another machine, which was to be `target`."""
    path = Path(temporary_of(os.path.realpath(target)))
    _, digest, here, _, digits = path.name.split("-")
    name = f".deltamesh-{digest}-{machine or here}-{process}-{digits}"
    path = path.with_name(name)
    path.write_bytes(b"half")
    return path
