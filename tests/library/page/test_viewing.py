"""Pages of meshes in programs: what they hold, and what a notebook gets."""

from __future__ import annotations

import html
import re
from pathlib import Path

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh import Page, view
from deltamesh._page import filling
from deltamesh._page.holding import held, held_original
from deltamesh._page.text_of_bytes import as_bytes
from deltamesh._page.viewing import Page as Own
from deltamesh_formats.polymesh.mesh import from_triangles

V, F = meshes.icosphere(1)
MESH = from_triangles(V, F)


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "page.html"
    path.write_text("<title>{title}</title><script>{facts}</script>\n{meshes}", encoding="utf-8")
    monkeypatch.setattr(filling, "PAGE", path)


def files(page: Page) -> list[tuple[str, str, bytes]]:
    """The name, role and bytes of each file in a page."""
    pattern = r'data-name="([^"]*)" data-role="([^"]*)"[^>]*>([^<]*)</script>'
    found = re.findall(pattern, page.html)
    return [(name, role, as_bytes(text)) for name, role, text in found]


def test_a_file_is_held_as_it_is() -> None:
    data = deltamesh.encode(MESH, bits=8)
    for one in (data, deltamesh.info(data)):
        assert files(view(one, title="ball")) == [("ball", "", data)]


def test_a_mesh_is_held_to_the_last_bit() -> None:
    ((name, role, data),) = files(view(MESH))
    assert (name, role) == ("mesh", "")
    found = deltamesh.decode(data)
    assert found.vertices.tobytes() == MESH.vertices.tobytes()
    np.testing.assert_array_equal(found.corners, MESH.corners)


def test_an_original_is_beside_it_in_its_order() -> None:
    data = deltamesh.encode(MESH, bits=4)
    original, own = files(view(data, MESH))
    assert (original[:2], own[:2]) == (("original", "original"), ("mesh", ""))
    one, other = deltamesh.decode(original[2]), deltamesh.decode(own[2])
    np.testing.assert_array_equal(one.corners, other.corners)
    assert {*map(tuple, np.round(one.vertices, 4))} == {*map(tuple, np.round(V, 4))}


def test_an_original_of_a_lossless_file_is_lossless() -> None:
    data = deltamesh.encode(MESH, method="lossless")
    own = deltamesh.decode(data)
    found = held_original("o", MESH, own, deltamesh.info(data), None)
    assert deltamesh.decode(found.data).vertices.tobytes() == MESH.vertices.tobytes()
    assert found.size == len(found.data)
    assert held("a", own, None, 7).size == 7


def test_a_notebook_gets_a_frame_of_the_page(tmp_path: Path) -> None:
    page = view(MESH)
    assert Page is Own
    assert "html" not in repr(page)
    source = re.search(r'srcdoc="([^"]*)"', page._repr_html_())
    assert source is not None
    assert html.unescape(source[1]) == page.html
    assert 'sandbox="allow-scripts"' in page._repr_html_()
    for _ in range(2):
        page.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text(encoding="utf-8") == page.html
