"""deltamesh: compression of triangle meshes by quantized differential coordinates.

`encode` and `decode` take and return arrays and bytes; `save` and `load` are the same on files;
`info` tells what a file says of itself without decoding it; `verify` decodes it and tells whether
it is whole. numba and scipy are imported when one of them is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from deltamesh.version import __version__
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
    from deltamesh.codec import decode, encode
    from deltamesh.files import info, load, save, verify
    from deltamesh.mesh import Mesh

_HOME = {
    "decode": "deltamesh.codec",
    "encode": "deltamesh.codec",
    "info": "deltamesh.files",
    "load": "deltamesh.files",
    "save": "deltamesh.files",
    "verify": "deltamesh.files",
    "Mesh": "deltamesh.mesh",
}

__all__ = [
    "DeltameshError",
    "FormatError",
    "LimitError",
    "Mesh",
    "MeshError",
    "OptionError",
    "SolveError",
    "TargetError",
    "__version__",
    "decode",
    "encode",
    "info",
    "load",
    "save",
    "verify",
]


def __getattr__(name: str) -> Any:
    """Import what was asked for."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return __all__
