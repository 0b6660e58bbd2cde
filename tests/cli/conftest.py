"""A folder to run commands in."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from commandline import TORUS, cli


@pytest.fixture(autouse=True)
def ctrl_c() -> Iterator[None]:
    """Whoever runs the tests may ignore Ctrl-C, as `&` in a script does; then so do children."""
    previous = signal.getsignal(signal.SIGINT)
    if previous is not signal.SIG_IGN:
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, previous)


@pytest.fixture(scope="session")
def torus_dmesh(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("encoded") / "torus.dmesh"
    assert cli("encode -q", str(TORUS), str(path)) == 0
    return path.read_bytes()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, torus_dmesh: bytes) -> Iterator[Path]:
    """The current folder, with the torus, plain and encoded; no temporary file may stay in it."""
    (tmp_path / "torus.ply").write_bytes(TORUS.read_bytes())
    (tmp_path / "torus.dmesh").write_bytes(torus_dmesh)
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    assert not list(tmp_path.rglob(".deltamesh-*"))
