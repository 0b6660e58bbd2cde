"""Limits of a decoder: what a file announces is refused before anything is allocated."""

from __future__ import annotations

from dataclasses import replace

import pytest
from containers import CARTESIAN, HIGHPASS, PAYLOADS

from deltamesh._limits import (
    DEFAULT_MAX_VERTICES,
    DEFAULT_MEMORY,
    Counts,
    check_limits,
    filling,
    memory_for_counts,
    memory_needed,
)
from deltamesh._methods import INTERPOLATED, LEAST_SQUARES
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import CHECK, FILLING
from deltamesh_formats.container.payload_layout import MAX_ELEMENTS_PER_BYTE
from deltamesh_formats.errors import FormatError, LimitError


def file_of(vertices: int, triangles: int, **payloads: bytes) -> Container:
    parameters = replace(CARTESIAN, isolated=0)
    payloads = PAYLOADS["cartesian"] | payloads
    return build_container(vertices, triangles, parameters, payloads, None, bytes(8))


def check(
    container: Container,
    counts: Counts,
    max_vertices: int = DEFAULT_MAX_VERTICES,
    memory: int = DEFAULT_MEMORY,
) -> None:
    check_limits(container, counts, max_vertices, memory)


def test_a_file_within_the_limits_passes() -> None:
    container = file_of(100, 196)
    check(container, Counts(100, 0, 100, 196))
    check(container, Counts(100, 0, 100, 196), 100, memory_needed(container))


def test_more_vertices_or_memory_than_allowed_are_refused() -> None:
    container = file_of(100, 196)
    with pytest.raises(LimitError, match="100 vertices are more than the limit of 99"):
        check(container, Counts(100, 0, 100, 196), 99)
    needed = memory_needed(container)
    with pytest.raises(LimitError, match=f"about {needed} bytes, more than the limit"):
        check(container, Counts(100, 0, 100, 196), memory=needed - 1)


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        (Counts(100, 0, 99, 196), "99 vertices and 196 faces of the manifold for 100 points"),
        (Counts(100, 0, 589, 196), "589 vertices and 196 faces of the manifold for 100 points"),
        (Counts(100, 1, 98, 196), "98 vertices and 196 faces of the manifold for 99 points"),
    ],
)
def test_counts_that_contradict_each_other_are_refused(counts: Counts, message: str) -> None:
    with pytest.raises(FormatError, match=message) as caught:
        check(file_of(100, 196), counts)
    assert caught.value.offset == file_of(100, 196).sections["CONN"].offset


def test_a_mesh_without_triangles_is_refused() -> None:
    with pytest.raises(FormatError, match="a mesh of 0 triangles"):
        check(file_of(3, 0), Counts(3, 0, 3, 0))


def test_more_elements_than_the_bytes_of_a_section_hold_are_refused() -> None:
    most = MAX_ELEMENTS_PER_BYTE * (1 + 4)
    check(file_of(10, most, CONN=b"c"), Counts(10, 0, 10, most), memory=2**60)
    with pytest.raises(FormatError, match=f"CONN: {most + 1} faces of the manifold do not fit"):
        check(file_of(10, most + 1, CONN=b"c"), Counts(10, 0, 10, most + 1), memory=2**60)
    cart = MAX_ELEMENTS_PER_BYTE * (4 + 4)
    with pytest.raises(FormatError, match=f"CART: {cart + 1} isolated vertices do not fit"):
        check(file_of(cart + 4, 4, CART=b"four"), Counts(cart + 4, cart + 1, 3, 4), memory=2**60)


def test_bytes_that_are_lacking_are_filled_with_zeros_and_no_more() -> None:
    m = MAX_ELEMENTS_PER_BYTE * 8
    counts = Counts(10, 0, 10, m)
    assert filling(file_of(10, m, CONN=b"c"), counts) == 3
    check(file_of(10, m, CONN=b"c", FILL=bytes(3)), counts, memory=2**60)
    for fill, message in (
        (bytes(2), "do not fit into 1 bytes and 2 of FILL"),
        (bytes(4), "FILL: 4 bytes where 3 are lacking"),
        (b"\0\1\0", "FILL: a byte that is not zero"),
    ):
        with pytest.raises(FormatError, match=message):
            check(file_of(10, m, CONN=b"c", FILL=fill), counts, memory=2**60)
    with pytest.raises(FormatError, match="FILL: 0 bytes where 0 are lacking"):
        check(file_of(10, 20, FILL=b""), Counts(10, 0, 10, 20))


def test_a_prefix_that_lacks_bytes_is_refused_until_they_have_come() -> None:
    m = MAX_ELEMENTS_PER_BYTE * 8
    counts, whole = Counts(10, 0, 10, m), file_of(10, m, CONN=b"c", FILL=bytes(3))
    sections = {name: one for name, one in whole.sections.items() if name != CHECK}
    check(replace(whole, sections=sections), counts, memory=2**60)
    del sections[FILLING]
    with pytest.raises(FormatError, match="fit into 1 bytes, and FILL has not come"):
        check(replace(whole, sections=sections), counts, memory=2**60)


def test_sections_bound_what_they_add() -> None:
    n, m = 10**6, 10**6
    counts = Counts(n - 400_000, 0, n - 400_000, m - 400_000)
    container = file_of(n, m, CONN=bytes(100), STCH=b"stitches", COPY=b"copies")
    with pytest.raises(FormatError, match="STCH: 400000 faces beyond the manifold"):
        check(container, counts)
    container = file_of(n, m, CONN=bytes(100), STCH=bytes(100), COPY=b"copies")
    with pytest.raises(FormatError, match="COPY: 400000 vertices beyond the points"):
        check(container, counts)


def test_memory_grows_with_what_is_there() -> None:
    base = memory_needed(file_of(1000, 2000))
    assert memory_needed(file_of(2000, 2000)) > base
    assert memory_needed(file_of(1000, 4000)) > base
    assert memory_needed(file_of(1000, 2000, POLY=b"?")) > base
    assert memory_for_counts(1000, 2000) >= base
    assert memory_for_counts(2000, 2000) > memory_for_counts(1000, 2000)


def anchored_file(vertices: int, *, interpolated: bool) -> Container:
    parameters = replace(HIGHPASS, isolated=0, interpolated=interpolated)
    payloads = PAYLOADS["highpass"] | {"CONN": bytes(vertices // 8), "DELT": bytes(vertices // 8)}
    return build_container(vertices, 2 * vertices, parameters, payloads, None, bytes(8))


def test_interpolated_anchors_take_less_memory_than_least_squares() -> None:
    for n in (1000, 10**6):
        ours, papers = (memory_needed(anchored_file(n, interpolated=i)) for i in (True, False))
        fixed = LEAST_SQUARES.fixed - INTERPOLATED.fixed
        assert papers - ours == fixed + n * (LEAST_SQUARES.per_vertex - INTERPOLATED.per_vertex)
        assert ours < papers < memory_for_counts(n, 2 * n) + 1


def test_ten_million_vertices_are_within_the_default_limits() -> None:
    n = 10**7
    counts = Counts(n, 0, n, 2 * n)
    check(anchored_file(n, interpolated=True), counts)
    with pytest.raises(LimitError, match="more than the limit"):
        check(anchored_file(n, interpolated=False), counts)
