"""Geometry methods as the container knows them: wire numbers, sections, and the order of these."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

from deltamesh_formats.container.layout import (
    AFTER_CONNECTIVITY,
    AFTER_GEOMETRY,
    ANCHORS,
    CARTESIAN,
    CELLS,
    CHECK,
    CONNECTIVITY,
    CORRECTIONS,
    DELTAS,
    EXACT,
    FRAMES,
    META,
    NORMALS,
    PARAMETERS,
    POSES,
    REGIONS,
    STEPS,
)


@dataclass(frozen=True)
class MethodLayout:
    """A geometry method as the container knows it: its sections, and its rules for `PARM`.

    Attributes
    ----------
    name : str
    id : int
        The byte in `PARM`; it never changes.
    title : str
        The name for people.
    geometry : tuple of str
        The sections of the geometry, in their order; isolated vertices are in the first.
    corrected : bool
        Whether `FIXS` may follow them.
    anchored : bool
        Whether the file has anchors, from which positions are solved for; `CELL` and `POSE` may
        follow, then.
    exact : bool
        Whether positions are stored to the last bit: without bits, a step, or an origin.
    bare : bool
        Whether 0 bits leave the anchors alone, without a step.
    coarse : bool
        Whether the deltas may have a coarser step than `step`.
    """

    name: str
    id: int
    title: str
    geometry: tuple[str, ...]
    corrected: bool = False
    anchored: bool = False
    exact: bool = False
    bare: bool = False
    coarse: bool = False

    @property
    def required(self) -> tuple[str, ...]:
        """The sections that a file begins with, in this order; `CHEK` ends it."""
        return (PARAMETERS, CONNECTIVITY, *self.geometry)

    @property
    def after_connectivity(self) -> tuple[str, ...]:
        """The sections that may follow `CONN`, in this order: an exact method has no steps."""
        return tuple(name for name in AFTER_CONNECTIVITY if name != STEPS or not self.exact)

    @property
    def further(self) -> tuple[str, ...]:
        """The sections that may follow these, in this order: an exact method has one frame."""
        cells, corrections = (
            (CELLS,) if self.anchored else (),
            (CORRECTIONS,) if self.corrected else (),
        )
        left_out = {POSES: not self.anchored, FRAMES: self.exact}
        after = (name for name in AFTER_GEOMETRY if not left_out.get(name, False))
        return (*cells, *corrections, *after)


METHODS: Final[Mapping[str, MethodLayout]] = {
    method.name: method
    for method in (
        MethodLayout(
            "highpass", 0, "high-pass", (ANCHORS, DELTAS), corrected=True, anchored=True, bare=True
        ),
        MethodLayout("cartesian", 1, "Cartesian", (CARTESIAN,)),
        MethodLayout(
            "refined",
            2,
            "refined high-pass",
            (ANCHORS, DELTAS, NORMALS),
            corrected=True,
            anchored=True,
            coarse=True,
        ),
        MethodLayout("lossless", 3, "lossless", (EXACT,), exact=True),
    )
}
KNOWN: Final = frozenset(
    {META, REGIONS, CHECK, *AFTER_CONNECTIVITY}.union(
        *({*method.required, *method.further} for method in METHODS.values())
    )
)


def required(method: str, present: Collection[str]) -> tuple[str, ...]:
    """Return the sections that a file of a method begins with, where those `present` are."""
    ids = METHODS[method].required
    after = ids.index(CONNECTIVITY) + 1
    needed = tuple(name for name in METHODS[method].after_connectivity if name in present)
    further = tuple(name for name in METHODS[method].further if name in present)
    return (*ids[:after], *needed, *ids[after:], *further)
