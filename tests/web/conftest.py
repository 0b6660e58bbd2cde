"""What the tests of `src/web` share: Node, and the package that runs in it."""

from __future__ import annotations

import importlib.util
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import browser as browsers
import pytest
from browser import Browser
from places import ROOT
from web_builds import build

from deltamesh._page.filling import PAGE, REPORT


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


@pytest.fixture(scope="session")
def pages() -> None:
    """The pages: those of the installation or, in a checkout, of the sources as they are."""
    are_there = PAGE.exists() and REPORT.exists()
    if PAGE.is_relative_to(ROOT) and (importlib.util.find_spec("ziglang") or not are_there):
        build("--page")
    elif not are_there:
        pytest.skip("an installation without the page")


@pytest.fixture(scope="session")
def browser(pages: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A browser that draws."""
    if browsers.chromium() is None:
        pytest.skip("no chromium with chromedriver")
    with browsers.started(tmp_path_factory.mktemp("profile") / "p", *browsers.DRAWING) as one:
        yield one
