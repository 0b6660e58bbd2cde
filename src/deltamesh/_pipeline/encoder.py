"""Encoder of a checked mesh, or of a sequence: a walk over the table of sections."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from deltamesh._limits import filling
from deltamesh._measures.metrics import diagonal
from deltamesh._methods import AUTO, CARTESIAN, LOSSLESS, REFINED
from deltamesh._options import DEFAULT_QUALITY, Options
from deltamesh._pipeline.proof import proven
from deltamesh._progress import Progress, silent
from deltamesh._sections.draft import ALONE, Draft, Sequence, begin
from deltamesh._sections.table import SECTIONS
from deltamesh._shape.announced import announced
from deltamesh._version import __version__
from deltamesh_formats.array_types import Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container, Meta
from deltamesh_formats.container.fields import STRING_MAX_BYTES
from deltamesh_formats.container.layout import FILLING, REGIONS
from deltamesh_formats.container.regions import write_regions
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import MeshError, OptionError, SolveError, TargetError
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.printing import shortened


@dataclass(frozen=True)
class Encoded:
    """Result of an encoder.

    Attributes
    ----------
    data : bytes
        The file.
    container : Container
        The same, read again.
    draft : Draft
        The state of the encoder after the last section.
    """

    data: bytes
    container: Container = field(repr=False)
    draft: Draft = field(repr=False)

    @cached_property
    def mesh(self) -> PolyMesh:
        """The mesh that a decoder will make of the file."""
        single, meta = self.draft.mesh.precision == "float32", self.container.meta
        margin = 0.0 if meta is None else meta.room
        return self.draft.content.mesh(self.draft.chosen.vertices, single, margin)

    @cached_property
    def order(self) -> Ints:
        """The input vertex that each vertex of `mesh` was, int64 (n,)."""
        vertices, kept = self.draft.shape.provenance.vertices, self.draft.content.order
        return vertices if kept is None else vertices[kept.vertices]

    @cached_property
    def face_order(self) -> Ints:
        """The input polygon that each polygon of `mesh` was, int64 (p,)."""
        polygons = self.draft.shape.provenance.polygons
        return polygons if self.draft.content.order is None else np.arange(len(polygons))

    @cached_property
    def rotation(self) -> Ints:
        """The corner of that input polygon with which each polygon of `mesh` begins, int64 (p,)."""
        if self.draft.content.order is not None:
            return np.zeros_like(self.face_order)
        first = self.draft.content.structure.polygons.offsets[:-1]
        corners = self.draft.shape.provenance.corners[first]
        return corners - self.draft.mesh.offsets[self.face_order]


def encode_mesh(
    mesh: PolyMesh, options: Options, progress: Progress = silent, sequence: Sequence = ALONE
) -> Encoded:
    """Compress a checked mesh, or a sequence that begins with it; see `deltamesh.encode`."""
    if sequence.positions:
        return _encoded_sequence(mesh, options, progress, sequence)
    try:
        return _encoded(mesh, options, progress)
    except TargetError:
        if not options.asks_nothing:
            raise
    exact = replace(options, method=LOSSLESS.name, coarse=None, importance=None)
    return _encoded(mesh, exact, progress)


def _encoded_sequence(
    mesh: PolyMesh, options: Options, progress: Progress, sequence: Sequence
) -> Encoded:
    """Compress a sequence; "auto" is refined, and Cartesian where that cannot keep the bounds.

    Raises
    ------
    OptionError
        If the method, 0 bits, or an importance, cannot have several frames.
    """
    if options.importance is not None:
        raise OptionError("several frames cannot have an importance: encode each for itself")
    if options.exact or options.bits == 0:
        what = f"method {options.method}" if options.exact else "0 bits"
        raise OptionError(f"{what} cannot have several frames: encode each for itself")
    if options.method != AUTO:
        return _encoded(mesh, options, progress, sequence)
    asked = replace(options, quality=DEFAULT_QUALITY) if options.asks_nothing else options
    try:
        return _encoded(mesh, replace(asked, method=REFINED.name), progress, sequence)
    except (MeshError, SolveError, TargetError):
        if not options.asks_nothing and not options.is_bounded:
            raise
        other = replace(asked, method=CARTESIAN.name, coarse=None)
        return _encoded(mesh, other, progress, sequence)


def _encoded(
    mesh: PolyMesh, options: Options, progress: Progress, sequence: Sequence = ALONE
) -> Encoded:
    """Compress a checked mesh by the methods that the options allow."""
    draft = begin(mesh, options, progress, sequence)
    payloads: dict[str, bytes] = {}
    for section in SECTIONS:
        if section.applies(draft):
            progress(section.stage)
            found, draft = section.encode(draft)
            payloads |= found
    structure, trial = draft.content.structure, draft.chosen
    build = partial(
        build_container,
        len(structure.points),
        len(structure.faces),
        replace(trial.parameters, single=draft.mesh.precision == "float32"),
        meta=_meta(draft),
        digest=draft.content.digest(),
    )
    if draft.regions is not None:
        payloads[REGIONS] = write_regions(draft.regions)
    container = build(payloads)
    lacking = filling(container, announced(container))
    if lacking:
        container = build({**payloads, FILLING: bytes(lacking)})
    data = write_container(container)
    progress("proof")
    return Encoded(data, proven(data), draft)


def _meta(draft: Draft) -> Meta:
    errors, report = draft.chosen.measured.errors, draft.report
    assert report is not None
    worst = report.worst
    return Meta(
        rms=errors.rms,
        max=errors.max,
        normal=errors.normal_deviation,
        dihedral=errors.dihedral,
        diagonal=diagonal(draft.positions),
        margin=draft.margin,
        encoder=f"deltamesh {__version__}",
        source=draft.options.source_format,
        lost=len(report.lost),
        turned=len(report.turned),
        parts=report.parts,
        part="" if worst is None else shortened(worst.name, STRING_MAX_BYTES),
        part_normal=0.0 if worst is None else worst.normal_deviation,
        part_rms=0.0 if worst is None else worst.relative_rms,
    )
