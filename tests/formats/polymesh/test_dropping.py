"""Leaving out attributes, parts and metadata by their names."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh_formats.polymesh.dropping import without
from deltamesh_formats.polymesh.mesh import Attribute, Kind, Parts, PolyMesh, Role, from_triangles


def attribute(name: str, role: Role) -> Attribute:
    return Attribute(name, "vertex", np.zeros((42, 2)), role)


def parts(kind: Kind) -> Parts:
    return Parts(kind, ("a",), np.zeros(80, dtype=np.int64), np.eye(4)[None])


def full() -> PolyMesh:
    return replace(
        from_triangles(*meshes.icosphere(1)),
        attributes=(
            attribute("normal", "normal"),
            attribute("uv", "uv"),
            attribute("uv1", "uv"),
            attribute("quality", "other"),
        ),
        parts=(parts("object"), parts("group")),
        metadata={"comments": ("one",), "mtllib": ("two",)},
        lost=("a texture",),
    )


def names(mesh: PolyMesh) -> list[str]:
    return [
        *(a.name for a in mesh.attributes),
        *(p.kind for p in mesh.parts),
        *("transforms" for p in mesh.parts if p.transforms is not None),
        *mesh.metadata,
    ]


ALL = ["normal", "uv", "uv1", "quality", "object", "group", "transforms", "transforms"]
ALL += ["comments", "mtllib"]


@pytest.mark.parametrize(
    ("dropped", "gone"),
    [
        ([], []),
        (["uv"], ["uv", "uv1"]),
        (["uv1"], ["uv1"]),
        (["quality", "normal"], ["normal", "quality"]),
        (["group"], ["group", "transforms"]),
        (["transforms"], ["transforms", "transforms"]),
        (["comments", "colour"], ["comments"]),
        (["other"], ["quality"]),
        (["all"], ALL),
    ],
)
def test_what_is_named_goes_and_the_rest_stays(dropped: list[str], gone: list[str]) -> None:
    mesh = full()
    left = without(mesh, dropped)
    assert sorted(names(left) + gone) == sorted(ALL) == sorted(names(mesh))
    assert left.vertices is mesh.vertices
    assert left.corners is mesh.corners
    assert left.lost == mesh.lost
