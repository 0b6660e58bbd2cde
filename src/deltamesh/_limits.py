"""Limits of decoding, checked before anything of that size is allocated."""

from __future__ import annotations

from dataclasses import dataclass

from deltamesh._methods import INTERPOLATED, LEAST_SQUARES, METHODS, Memory
from deltamesh_formats.container.container import Container, Parameters
from deltamesh_formats.container.layout import (
    ATTRIBUTES,
    CONNECTIVITY,
    FILLING,
    FRAMES,
    POLYGONS,
    POSES,
    SPLIT_VERTICES,
    STITCHES,
)
from deltamesh_formats.container.payload_layout import MAX_ELEMENTS_PER_BYTE
from deltamesh_formats.container.pose_table import entries_of as entries_of_poses
from deltamesh_formats.container.texts import text_size, texts_of
from deltamesh_formats.errors import FormatError, LimitError
from deltamesh_formats.wrappers import DEFAULT_LIMIT

# The vertices that a 32-bit index can name, were there memory for them.
DEFAULT_MAX_VERTICES = 1 << 32
DEFAULT_MEMORY = DEFAULT_LIMIT

# Bytes beside those of the method, measured as these are: half-edges and fronts.
PER_FACE = 120
PER_TEXT_BYTE = 24
PER_TRANSFORM = 400
PER_GLUED_FACE = 240  # more, where polygons are made of triangles
# Of attributes: an element, and each number of one; three of them share a stream. Unit normals need
# those of the surface, corner by corner.
PER_ELEMENT = 160
PER_NUMBER = 40
# Of further frames, a vertex: the frame before, what it predicts, and the maps of the vertices.
PER_MOVED_VERTEX = 600
# Of poses: their tree, and the motions of each.
PER_TREE_VERTEX = 320
PER_MOTION = 160

# Bytes that solvers take of the memory of a method, whatever the mesh.
SOLVER = 16 << 20
# The encoder writes no file whose decoder would take more than this many times what is declared.
# All surfaces that were measured stay below 1, with any solver, and a small solid of 21^3 points
# below 2.
MOST_DECLARED = 2


@dataclass(frozen=True)
class Counts:
    """Counts that a file announces, before anything of it is decoded.

    Attributes
    ----------
    points : int
        Positions; several vertices may share one.
    isolated : int
        Points that are in no face of the manifold.
    vertices, faces : int
        Of the manifold that CONN describes.
    """

    points: int
    isolated: int
    vertices: int
    faces: int


def memory_needed(container: Container) -> int:
    """Estimate the memory that decoding takes, in bytes, without decoding anything.

    Raises
    ------
    FormatError
        If the attribute table, the text of the parts or the table of poses is malformed.
    """
    moved = sum(len(one.names) for one in texts_of(container).divisions if one.moved)
    return _memory_of_counts(container) + PER_TRANSFORM * moved


def _memory_of_counts(container: Container) -> int:
    """Estimate the memory without the transforms, whose text is not unpacked yet."""
    memory = _memory_of_geometry(container.parameters)
    per_face = PER_FACE + (PER_GLUED_FACE if POLYGONS in container.sections else 0)
    needed = memory.fixed + memory.per_vertex * container.vertices
    needed += per_face * container.triangles
    if FRAMES in container.sections:
        needed += PER_MOVED_VERTEX * container.vertices
    needed += _memory_of_attributes(container) + PER_TEXT_BYTE * text_size(container)
    return needed + _memory_of_poses(container)


def _memory_of_geometry(parameters: Parameters) -> Memory:
    by_solution = INTERPOLATED if parameters.interpolated else LEAST_SQUARES
    return METHODS[parameters.method].memory or by_solution


