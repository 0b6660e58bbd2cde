"""hypothesis strategies for meshes as files have them, and what is compared of two of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

ROLES = {"normal": "normal", "uv": "uv", "colour": "colour"}

# Names have spaces, slashes, any letters, but no ends of lines, and none at either end.
names = st.text(st.characters(exclude_categories=["C", "Z"]) | st.just(" "), min_size=1).filter(
    lambda name: name == name.strip() and len(name.encode()) < 200
)
comments = st.lists(names.map(lambda name: " " + name) | st.just(""), max_size=3).map(tuple)
words = st.from_regex(r"[a-z]{4,8}", fullmatch=True).filter(
    lambda word: word not in {"alpha", "green", "blue", "texcoord", *ROLES}
)


@dataclass(frozen=True)
class Kind:
    """What attributes a format holds."""

    domain: str
    types: tuple[str, ...]
    widths: tuple[int, ...]
    name: str = ""  # any, when empty
    partly: bool = False  # some elements may have none


def _numbers(draw: st.DrawFn, dtype: str, shape: tuple[int, int]) -> np.ndarray:
    elements = {"allow_subnormal": False} if dtype[0] == "f" else {}
    return draw(nps.arrays(dtype, shape, elements=nps.from_dtype(np.dtype(dtype), **elements)))


@st.composite
def attributes(draw: st.DrawFn, kind: Kind, count: int, name: str) -> Attribute:
    dtype, width = draw(st.sampled_from(kind.types)), draw(st.sampled_from(kind.widths))
    index, rows = None, count
    if kind.domain == "corner" and draw(st.booleans()):
        rows = draw(st.integers(1, 4))
        index = np.array(draw(st.lists(st.integers(0, rows - 1), min_size=count, max_size=count)))
    if kind.partly and draw(st.booleans()):
        has = np.array(draw(st.lists(st.booleans(), min_size=count, max_size=count)))
        has[0] = True
        if index is None:
            index, rows = np.where(has, np.cumsum(has) - 1, -1), int(has.sum())
        else:
            index = np.where(has, index, -1)
    values = _numbers(draw, dtype, (rows, width))
    role = ROLES.get(name, "other")
    normalized = role == "colour" and dtype[0] == "u"
    return Attribute(name, kind.domain, values, role, index, normalized)


@st.composite
def partitions(draw: st.DrawFn, kind: str, faces: int, name: Any, unique: bool) -> Parts | None:
    some = draw(st.lists(name, max_size=3, unique=unique))
    if not some:
        return None
    least = 0 if kind == "object" else -1
    ids = draw(st.lists(st.integers(least, len(some) - 1), min_size=faces, max_size=faces))
    used, of_face = np.unique(ids, return_inverse=True)
    none = int(used[0] == -1)
    if len(used) == none:
        return None
    return Parts(kind, tuple(some[i] for i in used[none:]), of_face - none)


@st.composite
def polymeshes(
    draw: st.DrawFn,
    kinds: tuple[Kind, ...],
    *,
    precision: str = "float64",
    largest: int = 6,
    part_names: dict[str, Any] | None = None,
    metadata: dict[str, Any] | None = None,
    unique: bool = True,
    tables: dict[str, str] | None = None,
) -> PolyMesh:
    """Meshes of a few polygons, with attributes of the given kinds, each at most once.

    With `unique` no two parts of a kind share a name. `tables` says which domains are one table in
    the format, where names are unique; without it each domain is one.
    """
    finite = {"allow_nan": False, "allow_infinity": False, "allow_subnormal": False}
    n = draw(st.integers(3, 8))
    elements = nps.from_dtype(np.dtype(precision), **finite)
    V = draw(nps.arrays(precision, (n, 3), elements=elements)).astype(float)
    size, vertex = st.integers(3, largest), st.integers(0, n - 1)
    sizes = draw(st.lists(size, min_size=1, max_size=6))
    count = {"vertex": n, "corner": sum(sizes), "face": len(sizes)}
    corners = draw(st.lists(vertex, min_size=sum(sizes), max_size=sum(sizes)))
    found, taken = [], set()
    for kind in draw(st.lists(st.sampled_from(kinds), max_size=4, unique=True)) if kinds else ():
        name = kind.name or draw(words)
        key = (name, (tables or {}).get(kind.domain, kind.domain))
        if key not in taken:
            taken.add(key)
            found.append(draw(attributes(kind, count[kind.domain], name)))
    wanted = (part_names or {}).items()
    parts = [draw(partitions(kind, len(sizes), name, unique)) for kind, name in wanted]
    said = {key: draw(value) for key, value in (metadata or {}).items()}
    return PolyMesh(
        V,
        np.array(corners, dtype=np.int64),
        np.concatenate(([0], np.cumsum(sizes))).astype(np.int64),
        tuple(found),
        tuple(part for part in parts if part is not None),
        {key: value for key, value in said.items() if value},
        precision=precision,
    )


def _bits(values: np.ndarray) -> list[bytes]:
    """Each row as bytes: any NaN is NaN, as text has it, and -0.0 is not 0.0."""
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.nan, values).astype(values.dtype)
    return [row.tobytes() for row in np.ascontiguousarray(values)]


def _rows(attribute: Attribute) -> list[bytes | None]:
    table = [*_bits(attribute.values), None]
    return [table[i] for i in attribute.rows().tolist()]


def described_attribute(mesh: PolyMesh, a: Attribute) -> tuple[Any, ...]:
    """An attribute row by row; one of corners that is one of vertices, row for row, is that."""
    domain, rows = a.domain, _rows(a)
    as_vertices = a.index is not None and np.array_equal(a.index, mesh.corners)
    if domain == "corner" and as_vertices and len(a.values) == len(mesh.vertices):
        domain, rows = "vertex", _bits(a.values)
    return a.name, domain, a.role, a.normalized, a.values.dtype, a.width, rows


def described(mesh: PolyMesh) -> dict[str, Any]:
    """Everything of a mesh, in a form that can be compared and, when it differs, read."""
    parts = {
        p.kind: [None if i < 0 else p.names[i] for i in p.of_face.tolist()] for p in mesh.parts
    }
    objects = [p.of_face.tolist() for p in mesh.parts if p.kind == "object"]
    return {
        "vertices": _bits(mesh.vertices),
        "corners": mesh.corners.tolist(),
        "offsets": mesh.offsets.tolist(),
        "attributes": sorted(described_attribute(mesh, a)[:4] for a in mesh.attributes),
        "values": {(a.name, a.domain): described_attribute(mesh, a) for a in mesh.attributes},
        "parts": parts,
        "same object as": [[ids.index(i) for i in ids] for ids in objects],
        "metadata": dict(mesh.metadata),
        "precision": mesh.precision,
        "lost": mesh.lost,
    }
