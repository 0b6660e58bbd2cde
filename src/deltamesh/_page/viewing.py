"""Pages of meshes in programs and notebooks."""

from __future__ import annotations

import html
import os
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from deltamesh._codec.decoding import decode
from deltamesh._compare.likeness import corresponding
from deltamesh._page.filling import page_of
from deltamesh._page.holding import held, held_original
from deltamesh._sources import bytes_of
from deltamesh_formats.arguments import require_type
from deltamesh_formats.atomic import write_file
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.polymesh.mesh import PolyMesh

Shown: TypeAlias = PolyMesh | bytes | Container

# Pixels of the page in a cell of a notebook.
_HEIGHT: Final = 480


@dataclass(frozen=True)
class Page:
    """A page that shows meshes in the browser; a notebook shows it in its cell.

    Attributes
    ----------
    html : str
        The whole page, which fetches nothing.
    """

    html: str = field(repr=False)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page into a file; one that exists is replaced."""
        write_file(os.fspath(path), self.html.encode(), overwrite=True)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        source = html.escape(self.html, quote=True)
        style = f"width: 100%; height: {_HEIGHT}px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{source}"></iframe>'


def view(mesh: Shown, original: Shown | None = None, *, title: str = "mesh") -> Page:
    """Return a page that shows a mesh, beside its original if there is one.

    Parameters
    ----------
    mesh, original : PolyMesh, bytes or Container
        A mesh, or a `.dmesh` file, which the page then holds as it is.
    title : str
        What the page calls the mesh.

    Returns
    -------
    Page

    Raises
    ------
    FormatError, LimitError, SolveError
        If a file cannot be decoded.
    OptionError
        If the title is not a str.
    TypeError
        For anything but a mesh or bytes.
    MeshError
        If a mesh cannot be encoded.
    DeltameshError
        If this installation was made without the page.
    """
    require_type("title", title, str)
    own, container = _read(mesh)
    files = [held(title, own, container)]
    if original is not None:
        other, _ = _read(original)
        exact = container is None
        match = corresponding(other, own, exact)
        files.insert(0, held_original("original", other, own, container, match))
    return Page(page_of(files, title))


def _read(mesh: Shown) -> tuple[PolyMesh, Container | None]:
    """Return a mesh, and the file that it comes from, if it does."""
    if isinstance(mesh, PolyMesh):
        return mesh, None
    container = mesh if isinstance(mesh, Container) else read_container(bytes_of(mesh))
    return decode(container), container
