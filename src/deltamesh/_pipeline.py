"""Pipelines of encoder and decoder: two walks over the table of sections.

encode: draft -> for each section, payload and draft -> container -> bytes, decoded as a proof
decode: bytes -> container -> limits -> for each section, content -> digest -> positions -> mesh
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from deltamesh._content import NOTHING, Content
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.interpolation import FINER
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._limits import check_limits, check_pose, filling, memory_to_solve
from deltamesh._measures.metrics import diagonal
from deltamesh._methods import AUTO, CARTESIAN, LOSSLESS, REFINED
from deltamesh._options import DEFAULT_QUALITY, Options
from deltamesh._posing import check_name, in_pose, pose_named, posed_points, posing_system
from deltamesh._progress import Progress, silent
from deltamesh._sections.draft import ALONE, Draft, Sequence, begin
from deltamesh._sections.table import SECTIONS
from deltamesh._sections.trials import has_scale
from deltamesh._shape.announced import announced
from deltamesh._shape.surface import Surface
from deltamesh._version import __version__
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container, Meta
from deltamesh_formats.container.layout import (
    ATTRIBUTES,
    CHECK,
    FILLING,
    FRAMES,
    MAX_COUNT,
    PARAMETERS,
    REGIONS,
    STRING_MAX_BYTES,
)
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.container.regions import write_regions
from deltamesh_formats.container.writer import write_container
from deltamesh_formats.errors import (
    FormatError,
    LimitError,
    MeshError,
    OptionError,
    SolveError,
    TargetError,
)
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


def proven(data: bytes) -> Container:
    """Return the container of a file, once a decoder, given any memory, has read all but positions.

    Raises
    ------
    RuntimeError
        If it cannot be read, or if what is read is not what its digest was made of.
    """
    try:
        container = read_container(data)
        content = proven_content(container, max_vertices=MAX_COUNT, memory=sys.maxsize)
        if FRAMES in container.sections:
            from deltamesh._sections.frames import frame_integers

            for frame in container.frames:
                frame_integers(container, content, frame)
    except (FormatError, LimitError) as error:
        raise RuntimeError(f"the encoded file cannot be decoded: {error}") from error
    return container


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


def decode_mesh(
    container: Container,
    *,
    pose: str | None = None,
    solver: str,
    threads: int | None,
    max_vertices: int,
    memory: int,
    progress: Progress = silent,
) -> PolyMesh:
    """Decompress a container; see `deltamesh.decode`."""
    if pose is None:
        # The content is handed over, too: nothing here keeps what is no longer needed.
        return positioned(
            container,
            proven_content(container, max_vertices, memory, progress),
            solver,
            threads,
            memory,
            progress,
        )
    check_name(container, pose)
    to_solve = check_pose(container, memory)
    content = proven_content(container, max_vertices, memory, progress)
    surface, solving = content.structure.surface, (solver, threads, memory, progress)
    points = points_at_rest(container, surface, [content.integers], *solving)
    mesh = content.mesh(points, container.parameters.single, container.margin)
    progress("pose")
    system = posing_system(content, solver, threads, to_solve)
    moved, turns = posed_points(content, points, system, pose_named(content, pose))
    return in_pose(mesh, content, moved, turns)


def positioned(
    container: Container,
    content: Content,
    solver: str,
    threads: int | None,
    memory: int,
    progress: Progress,
) -> PolyMesh:
    """Return the mesh of a content, once its positions are solved for.

    Raises
    ------
    LimitError, SolveError
    """
    # Nobody else keeps the integers: what is no longer needed of them is freed on the way.
    handed_over = [content.integers]
    content = replace(content, integers=NOTHING.integers)
    surface, solving = content.structure.surface, (solver, threads, memory, progress)
    points = points_at_rest(container, surface, handed_over, *solving)
    return content.mesh(points, container.parameters.single, container.margin)


def points_at_rest(
    container: Container,
    surface: Surface,
    integers: list[Integers],
    solver: str,
    threads: int | None,
    memory: int,
    progress: Progress,
) -> Floats:
    """Return the positions of a file, float64 (p, 3); its integers are taken out of a list.

    Raises
    ------
    LimitError, SolveError
    """
    progress("positions")
    parameters = container.parameters
    systems = Systems(surface, solver, threads, memory_to_solve(container, memory))
    coder = geometry_codec(parameters.method)
    precise = to_precision_of(container, systems)
    return coder.reconstruct(surface, parameters, integers.pop(), precise)


def to_precision_of(container: Container, systems: Systems) -> Systems:
    """Return systems that solve for the mesh of a file as exactly as its attributes need it."""
    return systems.to_precision(FINER) if ATTRIBUTES in container.sections else systems


def proven_content(
    container: Container, max_vertices: int, memory: int, progress: Progress = silent
) -> Content:
    """Return the content of a file, whose digest and scale are right.

    Raises
    ------
    FormatError, LimitError
    """
    if not container.is_whole:
        raise FormatError(f"truncated: section {CHECK} is missing", container.size)
    content = read_content(container, max_vertices, memory, progress)
    if content.digest() != container.digest:
        offset = container.sections[CHECK].offset
        raise FormatError("the checksum of the decoded integers is wrong", offset)
    check_scale(container, content.integers)
    return content


def read_content(
    container: Container, max_vertices: int, memory: int, progress: Progress = silent
) -> Content:
    """Return the content of a file, or of a prefix; its digest is not checked yet.

    Raises
    ------
    FormatError, LimitError
    """
    check_limits(container, announced(container), max_vertices, memory)
    content = NOTHING
    for section in SECTIONS:
        if section.is_in(container):
            progress(section.stage)
            content = section.decode(container, content)
    return content


def check_scale(container: Container, integers: Integers) -> None:
    """Refuse steps and origins that no mesh has."""
    if not has_scale(container.parameters, integers):
        raise FormatError("positions that are too large", container.sections[PARAMETERS].offset)
