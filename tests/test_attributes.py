"""Attributes: any numbers of vertices, corners and faces come back where they were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import strategies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh import decode
from deltamesh.options import Options
from deltamesh.pipeline import Encoded, encode_mesh
from deltamesh_formats.attribute_table import TYPES, Entry, read_table
from deltamesh_formats.polymesh import Attribute, PolyMesh, from_triangles
from deltamesh_formats.reader import read_container

WIDTHS = (0, 1, 2, 3, 4, 16)
DOMAINS = ("vertex", "corner", "face")


def counts_of(mesh: PolyMesh) -> dict[str, int]:
    return {"vertex": len(mesh.vertices), "corner": len(mesh.corners), "face": len(mesh.sizes)}


def entries_of(data: bytes) -> tuple[Entry, ...]:
    return read_table(read_container(data).sections["ATTR"].payload)[0]


def sources_of(one: Encoded, domain: str) -> np.ndarray:
    """The input's vertex, corner or face at each of those of the file; of triangles."""
    if domain == "corner":
        turned = (one.rotation[:, None] + np.arange(3)) % 3
        return (3 * one.face_order[:, None] + turned).ravel()
    return one.order if domain == "vertex" else one.face_order


def assert_same(given: Attribute, found: Attribute, sources: np.ndarray) -> None:
    """Everything is as it was, bit for bit."""
    assert_described(given, found)
    rows, others = given.rows()[sources], found.rows()
    assert ((rows < 0) == (others < 0)).all()
    has = rows >= 0
    wanted = given.values.astype(given.values.dtype.newbyteorder("="))[rows[has]]
    assert wanted.tobytes() == found.values[others[has]].tobytes()


def assert_described(given: Attribute, found: Attribute) -> None:
    for name in ("name", "domain", "role", "normalized", "width"):
        assert getattr(given, name) == getattr(found, name)
    assert found.values.dtype == given.values.dtype.newbyteorder("=")


@st.composite
def attributes(draw: st.DrawFn, counts: dict[str, int]) -> Attribute:
    """Any numbers: few different ones or many, with or without an index, gaps in it."""
    domain = draw(st.sampled_from(DOMAINS))
    dtype = draw(st.sampled_from(TYPES))
    if draw(st.booleans()):
        dtype = dtype.newbyteorder(">")
    width, count = draw(st.sampled_from(WIDTHS)), counts[domain]
    rows = draw(st.integers(1, 5))
    bits = draw(nps.arrays(np.uint8, (rows, width * dtype.itemsize)))
    if draw(st.booleans()):
        bits = np.random.default_rng(draw(strategies.SMALL)).integers(
            0, 256, bits.shape, dtype=np.uint8
        )
    values = np.ascontiguousarray(bits).view(dtype) if width else np.zeros((rows, 0), dtype)
    if dtype.kind == "b":
        values = (bits > 127).view(dtype)
    low = draw(st.sampled_from([-1, 0]))
    index = np.random.default_rng(draw(strategies.SMALL)).integers(low, rows, count)
    if draw(st.booleans()):
        values, index = values[np.maximum(index, 0)], None
    name = draw(st.sampled_from(["", "uv", "normal", "a\x00\n b", "\N{SNOWMAN}"]))
    role = draw(st.sampled_from(["normal", "uv", "colour", "other"]))
    return Attribute(name, domain, values, role, index, draw(st.booleans()))


@st.composite
def wholes(draw: st.DrawFn) -> PolyMesh:
    """Triangles of any kind, with attributes of any kind."""
    mesh = from_triangles(*draw(strategies.complexes()))
    counts = counts_of(mesh)
    return replace(mesh, attributes=tuple(draw(st.lists(attributes(counts), max_size=4))))


METHODS = st.sampled_from(["lossless", "cartesian", "highpass"])


@strategies.SOME
@given(wholes(), st.booleans())
def test_any_attributes_of_any_complex_come_back(mesh: PolyMesh, keep_order: bool) -> None:
    one = encode_mesh(mesh, Options(method="lossless", keep_order=keep_order, threads=1))
    decoded = decode(one.data)
    assert len(decoded.attributes) == len(mesh.attributes)
    for given_, found, told in zip(
        mesh.attributes, decoded.attributes, one.mesh.attributes, strict=True
    ):
        assert_same(given_, found, sources_of(one, given_.domain))
        assert_same(told, found, np.arange(counts_of(decoded)[told.domain]))
