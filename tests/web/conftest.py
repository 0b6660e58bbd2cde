"""What the tests of `src/web` share: Node, and the package that runs in it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest
from web_builds import build


@pytest.fixture(scope="session")
def node() -> str:
    """The command of Node."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("no node")
    return found


@pytest.fixture(scope="session")
def package(node: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package for the npm registry: that in DELTAMESH_NPM, or a new one."""
    if named := os.environ.get("DELTAMESH_NPM"):
        return Path(named)
    folder = tmp_path_factory.mktemp("npm") / "deltamesh"
    build("--npm", folder)
    return folder
