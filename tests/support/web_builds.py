"""Builds of what runs in browsers, for tests that need one."""

from __future__ import annotations

import importlib.util
import sys

import children
import pytest
from places import ROOT


def build(*arguments: object) -> None:
    """Run the script that builds the core; skip where it lacks a compiler."""
    if not importlib.util.find_spec("ziglang"):
        pytest.skip("no ziglang")
    command = [sys.executable, str(ROOT / "src/core/build.py"), *map(str, arguments)]
    children.run(command, check=True)