def _memory_of_attributes(container: Container) -> int:
    if ATTRIBUTES not in container.sections:
        return 0
    from deltamesh_formats.container.attribute_table import entries_of  # which needs numpy

    n, m = container.vertices, container.triangles
    counts = {"vertex": n, "corner": 3 * m, "face": m}
    needed = 0
    for entry in entries_of(container):
        columns = 3 * -(-entry.columns // 3)
        count = counts["corner" if entry.coding == "octahedral" else entry.domain]
        needed += count * (PER_ELEMENT + PER_NUMBER * columns)
    return needed


def _memory_of_poses(container: Container) -> int:
    if POSES not in container.sections:
        return 0
    motions = len(entries_of_poses(container)) * container.parameters.anchor_count
    return PER_TREE_VERTEX * container.vertices + PER_MOTION * motions


def check_pose(container: Container, memory: int) -> int:
    """Return the bytes that a solver of poses may take of all that decoding a file may take.

    Poses are solved for by least squares, beside what decodes the surface at rest.

    Raises
    ------
    LimitError
        If a pose would take more memory than allowed.
    FormatError
        If a table or a text of the file is malformed.
    """
    solving = LEAST_SQUARES.per_vertex * container.vertices
    needed = memory_needed(container) + LEAST_SQUARES.fixed + solving
    _check_memory(needed, memory)
    return SOLVER + solving + memory - needed


def memory_to_solve(container: Container, memory: int) -> int:
    """Return the bytes that a solver may take of all that decoding a file may take."""
    per_vertex = _memory_of_geometry(container.parameters).per_vertex
    return SOLVER + per_vertex * container.vertices + memory - memory_needed(container)


def memory_to_encode(vertices: int) -> int:
    """Return the bytes that a solver may take of the encoder, and of any decoder after it."""
    declared = LEAST_SQUARES.fixed + LEAST_SQUARES.per_vertex * vertices
    return MOST_DECLARED * declared - LEAST_SQUARES.fixed


def memory_for_counts(vertices: int, faces: int) -> int:
    """Estimate the memory that encoding or decoding takes, in bytes, by the dearest method."""
    kinds = [LEAST_SQUARES, *(one.memory for one in METHODS.values() if one.memory)]
    fixed, per_vertex = max(one.fixed for one in kinds), max(one.per_vertex for one in kinds)
    return fixed + per_vertex * vertices + PER_FACE * faces


def check_limits(container: Container, counts: Counts, max_vertices: int, memory: int) -> None:
    """Refuse a file whose counts are above the limits, or cannot be true.

    Raises
    ------
    LimitError
        For more vertices, or more memory, than allowed.
    FormatError
        For no faces, or more elements than the bytes of a section can hold.
    """
    n, m = container.vertices, container.triangles
    if n > max_vertices:
        raise LimitError(f"{n} vertices are more than the limit of {max_vertices}")
    section, used = container.sections[CONNECTIVITY], counts.points - counts.isolated
    if m == 0:
        raise FormatError("a mesh of 0 triangles", section.offset)
    if not used <= counts.vertices <= 3 * counts.faces:
        manifold = f"{counts.vertices} vertices and {counts.faces} faces of the manifold"
        raise FormatError(f"{manifold} for {used} points", section.offset)
    _check_filling(container, counts)
    _check_memory(_memory_of_counts(container), memory)
    _check_memory(memory_needed(container), memory)


def _check_memory(needed: int, memory: int) -> None:
    if needed > memory:
        raise LimitError(f"decoding takes about {needed} bytes, more than the limit of {memory}")


def filling(container: Container, counts: Counts) -> int:
    """Return how many bytes FILL must have, for there to be enough for the elements (SPEC.md 5.18).

    The last bits of a stream may take none, however many they are: this, not the entropy coder, is
    what bounds the elements of a small file.
    """
    return sum(held.lacking for held in _held(container, counts))


@dataclass(frozen=True)
class _Held:
    """Elements that a section has, each of one bit or more.

    Attributes
    ----------
    section : str
    what : str
        The name of the elements.
    size : int
        Bytes of the section.
    count : int
    bits : int
        The least number of bits of an element.
    """

    section: str
    what: str
    size: int
    count: int
    bits: int = 1

    @property
    def lacking(self) -> int:
        """Bytes that the section has too few."""
        return max(0, -(-self.bits * self.count // MAX_ELEMENTS_PER_BYTE) - self.size - 4)


def _held(container: Container, counts: Counts) -> tuple[_Held, ...]:
    sizes = {name: len(section.payload) for name, section in container.sections.items()}
    method = METHODS[container.parameters.method].layout
    first, bits = method.geometry[0], 3 if method.exact else 1  # a coordinate has one or more
    beyond, more = container.triangles - counts.faces, container.vertices - counts.points
    return (
        _Held(CONNECTIVITY, "faces of the manifold", sizes[CONNECTIVITY], counts.faces),
        _Held(first, "isolated vertices", sizes[first], counts.isolated, bits),
        _Held(STITCHES, "faces beyond the manifold", sizes.get(STITCHES, 0), beyond),
        _Held(SPLIT_VERTICES, "vertices beyond the points", sizes.get(SPLIT_VERTICES, 0), more),
    )


def _check_filling(container: Container, counts: Counts) -> None:
    """Refuse a file that has not exactly the bytes that its elements need."""
    lacking, section = filling(container, counts), container.sections.get(FILLING)
    size = 0 if section is None else len(section.payload)
    if lacking > size:
        held = next(held for held in _held(container, counts) if held.lacking)
        room = f"{held.size} bytes" + (f" and {size} of {FILLING}" if section is not None else "")
        room += "" if container.is_whole else f", and {FILLING} has not come"
        message = f"{held.section}: {held.count} {held.what} do not fit into {room}"
        raise FormatError(message, container.sections[held.section].offset)
    if section is None:
        return
    if lacking < size or size == 0:
        message = f"{FILLING}: {size} bytes where {lacking} are lacking"
        raise FormatError(message, section.offset)
    if bytes(section.payload).strip(b"\0"):
        raise FormatError(f"{FILLING}: a byte that is not zero", section.offset)
