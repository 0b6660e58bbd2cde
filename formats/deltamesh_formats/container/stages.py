"""Stages of a file: what its beginning decodes to, by the sections that have come (SPEC.md 6).

A *prefix* is the beginning of a file, cut anywhere. The stages are, in their order:

- anchors: the least-squares mesh of connectivity and anchors;
- deltas: the surface of the deltas, which are coarse in a refined file;
- refinements: the same with the refinements along the normals;
- positions: all positions, as the whole file has them;
- whole: everything, and its checksum.

A file passes through those that its method has; a section that is cut counts as absent.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import (
    AFTER_CONNECTIVITY,
    AFTER_GEOMETRY,
    ANCHORS,
    ATTRIBUTES,
    CELLS,
    CHECK,
    CONNECTIVITY,
    CORRECTIONS,
    DELTAS,
    FRAMES,
    ID_SIZE,
    NORMALS,
    ORDER,
    PARAMETERS,
    PARTS,
    POSES,
)
from deltamesh_formats.container.method_layouts import METHODS

POSITIONS: Final = "positions"
WHOLE: Final = "whole"
# The stage that each section of solved positions reaches.
_REACHED: Final = {ANCHORS: "anchors", DELTAS: "deltas", NORMALS: "refinements"}
STAGES: Final = (*_REACHED.values(), POSITIONS, WHOLE)
# What people miss where a section has not come.
_WORDS: Final = {
    DELTAS: "deltas",
    NORMALS: "refinements",
    CELLS: "vectors of cells",
    CORRECTIONS: "corrections",
    ATTRIBUTES: "attributes",
    PARTS: "names, parts and metadata",
    ORDER: "order of the source",
    POSES: "poses",
    FRAMES: "frames beyond the first",
}


def stage_of(container: Container) -> str:
    """Return the stage that a prefix has reached, "" without any positions."""
    return _stage(container.parameters.method, container.sections, container.cut)


def stages_of(container: Container) -> dict[str, int]:
    """Return the stages of a file, and the bytes after which each is reached.

    Of a prefix, those that it has reached.
    """
    method, sections = container.parameters.method, list(container.sections.values())
    ids = [section.id for section in sections]
    found: dict[str, int] = {}
    for i, section in enumerate(sections, 1):
        found.setdefault(_stage(method, ids[:i], ""), section.end)
        for following in ids[i : i + 1] or filter(None, [container.cut]):
            found.setdefault(_stage(method, ids[:i], following), section.end + ID_SIZE)
    return {stage: size for stage, size in found.items() if stage}


def awaited(container: Container) -> tuple[str, ...]:
    """Return words for what has not come with a prefix, or would not have, if the file has it."""
    method = METHODS[container.parameters.method]
    order = (PARAMETERS, CONNECTIVITY, *AFTER_CONNECTIVITY, *method.geometry, *method.further)
    last = container.cut or list(container.sections)[-1]
    at = order.index(last) + (not container.cut) if last in order else len(order)
    return tuple(_WORDS[name] for name in order[at:] if name in _WORDS)


def _stage(name: str, ids: Collection[str], cut: str) -> str:
    """Return the stage of a method's sections `ids`, of which the next one may be `cut`."""
    method = METHODS[name]
    if CHECK in ids:
        return WHOLE
    come = [one for one in method.geometry if one in ids]
    if not come:
        return ""
    if come[-1] != method.geometry[-1]:
        return _REACHED[come[-1]]
    # Sections that may be missing end the geometry: the one after them shows what there is.
    of_geometry = {*method.required, *AFTER_CONNECTIVITY, *method.further} - {*AFTER_GEOMETRY}
    is_followed = CORRECTIONS in ids or not of_geometry.issuperset(filter(None, (*ids, cut)))
    return POSITIONS if is_followed or not method.anchored else _REACHED[come[-1]]
