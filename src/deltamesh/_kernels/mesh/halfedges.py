"""Kernels on half-edges. Half-edge h = 3 f + c runs from F[f, c] to F[f, (c + 1) % 3]."""

from __future__ import annotations

from deltamesh._kernels.jit import Int, inlined


@inlined
def next_halfedge(h: Int) -> Int:
    """Return the half-edge that follows in the same face."""
    return h - 2 if h % 3 == 2 else h + 1


@inlined
def previous_halfedge(h: Int) -> Int:
    """Return the half-edge that precedes in the same face."""
    return h + 2 if h % 3 == 0 else h - 1
