"""Section ATTR: attributes to a payload, and back; SPEC.md 5.14.

Each attribute is coded in all codings that suit its type and its role, and the smallest is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.candidates import AttributeSettings, candidate_codings
from deltamesh._attributes.codings import from_codes, margin_of, to_codes
from deltamesh._attributes.domains import Domains
from deltamesh._attributes.normals.coding import (
    Normals,
    decode_attribute_normals,
    encode_attribute_normals,
    surroundings_of,
    vectors_of,
)
from deltamesh._attributes.owners import Owners, decode_owners, encode_owners
from deltamesh._attributes.rows import Rows, decode_rows, encode_rows
from deltamesh._shape.provenance import Provenance
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.attribute_entry import Entry
from deltamesh_formats.container.attribute_table import read_table, write_table
from deltamesh_formats.container.payload_layout import OWN_WEDGES
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

_Any = NDArray[Any]


@dataclass(frozen=True)
class CodedAttribute:
    """The integers of an attribute, as encoder and decoder both know them.

    Attributes
    ----------
    entry : Entry
    owner : int64 (count,)
        The owner of each element of the domain: the element itself or, of a corner, its wedge or
        polygon.
    wedges : int64 (3 m,) or None
        The wedge of each corner of the triangles, where wedges are the owners.
    has : bool (owners,)
        Whether an owner has a value.
    labels : int64 (values,)
        The row of each owner that has a value.
    codes : int64 (rows, columns)
    normals : Normals or None
        The prediction of the codes, where the coding is octahedral; each owner has a row then.
    """

    entry: Entry
    owner: Ints
    wedges: Ints | None
    has: Bools
    labels: Ints
    codes: Ints
    normals: Normals | None = None

    @property
    def arrays(self) -> tuple[Ints, ...]:
        """The arrays that the digest of a file covers."""
        return self.owner, self.has.astype(np.int64), self.labels, self.codes

    @property
    def own_wedges(self) -> Ints | None:
        """The wedges, unless those of an attribute before serve."""
        return self.wedges if self.entry.wedges == OWN_WEDGES else None


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def encode_attributes(
    mesh: PolyMesh, provenance: Provenance, domains: Domains, settings: AttributeSettings
) -> tuple[bytes, tuple[CodedAttribute, ...]]:
    """Return the payload of ATTR, and the attributes as they are decoded.

    Parameters
    ----------
    mesh : PolyMesh
        With attributes.
    provenance : Provenance
        Of the elements of the file.
    domains : Domains
    settings : AttributeSettings
    """
    p = provenance
    inputs = {"vertex": p.vertices, "corner": p.corners, "face": p.polygons}
    coded: list[CodedAttribute] = []
    payload: list[bytes] = []
    for attribute in mesh.attributes:
        rows, of_elements = _used_rows(attribute.rows()[inputs[attribute.domain]])
        values = _native(attribute.values[rows])
        encoder = _Encoder(values, of_elements, domains, settings, [c.own_wedges for c in coded])
        candidates = map(encoder.encode, candidate_codings(attribute, values, settings))
        within = (c for c in candidates if c[0].entry.error <= settings.error_of(attribute))
        one, streams = min(within, key=lambda candidate: candidate[0].entry.size)
        coded.append(one)
        payload += streams
    return write_table(tuple(one.entry for one in coded)) + b"".join(payload), tuple(coded)


def _used_rows(of_elements: Ints) -> tuple[Ints, Ints]:
    """Return the rows that elements use, and the index of that of each element, -1 for none."""
    used, compact = np.unique(of_elements, return_inverse=True)
    nothing = int(len(used) > 0 and used[0] < 0)
    return used[nothing:], compact - nothing


def _native(values: _Any) -> _Any:
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))


class _Encoder:
    """Encoder of one attribute, which has its owners coded once for all candidate codings.

    Parameters
    ----------
    values : (r, width)
        The different rows that elements use.
    of_elements : int64 (count,)
        The row of each element, -1 for none.
    domains : Domains
    settings : AttributeSettings
    earlier : list of int64 (3 m,) or None
        Of each attribute before, the wedges of its own.
    """

    def __init__(
        self,
        values: _Any,
        of_elements: Ints,
        domains: Domains,
        settings: AttributeSettings,
        earlier: list[Ints | None],
    ) -> None:
        self.values, self.of_elements = values, of_elements
        self.domains, self.settings, self.earlier = domains, settings, earlier
        self._owners: dict[bytes, Owners] = {}

    def encode(self, entry: Entry) -> tuple[CodedAttribute, list[bytes]]:
        """Return the attribute in one coding, and its streams."""
        codes = to_codes(entry, self.values)
        first_equal = np.append(_first_equal(codes), -1)
        owners = self._owners_of(entry, first_equal)
        rows = owners.rows(first_equal[self.of_elements])[owners.has]
        has, partly = owners.has, not owners.has.all()
        entry = replace(
            entry, wedges=owners.reference, partly=partly, first_none=partly and not has[0]
        )
        normals = None
        if entry.coding == "octahedral":
            around = surroundings_of(entry, owners.of_elements, len(has), self.domains)
            s = self.settings
            entry, normals, stream = encode_attribute_normals(
                *(entry, self.values[rows], has, owners.elements, around),
                *(s.positions, s.tolerance),
            )
            coded, own = Rows(np.flatnonzero(has), normals.codes), [stream]
        else:
            entry, coded, own = encode_rows(entry, codes, rows, owners)
        streams = [*owners.streams, *own]
        entry = replace(entry, sizes=tuple(map(len, streams)))
        return _coded(entry, owners, coded, normals), streams

    def _owners_of(self, entry: Entry, first_equal: Ints) -> Owners:
        """Return the owners, which depend on nothing of a coding but which rows are equal."""
        key = first_equal.tobytes()
        if key not in self._owners:
            rows = first_equal[self.of_elements]
            self._owners[key] = encode_owners(entry, rows, self.domains, self.earlier)
        return self._owners[key]


def _first_equal(codes: Ints) -> Ints:
    """Return the first row that equals each row of codes (r, c)."""
    if not codes.size:
        return np.zeros(len(codes), np.int64)
    keys = np.ascontiguousarray(codes).view(f"V{codes.shape[1] * 8}").ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return np.asarray(first[inverse])


def _coded(entry: Entry, owners: Owners, rows: Rows, normals: Normals | None) -> CodedAttribute:
    o = owners
    return CodedAttribute(entry, o.of_elements, o.wedges, o.has, rows.labels, rows.codes, normals)


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def decode_attributes(payload: memoryview, domains: Domains) -> tuple[CodedAttribute, ...]:
    """Return the attributes of a payload: the mirror of `encode_attributes`.

    Raises
    ------
    FormatError
        If no encoder has written it; the offset counts from its beginning.
    """
    entries, at = read_table(payload)
    coded: list[CodedAttribute] = []
    for entry in entries:
        streams = list(pairwise(accumulate(entry.sizes, initial=at)))
        owners = decode_owners(payload, streams, entry, domains, [c.own_wedges for c in coded])
        normals = None
        if entry.coding == "octahedral":
            normals = decode_attribute_normals(payload, streams[0], entry, owners.elements)
            rows = Rows(np.flatnonzero(owners.has), normals.codes)
        else:
            rows = decode_rows(payload, streams, entry, owners, at)
        coded.append(_coded(entry, owners, rows, normals))
        at += entry.size
    return tuple(coded)


# Any bits may be numbers, those of a signalling NaN too.
@np.errstate(over="ignore", invalid="ignore")
def restore_attribute(coded: CodedAttribute, domains: Domains, V: Floats) -> Attribute:
    """Return the attribute, of vertices and polygons without an index where all have a value.

    Parameters
    ----------
    coded : CodedAttribute
    domains : Domains
    V : float64 (n, 3)
        Decoded positions of the vertices.
    """
    e, has = coded.entry, coded.has
    if coded.normals is None:
        values = from_codes(e, coded.codes)
    else:
        around = surroundings_of(e, coded.owner, len(has), domains)
        values = vectors_of(coded.normals, V, around).astype(e.dtype)
    row = np.full(len(has), -1, dtype=np.int64)
    row[has] = coded.labels
    index = row[coded.owner]
    if e.domain == "corner" or not has.all():
        return Attribute(e.name, e.domain, values, e.role, index, e.normalized, margin_of(e))
    return Attribute(
        e.name, e.domain, values[index], e.role, normalized=e.normalized, margin=margin_of(e)
    )
