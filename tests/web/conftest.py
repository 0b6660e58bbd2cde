"""What the tests of `src/web` share: Node, and the package that runs in it."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
from pathlib import Path

import children
import pytest
from places import ROOT


@pytest.fixture(scope="session")
def node() -> str:
    """The command of Node."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("no node")
    return found


def build(*arguments: object) -> None:
    """Run the script that builds the core."""
    if not importlib.util.find_spec("ziglang"):
        pytest.skip("no ziglang")
    command = [sys.executable, str(ROOT / "src/core/build.py"), *map(str, arguments)]
    children.run(command, check=True)


@pytest.fixture(scope="session")
def package(node: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package for the npm registry: that in DELTAMESH_NPM, or a new one."""
    if named := os.environ.get("DELTAMESH_NPM"):
        return Path(named)
    folder = tmp_path_factory.mktemp("npm") / "deltamesh"
    build("--npm", folder)
    return folder
