"""Decoder of a container: a walk over the table of sections, and what positions follow from it."""

from __future__ import annotations

from dataclasses import replace

from deltamesh._content import NOTHING, Content
from deltamesh._decode_options import DecodeOptions
from deltamesh._geometry.integers import Integers
from deltamesh._geometry.interpolation import FINER
from deltamesh._geometry.methods import geometry_codec
from deltamesh._geometry.systems import Systems
from deltamesh._limits import check_limits, check_pose, memory_to_solve
from deltamesh._posing import check_name, in_pose, pose_named, posed_points, posing_system
from deltamesh._progress import Progress, silent
from deltamesh._sections.table import SECTIONS
from deltamesh._sections.trials import has_scale
from deltamesh._shape.announced import announced
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import ATTRIBUTES, CHECK, PARAMETERS
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import PolyMesh


def decode_mesh(container: Container, options: DecodeOptions, pose: str | None = None) -> PolyMesh:
    """Decompress a container; see `deltamesh.decode`."""
    limits = options.max_vertices, options.memory, options.progress
    if pose is None:
        # The content is handed over, too: nothing here keeps what is no longer needed.
        return positioned(container, proven_content(container, *limits), options)
    check_name(container, pose)
    to_solve = check_pose(container, options.memory)
    content = proven_content(container, *limits)
    points = points_at_rest(container, content.structure.surface, [content.integers], options)
    mesh = content.mesh(points, container.parameters.single, container.margin)
    options.progress("pose")
    system = posing_system(content, options.solver, options.threads, to_solve)
    moved, turns = posed_points(content, points, system, pose_named(content, pose))
    return in_pose(mesh, content, moved, turns)


def positioned(container: Container, content: Content, options: DecodeOptions) -> PolyMesh:
    """Return the mesh of a content, once its positions are solved for.

    Raises
    ------
    LimitError, SolveError
    """
    # Nobody else keeps the integers: what is no longer needed of them is freed on the way.
    handed_over = [content.integers]
    content = replace(content, integers=NOTHING.integers)
    points = points_at_rest(container, content.structure.surface, handed_over, options)
    return content.mesh(points, container.parameters.single, container.margin)


def points_at_rest(
    container: Container,
    surface: Surface,
    integers: list[Integers],
    options: DecodeOptions,
) -> Floats:
    """Return the positions of a file, float64 (p, 3); its integers are taken out of a list.

    Raises
    ------
    LimitError, SolveError
    """
    options.progress("positions")
    parameters, memory = container.parameters, memory_to_solve(container, options.memory)
    systems = Systems(surface, options.solver, options.threads, memory)
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
