"""Meshes in and out of files for the commands, with failures that name the file."""

from __future__ import annotations

from pathlib import Path

import meshes
import pytest

from deltamesh_cli.failures import FAILED, REFUSED, Failure
from deltamesh_cli.meshes import (
    load_mesh,
    note_not_kept,
    parse_container,
    parse_mesh,
    write_mesh_file,
)
from deltamesh_cli.summary import container_object, described_container, errors_object
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import from_triangles

MESH = from_triangles(*meshes.tetrahedron())


def silent(stage: str) -> None:
    """Tell nobody."""


def failure_of(name: str, data: bytes, file_format: str | None = None) -> Failure:
    with pytest.raises(Failure) as caught:
        parse_mesh(name, data, file_format, silent)
    return caught.value


def test_the_name_tells_the_format_unless_an_option_does() -> None:
    data = mesh_bytes(MESH, "off")
    assert len(parse_mesh("a.off", data, None, silent).vertices) == 4
    assert len(parse_mesh("a.ply", data, "off", silent).vertices) == 4


@pytest.mark.parametrize(
    ("name", "data", "hint"),
    [
        ("a.dmesh", b"\x89DMS\r\n\x1a\n", "deltamesh decode turns it into a mesh file"),
        ("a.obj", mesh_bytes(MESH, "ply"), "it begins like PLY: --input-format ply"),
        ("a", b"v 0 0 0", "--input-format names the format"),
    ],
)
def test_a_failure_tells_what_to_try(name: str, data: bytes, hint: str) -> None:
    found = failure_of(name, data)
    assert found.hint == hint
    assert found.code == FAILED
    assert str(found).startswith(f"{name}: cannot read: ")


def test_a_file_that_is_damaged_has_its_own_exit_code(torus_dmesh: bytes) -> None:
    assert parse_container("x", torus_dmesh, "cannot decode").vertices > 0
    with pytest.raises(Failure, match=r"^x: cannot decode: ") as caught:
        parse_container("x", torus_dmesh[:-1], "cannot decode")
    assert caught.value.code == REFUSED


def test_meshes_are_told_from_files_by_their_first_bytes(folder: Path) -> None:
    (folder / "wrong.ply").write_bytes((folder / "torus.dmesh").read_bytes())
    encoded, plain = (load_mesh(name, None, silent) for name in ("wrong.ply", "torus.ply"))
    assert encoded.container is not None
    assert plain.container is None
    assert len(encoded.mesh.vertices) == len(plain.mesh.vertices)
    assert plain.size == (folder / "torus.ply").stat().st_size


def test_mesh_files_are_written_and_losses_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lost = write_mesh_file("new.stl", MESH, "stl", digits=None, force=False)
    before = (folder / "new.stl").read_bytes()
    with pytest.raises(Failure, match=r"^new\.stl: cannot write: "):
        write_mesh_file("new.stl", MESH, "obj", digits=None, force=False)
    assert (folder / "new.stl").read_bytes() == before
    write_mesh_file("new.stl", MESH, "obj", digits=None, force=True)
    assert (folder / "new.stl").read_bytes() != before
    note_not_kept("new.stl", lost, quiet=False)
    note_not_kept("new.stl", ("curves", "x\n"), quiet=False)
    note_not_kept("new.stl", ("curves",), quiet=True)
    assert capsys.readouterr().err == "note: new.stl: curves, x\\n are not kept\n"


def test_everything_about_a_file_is_in_its_object(torus_dmesh: bytes) -> None:
    container = parse_container("x", torus_dmesh, "cannot read")
    found = container_object("x", container)
    assert found["file"] == "x"
    assert found["bytes"] == len(torus_dmesh)
    sizes = [one["bytes"] for one in found["sections"]]
    assert found["header"]["bytes"] + sum(sizes) == len(torus_dmesh)
    assert container.meta is not None
    assert found["errors"] == errors_object(container.meta)
    assert found["errors"]["max_relative"] == container.meta.max / container.meta.diagonal
    assert described_container("a\nb", container).startswith(r"a\nb: ")
