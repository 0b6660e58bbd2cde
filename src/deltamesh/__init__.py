"""deltamesh: compression of triangle meshes by quantized differential coordinates.

`encode` and `decode` take and return arrays and bytes; `save` and `load` are the same on files;
`info` tells what a file says of itself without decoding it; `verify` decodes it and tells whether
it is whole. `from_arrays` makes a whole mesh, a `PolyMesh`, of polygons and attributes; `read_mesh`
and `write_mesh` are for the files of other programs, `deltamesh.plugins` for other libraries.
numba and scipy are imported when one of them is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from deltamesh._version import __version__
from deltamesh_formats.errors import (
    DeltameshError,
    FormatError,
    LimitError,
    MeshError,
    OptionError,
    SolveError,
    TargetError,
)

if TYPE_CHECKING:
    from deltamesh._codec import decode, encode
    from deltamesh._files import info, load, save, verify
    from deltamesh_formats.meshfiles.files import read_mesh, write_mesh
    from deltamesh_formats.polymesh.arrays import from_arrays
    from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

_HOME = {
    "decode": "deltamesh._codec",
    "encode": "deltamesh._codec",
    "info": "deltamesh._files",
    "load": "deltamesh._files",
    "save": "deltamesh._files",
    "verify": "deltamesh._files",
    "from_arrays": "deltamesh_formats.polymesh.arrays",
    "read_mesh": "deltamesh_formats.meshfiles.files",
    "write_mesh": "deltamesh_formats.meshfiles.files",
    "Attribute": "deltamesh_formats.polymesh.mesh",
    "Parts": "deltamesh_formats.polymesh.mesh",
    "PolyMesh": "deltamesh_formats.polymesh.mesh",
}

__all__ = [
    "Attribute",
    "DeltameshError",
    "FormatError",
    "LimitError",
    "MeshError",
    "OptionError",
    "Parts",
    "PolyMesh",
    "SolveError",
    "TargetError",
    "__version__",
    "decode",
    "encode",
    "from_arrays",
    "info",
    "load",
    "read_mesh",
    "save",
    "verify",
    "write_mesh",
]


def __getattr__(name: str) -> Any:
    """Import what was asked for."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return __all__
