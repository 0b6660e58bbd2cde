"""What decoding a file may take; checked before anything of that size is allocated."""

from __future__ import annotations

from deltamesh_formats.errors import FormatError, LimitError
from deltamesh_formats.layout import Container

# As many as a 32-bit index can name, were there memory for them.
DEFAULT_MAX_VERTICES = 1 << 32
DEFAULT_MEMORY = 16 << 30

# Bytes, measured as peak memory of whole processes over the counts (`benchmarks/memory.py`), and
# rounded up: faces, half-edges and fronts; coder tables; factorization and its solves.
BASE = {
    "cartesian": 192 << 20,
    "lossless": 256 << 20,
    "highpass": 256 << 20,
    "refined": 256 << 20,
}
PER_FACE = 320
PER_VERTEX = {"cartesian": 400, "lossless": 600, "highpass": 4000, "refined": 4000}

# The range coder spends at least log2(65536 / (65536 - P_MIN)) bits on a bit, and at least one
# bit on each vertex or face: a file of b bytes cannot hold more of them than that.
PER_BYTE = 15200


def memory_needed(container: Container) -> int:
    """Estimate the memory that decoding takes, in bytes, from counts alone."""
    method = container.parameters.method
    fixed, per_vertex = BASE[method], PER_VERTEX[method]
    return fixed + per_vertex * container.vertices + PER_FACE * container.faces


def check_limits(container: Container, max_vertices: int, memory: int) -> None:
    """Refuse a file whose counts are above the limits, or cannot be true.

    Raises
    ------
    LimitError
        For more vertices, or more memory, than allowed.
    FormatError
        For none or more faces, or more isolated vertices, than the bytes of a section can hold.
    """
    n, m = container.vertices, container.faces
    if n > max_vertices:
        raise LimitError(f"{n} vertices are more than the limit of {max_vertices}")
    section = container.sections["CONN"]
    if m == 0:
        raise FormatError("a file without faces", section.offset)
    if m > PER_BYTE * (len(section.payload) + 4) or n - container.parameters.isolated > 3 * m:
        raise FormatError(f"{n} vertices and {m} faces do not fit into this file", section.offset)
    _check_isolated(container)
    needed = memory_needed(container)
    if needed > memory:
        raise LimitError(f"decoding takes about {needed} bytes, more than the limit of {memory}")


def _check_isolated(container: Container) -> None:
    method = container.parameters.method
    name = {"cartesian": "CART", "lossless": "EXAC"}.get(method, "ANCH")
    section, count = container.sections[name], container.parameters.isolated
    bits = 3 * count if method == "lossless" else count  # one a coordinate
    if bits > PER_BYTE * (len(section.payload) + 4):
        raise FormatError(f"{count} isolated vertices do not fit into this file", section.offset)
