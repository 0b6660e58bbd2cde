"""Summary of a mesh in one line of text or, for notebooks, in HTML."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.printing import html_table, printable

_FACES: Final = {3: "triangles", 4: "quads"}


def mesh_text(mesh: PolyMesh) -> str:
    """Return one line about a mesh: counts, and what else it holds."""
    facts = [f"{what} {text}" for what, text in _mesh_facts(mesh)]
    return f"<PolyMesh: {'; '.join([_mesh_counts(mesh), *facts])}>"


def mesh_html(mesh: PolyMesh) -> str:
    """Return the same for a notebook."""
    rows = [(what.removesuffix(":"), text) for what, text in _mesh_facts(mesh)]
    from html import escape  # a large table, which texts do not need

    return f"<div>\n{escape(_mesh_counts(mesh))}\n{html_table(rows)}\n</div>"


def _mesh_counts(mesh: PolyMesh) -> str:
    sizes = mesh.sizes
    least, most = (int(sizes.min()), int(sizes.max())) if len(sizes) else (3, 3)
    what = _FACES.get(least, f"faces of {least} corners")
    if most > least:
        what = f"faces of {least} to {most} corners"
    return f"{len(mesh.vertices)} vertices, {len(sizes)} {what}"


def _mesh_facts(mesh: PolyMesh) -> Iterator[tuple[str, str]]:
    for domain in ("vertex", "corner", "face"):
        arrays = [_array(a.name, a.values) for a in mesh.attributes if a.domain == domain]
        if arrays:
            yield f"{domain} data:", ", ".join(arrays)
    for parts in mesh.parts:
        yield f"{parts.kind}:", f"{len(parts.names)} parts"
    if mesh.metadata:
        yield "metadata:", ", ".join(map(printable, mesh.metadata))
    if mesh.lost:
        yield "lost:", ", ".join(map(printable, mesh.lost))


def _array(name: str, values: Any) -> str:
    width = f" x {values.shape[1]}" if values.shape[1] != 1 else ""
    return f"{printable(name)} ({values.dtype}{width})"
