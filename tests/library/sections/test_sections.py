"""The table of sections: encoder and decoder know the same after each, and nothing twice."""

from __future__ import annotations

import attributed
import meshes
import numpy as np
import pytest

from deltamesh import decode
from deltamesh._content import NOTHING
from deltamesh._graph import parallelograms
from deltamesh._options import Options
from deltamesh._pipeline import encoder
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._progress import silent
from deltamesh._sections.draft import begin
from deltamesh._sections.table import SECTIONS
from deltamesh._shape import manifold
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles


def grid() -> PolyMesh:
    """A grid of 12 x 12 quads with normals, texture coordinates and an attribute of the faces."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(13.0), np.arange(13.0)))
    i = (np.arange(12)[:, None] * 13 + np.arange(12)).ravel()
    normals = np.stack([-np.cos(x / 3) / 3, np.sin(y / 4) / 4, np.ones(len(x))], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return from_arrays(
        np.stack([x, y, np.sin(x / 3) + np.cos(y / 4)], axis=1),
        np.stack([i, i + 1, i + 14, i + 13], axis=1),
        vertex={"normal": normals.astype(np.float32), "uv": np.stack([x, y], axis=1) / 12},
        face={"patch": np.arange(len(i)) % 7},
    )


MADE = {
    "grid": grid(),
    "sphere": from_triangles(*meshes.icosphere(2)),
    "complex": from_triangles(*meshes.union(*meshes.complexes().values())),
    "split": attributed.with_copies(),
}


@pytest.mark.parametrize("keep_order", [False, True])
@pytest.mark.parametrize("name", MADE)
def test_both_sides_know_the_same_after_each_section(name: str, keep_order: bool) -> None:
    mesh, options = MADE[name], Options(method="cartesian", keep_order=keep_order)
    container = read_container(encode_mesh(mesh, options).data)
    draft, content = begin(mesh, options, silent), NOTHING
    assert any(section.applies(draft) for section in SECTIONS)
    for section in SECTIONS:
        assert section.applies(draft) == section.is_in(container)
        if section.applies(draft):
            _, draft = section.encode(draft)
            content = section.decode(container, content)
        assert draft.content.digest() == content.digest()
    assert content.digest() == container.digest


@pytest.mark.parametrize("name", ["grid", "sphere"])
def test_half_edges_are_paired_once_in_a_decoder_and_once_in_an_encoder(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    paired = []

    def counted(faces):
        paired.append(faces)
        return pair_halfedges(faces)

    pair_halfedges = manifold.pair_halfedges
    for module in (manifold, parallelograms):
        monkeypatch.setattr(module, "pair_halfedges", counted)
    monkeypatch.setattr(encoder, "proven", lambda *_: None)  # which decodes
    data = encode_mesh(MADE[name], Options(method="cartesian")).data
    assert len(paired) == 1
    decode(data)
    assert len(paired) == 2


def test_the_decoded_mesh_is_made_on_request() -> None:
    encoded = encode_mesh(MADE["sphere"], Options(method="refined"))
    assert "mesh" not in vars(encoded)
    found = decode(encoded.data)
    np.testing.assert_array_equal(encoded.mesh.corners, found.corners)
    np.testing.assert_allclose(encoded.mesh.vertices, found.vertices, rtol=0, atol=1e-9)
    assert encoded.mesh is encoded.mesh
