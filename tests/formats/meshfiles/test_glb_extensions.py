"""Extensions of glTF that are read, left out with their names, or refused."""

from __future__ import annotations

from typing import Any

import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.extensions import check_required, extension_losses


@pytest.mark.parametrize(
    "name",
    [
        "KHR_mesh_quantization",
        "KHR_materials_unlit",
        "KHR_materials_variants",
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "MSFT_texture_dds",
        "KHR_lights_punctual",
    ],
)
def test_what_does_not_change_the_mesh_may_be_required(name: str) -> None:
    check_required({"extensionsRequired": [name]})


@pytest.mark.parametrize(
    "name",
    [
        "VENDOR_mesh_magic",
        "EXT_mesh_gpu_instancing",
        "KHR_draco_mesh_compression2",
        "KHR_node_visibility",
        "MSFT_lod",
        "KHR_mesh_quantization2",
        "",
    ],
)
def test_what_may_change_it_is_refused_by_name(name: str) -> None:
    required = ["KHR_mesh_quantization", name]
    with pytest.raises(MeshError, match=f"it needs the glTF extension {name}, which is not read"):
        check_required({"extensionsRequired": required})


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        ({}, []),
        ({"extensionsUsed": ["KHR_mesh_quantization", "KHR_materials_unlit"]}, []),
        ({"extensionsUsed": ["VRM"]}, ["the glTF extension VRM"]),
        ({"extensions": {"VRM": {}}}, ["the glTF extension VRM"]),
        ({"nodes": [{}, {"extensions": {"MSFT_lod": {}}}]}, ["the glTF extension MSFT_lod"]),
        (
            {"meshes": [{"primitives": [{"extensions": {"EXT_mesh_features": {}}}]}]},
            ["the glTF extension EXT_mesh_features"],
        ),
        (
            {"extensionsUsed": ["A", "KHR_materials_variants"], "extensions": {"A": {}, "B": {}}},
            ["the glTF extensions A, KHR_materials_variants, B"],
        ),
        ({"extensionsUsed": ["EXT_mesh_gpu_instancing"]}, ["GPU instances"]),
        ({"extensions": {"KHR_lights_punctual": {"lights": []}}}, ["lights"]),
        (
            {"extensionsUsed": [f"X{i}" for i in range(93)]},
            ["the glTF extensions X0, X1, X2, X3, X4, X5 and 87 more"],
        ),
        ({"extensions": 7, "nodes": [{"extensions": []}]}, []),
        ({"extensionsUsed": ["x" * 200]}, ["the glTF extension " + "x" * 80]),
    ],
)
def test_what_is_left_out_is_named_once(tree: dict[str, Any], expected: list[str]) -> None:
    assert list(extension_losses(tree)) == expected
