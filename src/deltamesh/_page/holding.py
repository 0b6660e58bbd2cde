"""Files that a page holds, made of meshes: one as it is, an original beside it."""

from __future__ import annotations

from typing import Any, Final

from deltamesh._codec.encoding import encode
from deltamesh._compare.likeness import Correspondence
from deltamesh._page.alignment import aligned, shown
from deltamesh._page.filling import PageFile
from deltamesh._progress import Progress, silent
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.method_layouts import METHODS
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.polymesh.mesh import PolyMesh

# Bits of a coordinate of an original: a two-hundredth of a degree on meshes of a million faces.
_BITS: Final = 20


def held(
    name: str,
    mesh: PolyMesh,
    container: Container | None,
    size: int | None = None,
    progress: Progress = silent,
) -> PageFile:
    """Return a mesh as a page holds it: its `.dmesh` as it is, another to the last bit.

    Parameters
    ----------
    name : str
    mesh : PolyMesh
    container : Container or None
        Of which the mesh was decoded.
    size : int, optional
        Bytes of the file that it came from.
    progress : callable
    """
    if container is not None:
        data = write_container(container)
    else:
        data = encode(mesh, method="lossless", keep_order=True, progress=progress)
    return PageFile(name, data, "", len(data) if size is None else size)


def held_original(
    name: str,
    original: PolyMesh,
    mesh: PolyMesh,
    container: Container | None,
    match: Correspondence | None,
    size: int | None = None,
    progress: Progress = silent,
) -> PageFile:
    """Return an original as a page holds it beside a mesh.

    Parameters
    ----------
    name : str
    original, mesh : PolyMesh
    container : Container or None
        Of which the mesh was decoded. If it is lossless, so is what the page holds.
    match : Correspondence or None
        Which vertices of both are which, if they correspond: then the original gets the order and
        the faces of the mesh.
    size : int, optional
        Bytes of the file that it came from.
    progress : callable
    """
    same = shown(original) if match is None else aligned(mesh, match)
    keywords: dict[str, Any] = {"method": "cartesian", "bits": _BITS}
    if container is None or METHODS[container.parameters.method].exact:
        keywords = {"method": "lossless"}
    data = encode(same, keep_order=True, progress=progress, **keywords)
    return PageFile(name, data, "original", len(data) if size is None else size)
