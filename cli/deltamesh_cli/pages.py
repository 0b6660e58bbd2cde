"""Pages of the command line: a mesh from a file, beside its original."""

from __future__ import annotations

import os

from deltamesh._progress import Progress
from deltamesh_cli.comparing import Comparison, comparison_tables
from deltamesh_cli.meshes import LoadedMesh


def page_of_mesh(name: str, loaded: LoadedMesh, progress: Progress) -> str:
    """Return the page of a mesh in a file of this name."""
    from deltamesh._page.filling import page_of
    from deltamesh._page.holding import held

    own = os.path.basename(name)
    file = held(own, loaded.mesh, loaded.container, loaded.size, progress)
    progress("page")
    return page_of([file], own)


def page_of_comparison(name: str, original: str, comparison: Comparison, progress: Progress) -> str:
    """Return the page of the second mesh of a comparison beside the first, its original."""
    from deltamesh._page.filling import page_of
    from deltamesh._page.holding import held, held_original

    a, b, match = comparison.a, comparison.b, comparison.match
    own, other = os.path.basename(name), os.path.basename(original)
    files = [
        held_original(other, a.mesh, b.mesh, b.container, match, a.size, progress),
        held(own, b.mesh, b.container, b.size, progress),
    ]
    progress("page")
    return page_of(files, own, comparison_tables(comparison))
