"""Containers: a command reads each `.dmesh` once, and decodes what it has read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from commandline import cli

import deltamesh
from deltamesh_formats.container import reader


@pytest.fixture
def readings(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The sizes of the files whose sections were read, however `read_container` was imported."""
    sizes: list[int] = []
    original = reader.read_sections

    def counting(view: memoryview, position: int, **options: bool) -> object:
        sizes.append(len(view))
        return original(view, position, **options)

    monkeypatch.setattr(reader, "read_sections", counting)
    return sizes


@pytest.mark.parametrize(
    "line",
    [
        "info torus.dmesh",
        "info torus.dmesh --json",
        "test torus.dmesh",
        "test torus.dmesh --json",
        "decode torus.dmesh back.ply",
        "decode torus.dmesh back.ply --json",
        "compare torus.ply torus.dmesh",
        "compare torus.dmesh torus.ply --json",
        "encode torus.ply made.dmesh",
        "encode torus.ply made.dmesh --json",
        "batch -q torus.ply",
        "batch -q -d torus.dmesh --output-format off",
        "batch -q -d -f torus.dmesh",
    ],
)
def test_a_command_reads_a_container_once(folder: Path, readings: list[int], line: str) -> None:
    jobs = " --jobs 1" if line.startswith("batch") else ""
    assert cli(line + jobs) == 0
    made = next((name for name in ("made.dmesh", "torus.ply.dmesh") if Path(name).exists()), None)
    assert readings == [Path(made or "torus.dmesh").stat().st_size]


def test_two_files_are_two_containers(folder: Path, readings: list[int]) -> None:
    (folder / "copy.dmesh").write_bytes((folder / "torus.dmesh").read_bytes())
    assert cli("compare torus.dmesh torus.dmesh") == 0
    assert cli("test torus.dmesh copy.dmesh ./torus.dmesh") == 0
    assert len(readings) == 4


@pytest.mark.parametrize("function", [deltamesh.load, deltamesh.info, deltamesh.verify])
def test_the_library_reads_a_container_once(
    folder: Path, readings: list[int], function: Callable[..., object]
) -> None:
    function("torus.dmesh")
    assert len(readings) == 1


def test_a_container_is_decoded_without_reading_the_file_again(
    folder: Path, readings: list[int]
) -> None:
    container = deltamesh.info("torus.dmesh")
    expected = deltamesh.load("torus.dmesh")
    del readings[:]
    Path("torus.dmesh").unlink()
    assert deltamesh.verify(container) is container
    mesh = deltamesh.decode(container)
    assert (mesh.vertices == expected.vertices).all()
    assert (mesh.triangles == expected.triangles).all()
    assert readings == []
