"""Blocks of the guides: code behind a comment that names it, and runs of it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import children

PRELUDE = 'set -euo pipefail\ndeltamesh() { "$PYTHON" -m deltamesh_cli "$@"; }\n'


def blocks_of(text: str) -> dict[str, str]:
    """The blocks of a page, by the names that `<!-- run: NAME -->` gives them."""
    return dict(re.findall(r"^<!-- run: (\w+) -->\n```\w+\n(.*?)^```$", text, re.DOTALL | re.M))


def run_shell(block: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run commands in a folder; they have to succeed."""
    command, own = ["bash", "-c", PRELUDE + block], {**os.environ, "PYTHON": sys.executable}
    done = children.run(command, cwd=folder, env=own, text=True)
    assert done.returncode == 0, done.stderr
    return done


def run_python(block: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run Python in a folder; it has to succeed."""
    done = children.run([sys.executable, "-c", block], cwd=folder, text=True)
    assert done.returncode == 0, done.stderr
    return done
