"""Owners of the values of an attribute: vertices, polygons, or wedges, and which have a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from deltamesh._attributes.domains import Domains
from deltamesh._attributes.wedges import decode_wedges, encode_wedges
from deltamesh._graph.elements import Elements, of_wedges
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.payload_layout import OWN_WEDGES, POLYGON_OWNERS, WEDGES_OF
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.polymesh.permutations import numbered


@dataclass(frozen=True)
class Owners:
    """Elements that own the values of an attribute.

    Attributes
    ----------
    of_elements : int64 (count,)
        The owner of each element of the domain.
    elements : Elements
        The owners, and their neighbours.
    has : bool (owners,)
        Whether an owner has a value.
    wedges : int64 (3 m,) or None
        The wedge of each corner of the triangles, where wedges are the owners.
    reference : int
        As `Entry.wedges`.
    streams : tuple of bytes
        The coded wedges and the coded presence of values, each if there is one.
    """

    of_elements: Ints
    elements: Elements
    has: Bools
    wedges: Ints | None = None
    reference: int = OWN_WEDGES
    streams: tuple[bytes, ...] = ()

    def rows(self, of_elements: Ints) -> Ints:
        """Return the row of each owner, from those of the elements."""
        rows = np.empty(self.elements.count, dtype=np.int64)
        rows[self.of_elements] = of_elements
        return rows


def encode_owners(
    entry: Entry, rows: Ints, domains: Domains, earlier: Sequence[Ints | None]
) -> Owners:
    """Return the owners of the values of elements with these rows.

    Parameters
    ----------
    entry : Entry
    rows : int64 (count,)
        -1 for an element without a value.
    domains : Domains
    earlier : sequence of int64 (3 m,) or None
        Of each attribute before, the wedges of its own; corners with the same wedges refer to them.
    """
    owners = _owners(entry, rows, domains, earlier)
    has = owners.rows(rows) >= 0
    if has.all():
        return owners
    presence = encode_labels(owners.elements, numbered(has.astype(np.int64))[0])
    return replace(owners, has=has, streams=(*owners.streams, presence))


def decode_owners(
    payload: memoryview,
    streams: list[tuple[int, int]],
    entry: Entry,
    domains: Domains,
    earlier: Sequence[Ints | None],
) -> Owners:
    """Return the owners: the mirror of `encode_owners`.

    Their streams, the first ones, are removed from the list.

    Raises
    ------
    FormatError
    """
    start = streams[0][0] if streams else 0
    owners = _known_owners(entry, domains)
    if owners is None:
        if entry.wedges == OWN_WEDGES:
            wedges = _own_wedges(payload, streams.pop(0), domains)
        else:
            shared = earlier[entry.wedges - WEDGES_OF]
            assert shared is not None  # by the rules of the table
            wedges = shared
        owners = _of_wedges(wedges, domains, entry.wedges)
    if not entry.partly:
        return owners
    begin, end = streams.pop(0)
    with located(begin):
        labels = decode_labels(payload[begin:end], owners.elements)
    if labels.max(initial=0) > 1:
        raise FormatError("presence label above 1", start)
    return replace(owners, has=(labels == 1) == entry.first_none)


def _owners(entry: Entry, rows: Ints, domains: Domains, earlier: Sequence[Ints | None]) -> Owners:
    if entry.domain == "corner":
        first = domains.polygons.offsets[:-1]
        per_polygon = (rows == rows[first][domains.polygon_of_corners]).all()
        entry = replace(entry, wedges=POLYGON_OWNERS if per_polygon else OWN_WEDGES)
    known = _known_owners(entry, domains)
    if known is not None:
        return known
    stream, wedges = encode_wedges(domains.structure, domains.polygons, rows + 1)
    for k, other in enumerate(earlier):
        if other is not None and np.array_equal(other, wedges):
            return _of_wedges(wedges, domains, k + WEDGES_OF)
    return replace(_of_wedges(wedges, domains, OWN_WEDGES), streams=(stream,))


def _known_owners(entry: Entry, domains: Domains) -> Owners | None:
    """Return vertices or polygons as owners, None where wedges are."""
    if entry.domain == "corner":
        if entry.wedges != POLYGON_OWNERS:
            return None
        of_elements, elements, reference = domains.polygon_of_corners, domains.faces, POLYGON_OWNERS
    else:
        elements = domains.vertices if entry.domain == "vertex" else domains.faces
        of_elements, reference = np.arange(elements.count), OWN_WEDGES
    return Owners(of_elements, elements, np.ones(elements.count, bool), reference=reference)


def _own_wedges(payload: memoryview, stream: tuple[int, int], domains: Domains) -> Ints:
    begin, end = stream
    wedges = decode_wedges(payload, begin, end, domains.structure)
    p = domains.polygons
    if (wedges[p.corners][p.of_corners] != wedges).any():
        raise FormatError("corner of a polygon in two wedges", begin)
    return wedges


def _of_wedges(wedges: Ints, domains: Domains, reference: int) -> Owners:
    elements = of_wedges(wedges)
    of_elements = wedges[domains.polygons.corners]
    return Owners(of_elements, elements, np.ones(elements.count, bool), wedges, reference)
