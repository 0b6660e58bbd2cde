"""Extensions of glTF: those that are read, those that are left out, and those that are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, Final

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.glb.compression import DRACO, MESHOPT
from deltamesh_formats.meshfiles.glb.schema import Tree, items

# It allows positions, normals, tangents and texture coordinates of integers.
QUANTIZED: Final = "KHR_mesh_quantization"
# Integer positions and normals are read as they are; what is compressed is decoded.
_READ: Final = frozenset([QUANTIZED, DRACO, *MESHOPT])
# Extensions of materials and textures: without them a file has the same mesh, in another look.
_OF_LOOKS: Final = re.compile(
    r"KHR_materials_.+|(KHR|EXT|MSFT)_texture_.+|(KHR|EXT)_lights_.+|KHR_xmp.*"
)
# Extensions of looks that are not among the look of materials and the textures, by which the others
# are described.
_OTHER_LOOKS: Final = frozenset(["KHR_materials_variants"])
_WORDS: Final = {"KHR_lights_punctual": "lights", "EXT_mesh_gpu_instancing": "GPU instances"}
_MOST: Final = 6
# Arrays of the JSON whose objects may have extensions that are not declared.
_PLACES: Final = ("scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers")


def check_required(tree: Tree) -> None:
    """Refuse a file that needs an extension without which its mesh would be another one.

    Raises
    ------
    MeshError
        With the name of the extension.
    """
    for name in items(tree, "extensionsRequired"):
        if name not in _READ and not _OF_LOOKS.fullmatch(str(name)):
            raise MeshError(f"it needs the glTF extension {str(name)[:80]}, which is not read")


def extension_losses(tree: Tree) -> Iterator[str]:
    """Yield descriptions of the extensions of a file that are not kept."""
    names = dict.fromkeys([*map(str, items(tree, "extensionsUsed")), *_names_in_use(tree)])
    others = []
    for name in names:
        if name in _WORDS:
            yield _WORDS[name]
        elif name in _OTHER_LOOKS or not (name in _READ or _OF_LOOKS.fullmatch(name)):
            others.append(name[:80])
    if others:
        more = f" and {len(others) - _MOST} more" if len(others) > _MOST else ""
        yield f"the glTF extension{'s' * (len(others) > 1)} {', '.join(others[:_MOST])}{more}"


def _names_in_use(tree: Tree) -> Iterator[str]:
    """Yield the names of the extensions that objects of a file have, declared or not."""
    yield from _names_of(tree)
    for place in _PLACES:
        for one in items(tree, place):
            yield from _names_of(one)
            for primitive in items(one, "primitives") if place == "meshes" else ():
                yield from _names_of(primitive)


def _names_of(one: Any) -> Iterator[str]:
    extensions = one.get("extensions") if isinstance(one, dict) else None
    if isinstance(extensions, dict):
        yield from extensions
