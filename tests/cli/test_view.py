"""`deltamesh view`: what the page holds, where it goes, and what is opened."""

from __future__ import annotations

import json
import re
from pathlib import Path

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh._page import filling
from deltamesh._page.text_of_bytes import as_bytes
from deltamesh_cli.commands import view
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import from_triangles

V, F = meshes.icosphere(2)


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "template.html"
    path.write_text("<title>{title}</title><script>{facts}</script>\n{meshes}", encoding="utf-8")
    monkeypatch.setattr(filling, "PAGE", path)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The addresses that are opened, none of them in a browser."""
    found: list[str] = []
    monkeypatch.setattr(view.webbrowser, "open", lambda address: not found.append(address))
    return found


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """A mesh file, and a `.dmesh` of it."""
    mesh, packed = tmp_path / "ball.ply", tmp_path / "ball.dmesh"
    deltamesh.write_mesh(mesh, from_triangles(V, F))
    packed.write_bytes(deltamesh.encode(V, F, bits=8))
    return mesh, packed


def held(page: Path) -> list[tuple[str, str, int, bytes]]:
    """The name, role, size and bytes of each file in a page."""
    pattern = r'data-name="([^"]*)" data-role="([^"]*)" data-size="(\d+)">([^<]*)</script>'
    found = re.findall(pattern, page.read_text(encoding="utf-8"))
    return [(n, r, int(s), as_bytes(t)) for n, r, s, t in found]


def test_a_file_travels_as_it_is(files: tuple[Path, Path], opened: list[str]) -> None:
    _, packed = files
    code = run(["view", str(packed)])
    page = packed.with_name("ball.dmesh.html")
    assert code == 0
    assert held(page) == [("ball.dmesh", "", packed.stat().st_size, packed.read_bytes())]
    assert opened == [page.as_uri()]


def test_a_mesh_file_travels_to_the_last_bit(files: tuple[Path, Path], opened: list[str]) -> None:
    mesh, _ = files
    page = mesh.with_name("page.html")
    assert run(["view", "--no-open", str(mesh), "-o", str(page)]) == 0
    ((name, role, size, data),) = held(page)
    assert (name, role, size) == ("ball.ply", "", mesh.stat().st_size)
    own, found = deltamesh.read_mesh(mesh), deltamesh.decode(data)
    assert found.vertices.tobytes() == own.vertices.tobytes()
    np.testing.assert_array_equal(found.corners, own.corners)
    assert opened == []


def test_an_original_has_the_vertices_of_the_file(
    files: tuple[Path, Path], opened: list[str]
) -> None:
    mesh, packed = files
    page = mesh.with_name("page.html")
    assert run(["view", str(packed), str(mesh), "-o", str(page)]) == 0
    original, file = held(page)
    assert (original[:3], file[:3]) == (
        ("ball.ply", "original", mesh.stat().st_size),
        ("ball.dmesh", "", packed.stat().st_size),
    )
    one, other = deltamesh.decode(original[3]), deltamesh.decode(file[3])
    np.testing.assert_array_equal(one.corners, other.corners)
    error = np.linalg.norm(one.vertices - other.vertices, axis=1)
    meta = deltamesh.info(packed).meta
    assert meta is not None
    assert np.sqrt((error**2).mean()) == pytest.approx(meta.rms, rel=1e-2)
    facts = re.search(r"<script>(.*)</script>", page.read_text(encoding="utf-8"))
    assert facts is not None
    names = [row[0] for table in json.loads(facts[1])["compared"] for row in table]
    assert {"RMS", "Hausdorff", "face normals"} <= {*names}


def test_an_original_of_another_structure_travels_as_it_is(
    files: tuple[Path, Path], opened: list[str]
) -> None:
    _, packed = files
    other = packed.with_name("other.ply")
    W, G = meshes.icosphere(1)
    deltamesh.write_mesh(other, from_triangles(W, G))
    page = packed.with_name("page.html")
    assert run(["view", str(packed), str(other), "-o", str(page)]) == 0
    original = deltamesh.decode(held(page)[0][3])
    assert len(original.vertices) == len(W)


def test_a_page_is_overwritten_only_if_asked(files: tuple[Path, Path], opened: list[str]) -> None:
    _, packed = files
    page = packed.with_name("page.html")
    page.write_text("mine", encoding="utf-8")
    code = run(["view", str(packed), "-o", str(page)])
    assert (code, page.read_text(encoding="utf-8")) == (1, "mine")
    assert run(["view", "-f", str(packed), "-o", str(page)]) == 0
    assert held(page)


def test_json_names_the_page(
    files: tuple[Path, Path], opened: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    _, packed = files
    assert run(["view", "--json", str(packed)]) == 0
    found = json.loads(capsys.readouterr().out)
    page = packed.with_name("ball.dmesh.html")
    assert found == {"file": str(packed), "page": str(page), "bytes": page.stat().st_size}


def test_no_browser_is_a_note(
    files: tuple[Path, Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    _, packed = files
    monkeypatch.setattr(view.webbrowser, "open", lambda address: False)
    code = run(["view", str(packed)])
    assert code == 0
    assert "no browser was found" in capsys.readouterr().err


def test_a_damaged_file_is_refused(files: tuple[Path, Path], opened: list[str]) -> None:
    _, packed = files
    packed.write_bytes(packed.read_bytes()[:-1])
    code = run(["view", str(packed)])
    assert code == 3
    assert not packed.with_name("ball.dmesh.html").exists()
    assert opened == []
