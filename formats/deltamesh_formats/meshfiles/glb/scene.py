"""Placed meshes of a glTF scene, and descriptions of what else it has."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.accessors import Gltf, reals
from deltamesh_formats.meshfiles.glb.extensions import extension_losses
from deltamesh_formats.meshfiles.glb.schema import Tree, items


class Placed(NamedTuple):
    """Mesh in the scene: its index, the name, transform and depth in the tree of its node."""

    mesh: int
    name: str
    matrix: Floats
    depth: int


def placed_meshes(gltf: Gltf) -> list[Placed]:
    """Return the meshes of the scene that is shown by default, node after node, children after it.

    Raises
    ------
    MeshError
        When nodes are not a tree.
    """
    if not gltf.items("nodes"):
        return [Placed(i, "", np.eye(4), 0) for i in range(len(gltf.items("meshes")))]
    found: list[Placed] = []
    seen: set[int] = set()
    stack = [(node, np.eye(4), 0) for node in reversed(_roots(gltf))]
    while stack:
        number, above, depth = stack.pop()
        node = gltf.item("nodes", number)
        if number in seen:
            raise MeshError(f"node {number} is twice in the scene")
        seen.add(number)
        with np.errstate(all="ignore"):
            matrix = above @ _matrix(node)
        if "mesh" in node:
            gltf.item("meshes", node["mesh"])
            found.append(Placed(node["mesh"], str(node.get("name", "")), matrix, depth))
        below = reversed(items(node, "children"))
        stack += [(child, matrix, depth + 1) for child in below]
    return found


def scene_losses(gltf: Gltf) -> Iterator[str]:
    """Yield descriptions of what a file has beside meshes, nodes and names of materials."""
    for name in ("animations", "skins", "cameras"):
        if gltf.items(name):
            yield name
    if gltf.items("textures") or gltf.items("images"):
        yield "textures"
    if any(set(gltf.item("materials", i)) - {"name"} for i in range(len(gltf.items("materials")))):
        yield "the look of materials"
    if len(gltf.items("scenes")) > 1:
        yield "other scenes"
    yield from extension_losses(gltf.tree)
    if any("extras" in one for one in _with_extras(gltf)):
        yield "custom properties (extras)"


def _with_extras(gltf: Gltf) -> Iterator[Tree]:
    """Yield the objects that may have custom properties; the look of materials is named anyway."""
    asset = gltf.tree.get("asset")
    yield from (gltf.tree, asset if isinstance(asset, dict) else {})
    for name in ("scenes", "nodes", "meshes"):
        for i in range(len(gltf.items(name))):
            one = gltf.item(name, i)
            yield one
            yield from items(one, "primitives")


def _roots(gltf: Gltf) -> list[int]:
    if gltf.items("scenes"):
        return items(gltf.item("scenes", gltf.tree.get("scene", 0)), "nodes")
    nodes = gltf.items("nodes")
    below = (items(gltf.item("nodes", i), "children") for i in range(len(nodes)))
    children = {child for some in below for child in some}
    return [i for i in range(len(nodes)) if i not in children]


def _matrix(node: Tree) -> Floats:
    """Return the transform of a node: its matrix, or translation after rotation after scale."""
    given = reals(node, "matrix", 16)
    if given is not None:
        return given.reshape(4, 4).T
    matrix = np.eye(4)
    rotation, scale = reals(node, "rotation", 4), reals(node, "scale", 3)
    translation = reals(node, "translation", 3)
    if rotation is not None:
        matrix[:3, :3] = _rotation(rotation)
    if scale is not None:
        matrix[:3, :3] *= scale
    if translation is not None:
        matrix[:3, 3] = translation
    return matrix


def _rotation(quaternion: Floats) -> Floats:
    """Return the rotation of a quaternion (x, y, z, w)."""
    norm = float(quaternion @ quaternion)
    if not norm:
        return np.eye(3)
    u, w = quaternion[:3], quaternion[3]
    cross = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    doubled: Floats = 2 * (np.outer(u, u) - u @ u * np.eye(3) + w * cross)
    return np.eye(3) + doubled / norm
