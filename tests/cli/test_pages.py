"""Pages of comparisons: `deltamesh compare --html`, and what it is made of."""

from __future__ import annotations

from pathlib import Path

import meshes
import pytest

import deltamesh
from deltamesh._page import filling
from deltamesh_cli.comparing import compare_meshes
from deltamesh_cli.meshes import LoadedMesh
from deltamesh_cli.pages import page_of_comparison, page_of_mesh
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import from_triangles

V, F = meshes.icosphere(1)
A, B = from_triangles(V, F), from_triangles(V * 1.01, F)


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "template.html"
    path.write_text("<title>{title}</title><script>{facts}</script>\n{meshes}", encoding="utf-8")
    monkeypatch.setattr(filling, "PAGE", path)


def silent(stage: str) -> None:
    """Tell nobody."""


def test_names_are_those_of_the_files_alone() -> None:
    a, b = LoadedMesh(A, 100, None), LoadedMesh(B, 50, None)
    page = page_of_comparison("folder/b.obj", "other/a.obj", compare_meshes(a, b, silent), silent)
    assert page.index('data-name="a.obj" data-role="original" data-size="100"') < page.index(
        'data-name="b.obj" data-role="" data-size="50"'
    )
    assert "folder" not in page
    assert "<title>b.obj</title>" in page_of_mesh("folder/b.obj", b, silent)


def test_compare_writes_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b, page = (tmp_path / name for name in ("a.ply", "b.dmesh", "p.html"))
    deltamesh.write_mesh(a, A)
    b.write_bytes(deltamesh.encode(A, bits=6))
    line = ["compare", str(a), str(b), "--html", str(page)]
    assert run(line) == 0
    assert "Hausdorff" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    assert text.count('class="mesh"') == 2
    assert '"RMS"' in text
    assert run(line) == 1
    assert run([*line, "-f"]) == 0
    assert run(["compare", str(tmp_path), str(tmp_path), "--html", str(page)]) == 2
