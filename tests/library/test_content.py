"""Content of a file: its digest covers every array, and it makes a mesh on request."""

from __future__ import annotations

from dataclasses import fields, replace

import meshes
import numpy as np
from annotated import annotated_meshes
from drafts import stages_of
from hypothesis import given

from deltamesh._attributes.domains import Domains
from deltamesh._content import NOTHING, Content, digest
from deltamesh._geometry.integers import NO_POINTS, Integers
from deltamesh._order.reordering import Order
from deltamesh._parts import annotations_of
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles

V, F = meshes.tetrahedron()


def content_of(mesh: PolyMesh) -> tuple[Content, np.ndarray]:
    draft = list(stages_of(mesh).values())[-1].after
    content = Content(Domains(draft.structure), Integers(NO_POINTS))
    return content, mesh.vertices[draft.triangle_provenance.points]


def test_the_digest_covers_every_array() -> None:
    integers = Integers(
        **{
            field.name: np.zeros((2, 1 if field.name == "refinements" else 3), dtype=np.int64)
            for field in fields(Integers)
        }
    )
    seen = {digest(F, F[0], integers), digest(F[:3], F[0], integers), digest(F, F[1], integers)}
    for field in fields(Integers):
        array = getattr(integers, field.name).copy()
        array[1, 0] = 1
        seen.add(digest(F, F[0], replace(integers, **{field.name: array})))
    seen.add(digest(F, F[0], integers, (np.array([1]),)))
    assert len(seen) == 4 + len(fields(Integers))
    assert {len(one) for one in seen} == {8}


def test_the_digest_is_of_numbers_not_of_arrays() -> None:
    """Neither the strides nor the byte order of an array count."""
    other = np.asfortranarray(F).astype(">i8")
    assert digest(other, NO_POINTS, Integers(NO_POINTS)) == digest(
        F, NO_POINTS, Integers(NO_POINTS)
    )


def test_the_content_before_the_first_section_is_nothing() -> None:
    assert len(NOTHING.structure.faces) == len(NOTHING.integers.values) == 0
    assert NOTHING.annotations is None is NOTHING.order


def test_the_mesh_is_in_the_order_that_is_kept() -> None:
    mesh = from_triangles(V, F)
    content, points = content_of(mesh)
    plain = content.mesh(points, single=False)
    assert plain.precision == "float64"
    n, m = len(V), len(F)
    turned = Order(np.arange(n)[::-1].copy(), np.arange(m), np.ones(m, dtype=np.int64))
    ordered = replace(content, order=turned).mesh(points, single=True)
    assert ordered.precision == "float32"
    assert sorted(ordered.vertices.tolist()) == sorted(plain.vertices.tolist())
    assert not np.array_equal(ordered.corners, plain.corners)
    assert replace(content, order=turned).digest() != content.digest()


@given(annotated_meshes())
def test_annotations_are_given_to_the_mesh_and_count_in_the_digest(mesh: PolyMesh) -> None:
    content, points = content_of(mesh)
    polygons = list(stages_of(mesh).values())[-1].after.provenance.polygons
    annotations = annotations_of(mesh, polygons)
    whole = replace(content, annotations=annotations)
    made = whole.mesh(points, single=False)
    if annotations is None:
        assert made.parts == ()
        return
    assert [p.names for p in made.parts] == [p.names for p in mesh.parts]
    assert dict(made.metadata) == dict(mesh.metadata)
    assert whole.digest() != content.digest()
