"""The table at the beginning of ATTR: what the attributes of a file are and how they are coded.

Plain bytes, so that programs can list attributes without decoding any. `read_table` and
`write_table` are mirrors; SPEC.md 5.14 has the fields.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np

from deltamesh_formats.container.container import Container
from deltamesh_formats.container.layout import ATTRIBUTES
from deltamesh_formats.container.reader import payload_of, read_varint, take
from deltamesh_formats.container.writer import write_varint
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import Domain, Role

Coding: TypeAlias = Literal["integer", "exact", "grid", "octahedral"]

DOMAINS: Final[tuple[Domain, ...]] = get_args(Domain)
ROLES: Final[tuple[Role, ...]] = get_args(Role)
CODINGS: Final[tuple[Coding, ...]] = get_args(Coding)
# Complex numbers are two real ones.
TYPES: Final = tuple(
    np.dtype(code)
    for code in ("?", "u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "f2", "f4", "f8", "c8", "c16")
)
# Surrogates, which stand for bytes of a name that was no UTF-8, are spelled like other code points.
_NAMES: Final = "surrogatepass"
# Of each coding, the kinds of types that it is for.
_FITTING: Final = {"integer": "bui", "exact": "fc", "grid": "f", "octahedral": "f"}

# Bits of the second byte.
_NORMALIZED, _PARTLY, _PALETTE, _MIXED, _CODING_AT, _FIRST_NONE = 1, 2, 4, 8, 4, 64
_CODING: Final = 3

# A residual of such numbers is below 2^30: its length ends with a bit of zero, so that no number of
# elements takes no bytes.
MAX_LIMB_BITS: Final = 29
MIN_NORMAL_BITS: Final = 2
MAX_NORMAL_BITS: Final = 30

# What the corners of an attribute are coded by, where it is not the classes of attribute k, k + 2.
OWN_CLASSES, FACES = 0, 1

_INTEGER: Final = struct.Struct("<QBB")
_F64: Final = struct.Struct("<d")


@dataclass(frozen=True)
class Entry:
    """One attribute of a file.

    Attributes
    ----------
    name : str
    domain, role, normalized
        As in `polymesh.Attribute`.
    dtype : numpy dtype, in the byte order of the machine
    width : int
        Numbers a row.
    coding : {"integer", "exact", "grid", "octahedral"}
    partly : bool
        Whether there are vertices, faces or classes of corners without a value.
    first_none : bool
        Whether the first of them has none.
    palette : int or None
        Number of different rows, where each element names one of these.
    mixed : bool
        Whether the second column is taken from the first and the third.
    classes : int
        Of an attribute of corners, what has values: classes of its own (0), faces (1), the classes
        of attribute k (k + 2).
    origin : tuple
        Of integers, one number; of a grid, one a column.
    bits : int
        Of integers, those of a limb; of a grid what was asked for, or 0; of normals, those of each
        of both coordinates.
    limbs : int
        Columns that a column of integers is cut into.
    density : float
        Grid points a unit.
    error : float
        The largest difference between a number and what becomes of it; of normals, the largest
        angle, in degrees.
    sizes : tuple of int
        Bytes of each stream: of the classes, of what elements have a value, of their rows in the
        palette, each if it is there; then of every three columns.
    """

    name: str
    domain: Domain
    role: Role
    dtype: np.dtype[Any]
    width: int
    normalized: bool
    coding: Coding
    partly: bool = False
    first_none: bool = False
    palette: int | None = None
    mixed: bool = False
    classes: int = OWN_CLASSES
    origin: tuple[float, ...] = ()
    bits: int = 0
    limbs: int = 1
    density: float = 0.0
    error: float = 0.0
    sizes: tuple[int, ...] = ()

    @property
    def numbers(self) -> int:
        """Real numbers a row."""
        return self.width * (2 if self.dtype.kind == "c" else 1)

    @property
    def number_size(self) -> int:
        """Bytes of a real number."""
        return self.dtype.itemsize // (2 if self.dtype.kind == "c" else 1)

    @property
    def columns(self) -> int:
        """Columns that are coded."""
        if self.coding == "octahedral":
            return 3
        return self.numbers * (self.limbs if self.coding == "integer" else 1)

    @property
    def streams(self) -> int:
        """Number of streams."""
        own = self.domain == "corner" and self.classes == OWN_CLASSES
        return own + self.partly + (self.palette is not None) + -(-self.columns // 3)

    @property
    def size(self) -> int:
        """Bytes of all streams."""
        return sum(self.sizes)


def write_table(entries: tuple[Entry, ...]) -> bytes:
    """Return the bytes of a table."""
    return write_varint(len(entries)) + b"".join(map(_written, entries))


def _written(e: Entry) -> bytes:
    name = e.name.encode(errors=_NAMES)
    flags = _NORMALIZED * e.normalized | _PARTLY * e.partly | _PALETTE * (e.palette is not None)
    flags |= _FIRST_NONE * e.first_none | _MIXED * e.mixed | CODINGS.index(e.coding) << _CODING_AT
    what = DOMAINS.index(e.domain) | ROLES.index(e.role) << 2 | TYPES.index(e.dtype) << 4
    parts = [write_varint(len(name)), name, bytes([what, flags]), write_varint(e.width)]
    if e.domain == "corner":
        parts.append(write_varint(e.classes))
    if e.palette is not None:
        parts.append(write_varint(e.palette))
    if e.coding == "integer":
        parts.append(_INTEGER.pack(int(e.origin[0]) % (1 << 64), e.bits, e.limbs))
    elif e.coding != "exact":
        parts += [bytes([e.bits]), _F64.pack(e.error)]
    if e.coding == "grid":
        parts += map(_F64.pack, (e.density, *e.origin))
    return b"".join([*parts, *map(write_varint, e.sizes)])


def entries_of(container: Container) -> tuple[Entry, ...]:
    """Return the attributes of a file, by its table; nothing is decoded.

    Raises
    ------
    FormatError
    """
    section = container.sections.get(ATTRIBUTES)
    if section is None:
        return ()
    with payload_of(section) as payload:
        return read_table(payload)[0]


def read_table(payload: bytes | memoryview) -> tuple[tuple[Entry, ...], int]:
    """Return the entries of a table, and where the streams begin.

    Raises
    ------
    FormatError
        With an offset from the beginning of the payload.
    """
    count, at = read_varint(payload, 0)
    entries: list[Entry] = []
    if not count:
        raise FormatError("a section of no attributes", 0)
    for _ in range(count):
        entry, at = _read(payload, at, entries)
        entries.append(entry)
    total = sum(entry.size for entry in entries)
    if total != len(payload) - at:
        raise FormatError(f"attributes of {total} bytes, where {len(payload) - at} are left", at)
    return tuple(entries), at


def _read(payload: bytes | memoryview, at: int, before: list[Entry]) -> tuple[Entry, int]:
    start = at
    length, at = read_varint(payload, at)
    try:
        name = bytes(take(payload, at, length)).decode(errors=_NAMES)
    except UnicodeDecodeError as error:
        raise FormatError("a name that is not UTF-8", at + error.start) from None
    at += length
    what, flags = take(payload, at, 2)
    domain, role, kind = what & 3, what >> 2 & 3, what >> 4
    if domain >= len(DOMAINS) or kind >= len(TYPES) or flags > 127:
        raise FormatError("an attribute of a kind that there is not", at)
    width, at = read_varint(payload, at + 2)
    fields: dict[str, Any] = {}
    if DOMAINS[domain] == "corner":
        fields["classes"], at = read_varint(payload, at)
    if flags & _PALETTE:
        fields["palette"], at = read_varint(payload, at)
    coding = CODINGS[flags >> _CODING_AT & _CODING]
    if coding == "integer":
        origin, bits, limbs = _INTEGER.unpack(take(payload, at, _INTEGER.size))
        fields |= {"origin": (origin,), "bits": bits, "limbs": limbs}
        at += _INTEGER.size
    elif coding != "exact":
        fields["bits"] = take(payload, at, 1)[0]
        (fields["error"],), at = _floats(payload, at + 1, 1)
    if coding == "grid":
        (fields["density"], *origins), at = _floats(payload, at, 1 + width)
        fields["origin"] = tuple(origins)
    entry = Entry(
        *(
            name,
            DOMAINS[domain],
            ROLES[role],
            TYPES[kind],
            width,
            bool(flags & _NORMALIZED),
            coding,
        ),
        partly=bool(flags & _PARTLY),
        first_none=bool(flags & _FIRST_NONE),
        mixed=bool(flags & _MIXED),
        **fields,
    )
    fault = _fault(entry) or _fault_of_classes(entry, before)
    if fault:
        raise FormatError(f"attribute {len(before)}: {fault}", start)
    if entry.streams > len(payload) - at:
        raise FormatError("truncated: the sizes of an attribute's streams", len(payload))
    sizes = []
    for _ in range(entry.streams):
        size, at = read_varint(payload, at)
        sizes.append(size)
    return Entry(**{**vars(entry), "sizes": tuple(sizes)}), at


def _floats(payload: bytes | memoryview, at: int, count: int) -> tuple[tuple[float, ...], int]:
    if count > (len(payload) - at) // 8:
        raise FormatError("truncated: the numbers of an attribute", len(payload))
    return struct.unpack_from(f"<{count}d", payload, at), at + 8 * count


def _fault(e: Entry) -> str:
    """Tell what is wrong with an entry by the rules of SPEC.md 5.14; else ""."""
    if e.dtype.kind not in _FITTING[e.coding]:
        return f"numbers of type {e.dtype} coded as {e.coding}"
    if e.mixed and (e.coding not in ("integer", "grid") or e.width < 3 or e.limbs > 1):
        return "columns that cannot be taken from each other"
    if e.coding == "integer":
        fits = 1 <= e.bits <= MAX_LIMB_BITS and 1 <= e.limbs <= -(-64 // e.bits)
        return "" if fits else f"{e.limbs} limbs of {e.bits} bits"
    if e.coding == "octahedral":
        fits = e.width == 3 and MIN_NORMAL_BITS <= e.bits <= MAX_NORMAL_BITS
        if not fits or e.palette is not None:
            return f"normals of {e.width} numbers and {e.bits} bits"
    if not all(map(math.isfinite, (e.error, e.density, *e.origin))):
        return "a grid that is not finite"
    if e.error < 0 or (e.coding == "grid" and not e.density > 0):
        return f"a grid of {e.density} points a unit and an error of {e.error}"
    return ""


def _fault_of_classes(e: Entry, before: list[Entry]) -> str:
    if e.palette == 0 or (e.first_none and not e.partly):
        return "nothing where there should be something"
    if e.domain != "corner" or e.classes <= FACES:
        return ""
    other = e.classes - 2
    own = other < len(before) and before[other].domain == "corner"
    if own and before[other].classes == OWN_CLASSES:
        return ""
    return f"corners that go by attribute {other}"
