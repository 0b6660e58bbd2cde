"""deltamesh: compression of meshes by quantized differential coordinates.

`encode` and `decode` take and return arrays and bytes; `save` and `load` are the same on files;
`info` describes a file without decoding it; `verify` decodes it and checks that it is whole;
`frames` decodes the meshes of a sequence one after the other; `stages` decodes a stream as its
bytes come; `view` shows a mesh in the browser, or in a notebook.
`from_arrays` makes a whole mesh, a `PolyMesh`, of polygons and attributes; `read_mesh` and
`write_mesh` are for the files of other programs, `deltamesh.plugins` for other libraries. A name is
imported when it is first used, and numpy and scipy with it if they are needed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from deltamesh._codec.decoding import decode as decode
    from deltamesh._codec.encoding import encode as encode
    from deltamesh._editing import (
        Edited as Edited,
        edit as edit,
        remove_poses as remove_poses,
    )
    from deltamesh._files import (
        frames as frames,
        info as info,
        load as load,
        save as save,
        verify as verify,
    )
    from deltamesh._page.viewing import Page as Page, view as view
    from deltamesh._prefixes import Partial as Partial, stages as stages
    from deltamesh._version import __version__ as __version__
    from deltamesh_formats.errors import (
        DeltameshError as DeltameshError,
        FormatError as FormatError,
        LimitError as LimitError,
        MeshError as MeshError,
        NoSurfaceError as NoSurfaceError,
        OptionError as OptionError,
        SolveError as SolveError,
        TargetError as TargetError,
    )
    from deltamesh_formats.meshfiles.files import read_mesh as read_mesh, write_mesh as write_mesh
    from deltamesh_formats.polymesh.arrays import from_arrays as from_arrays
    from deltamesh_formats.polymesh.mesh import (
        Attribute as Attribute,
        Parts as Parts,
        PolyMesh as PolyMesh,
    )
else:
    from deltamesh._lazy import lazy_names

    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "deltamesh._codec.decoding": ("decode",),
            "deltamesh._codec.encoding": ("encode",),
            "deltamesh._editing": ("Edited", "edit", "remove_poses"),
            "deltamesh._files": ("frames", "info", "load", "save", "verify"),
            "deltamesh._page.viewing": ("Page", "view"),
            "deltamesh._prefixes": ("Partial", "stages"),
            "deltamesh._version": ("__version__",),
            "deltamesh_formats.errors": (
                "DeltameshError",
                "FormatError",
                "LimitError",
                "MeshError",
                "NoSurfaceError",
                "OptionError",
                "SolveError",
                "TargetError",
            ),
            "deltamesh_formats.meshfiles.files": ("read_mesh", "write_mesh"),
            "deltamesh_formats.polymesh.arrays": ("from_arrays",),
            "deltamesh_formats.polymesh.mesh": ("Attribute", "Parts", "PolyMesh"),
        },
    )
