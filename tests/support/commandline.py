"""What the tests of the command line share."""

from __future__ import annotations

import os
import sys

import pytest
from places import BENCHMARKS

from deltamesh_cli.program import run

TORUS = BENCHMARKS / "meshes" / "torus.ply"
PROGRAM = [sys.executable, "-m", "deltamesh_cli"]

posix = pytest.mark.skipif(os.name != "posix", reason="POSIX files and signals")


def cli(line: str, *more: str) -> int:
    """Run a command line, split at its spaces, and return the exit code."""
    return run([*line.split(), *more])


def damaged(data: bytes) -> bytes:
    """Flip one bit in the middle."""
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :]
