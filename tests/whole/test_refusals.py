"""Files that are damaged, crafted or too large: refused with an offset, within bounds of memory."""

from __future__ import annotations

import time
import tracemalloc

import animated
import attributed
import forging
import golden_polymeshes
import meshes
import numpy as np
import polygon_meshes
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh import decode, encode, verify
from deltamesh._content import digest
from deltamesh._geometry import anchor_sections
from deltamesh._geometry.integers import NONE, Integers
from deltamesh._limits import memory_needed
from deltamesh._pipeline.decoder import read_content
from deltamesh._shape.surface import surface_of
from deltamesh_formats.container import layout
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import DeltameshError, FormatError, LimitError, SolveError

SPHERE = meshes.icosphere(1)
RATE_SIZE = 8  # of FRAM
FILES = {
    "farthest": encode(*SPHERE, anchors=4, method="highpass"),
    "random": encode(*SPHERE, anchors=4, anchor_method="random", method="highpass"),
    "greedy": encode(*SPHERE, anchors=4, anchor_method="greedy", method="highpass"),
    "zero bits": encode(*SPHERE, anchors=4, bits=0, method="highpass"),
    "cartesian": encode(*SPHERE, method="cartesian"),
    "corrected": encode(*meshes.torus(9, 7), method="refined", quality=3, max_error_rel=0.002),
    "lossless": encode(*SPHERE, method="lossless"),
    "lossless, raw": encode(*meshes.wild(meshes.tetrahedron()), method="lossless"),
    "isolated": encode(*meshes.with_isolated(), method="highpass"),
    "isolated cartesian": encode(*meshes.with_isolated(), method="cartesian"),
    "isolated lossless": encode(*meshes.with_isolated(), method="lossless"),
    "boundary": encode(*meshes.grid(5, 6), method="highpass"),
    "order": encode(*meshes.grid(5, 6), keep_order=True, method="highpass"),
    "attributes": encode(attributed.with_all(attributed.with_isolated()), method="cartesian"),
    "stitched": encode(
        *meshes.union(meshes.crossing(), meshes.with_degenerate()), method="highpass"
    ),
    "turned seams, cartesian": encode(
        *meshes.union(meshes.seams(), meshes.moebius(6)), method="cartesian"
    ),
    "doubled soup": encode(*meshes.union(meshes.doubled(), meshes.soup()), method="highpass"),
    "polygons": encode(polygon_meshes.MADE["mixed"], keep_order=True, method="highpass"),
    "parts": encode(
        golden_polymeshes.with_parts(polygon_meshes.quads(3, 4)), method="cartesian", bits=6
    ),
    "sequence": animated.file_of("refined-sequence"),
    "Cartesian sequence": animated.file_of("cartesian-sequence"),
    "genus 2 of two": encode(
        *meshes.union(meshes.double_torus(), meshes.tetrahedron()), method="highpass"
    ),
}


def refusal(data, read=decode, **options):
    """The FormatError of a file, which must have one, and an offset in the file with it."""
    with pytest.raises(FormatError) as caught:
        read(data, **options)
    assert isinstance(caught.value, DeltameshError)
    assert caught.value.offset is not None, caught.value
    assert 0 <= caught.value.offset <= len(data)
    assert f"(at byte {caught.value.offset})" in str(caught.value)
    return caught.value


@pytest.mark.parametrize("name", FILES)
def test_the_files_themselves_decode(name: str) -> None:
    decode(FILES[name])
    verify(FILES[name])


# ---- Damage ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FILES)
def test_every_truncation(name: str) -> None:
    for size in range(len(FILES[name])):
        error = refusal(FILES[name][:size])
        assert size == 0 or error.offset > 0


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("byte", [0x00, 0x0A, 0xFF])
def test_one_appended_byte(name: str, byte: int) -> None:
    data = FILES[name]
    assert refusal(data + bytes([byte])).offset == len(data)
    assert refusal(bytes([byte]) + data).offset == 0


@pytest.mark.parametrize("name", FILES)
def test_every_flipped_bit(name: str) -> None:
    for at in range(8 * len(FILES[name])):
        damaged = bytearray(FILES[name])
        damaged[at // 8] ^= 1 << at % 8
        refusal(bytes(damaged))


@given(st.sampled_from(sorted(FILES)), st.data())
def test_bytes_lost_doubled_or_exchanged(name: str, draw: st.DataObject) -> None:
    data = FILES[name]
    start, end = sorted(draw.draw(st.tuples(*[st.integers(0, len(data))] * 2)))
    damaged = draw.draw(
        st.sampled_from(
            [data[:start] + data[end:], data[:end] + data[start:], data[end:] + data[:end]]
        )
    )
    if damaged != data:
        refusal(damaged)


@given(st.binary(max_size=400))
def test_random_bytes(data: bytes) -> None:
    refusal(data)
    refusal(layout.MAGIC + data)


def test_other_magic_and_versions() -> None:
    data = FILES["farthest"]
    assert refusal(forging.with_header(data, magic=b"\x89PNG\r\n\x1a\n")).offset == 0
    assert refusal(forging.with_header(data, magic=b"\x09DMS\r\n\x1a\n")).offset == 0
    assert "older" in str(refusal(forging.with_header(data, version=3)))
    assert "newer" in str(refusal(forging.with_header(data, version=5)))
    assert "newer" in str(refusal(forging.with_header(data, version=65535)))
    assert refusal(forging.with_header(data, version=0)).offset == 8
    assert refusal(forging.with_header(data, reserved=1)).offset == 10
    assert forging.with_header(data) == data


# ---- Counts ------------------------------------------------------------------------------------

# The first passes the default limits.
HUGE = [4 * 10**6, 2**31, 2**32, 2**40]


def assert_refused_cheaply(data, error=(FormatError, LimitError), **options):
    """Refused within a second or so, and without having allocated by the counts."""
    start = time.perf_counter()
    tracemalloc.start()
    try:
        with pytest.raises(error):
            decode(data, **options)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 64 << 20
    assert time.perf_counter() - start < 2


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("count", HUGE)
def test_huge_counts(name: str, count: int) -> None:
    data = FILES[name]
    few = read_container(data).vertices
    assert_refused_cheaply(forging.forged(data, vertices=count, triangles=min(2 * count, 2**40)))
    assert_refused_cheaply(forging.forged(data, triangles=count))
    assert_refused_cheaply(forging.forged(data, vertices=count))
    for vertices, isolated in ((count, count - few), (count, count), (count, few)):
        many = {"isolated": isolated}
        assert_refused_cheaply(forging.forged(data, vertices=vertices, parameters=many))


@pytest.mark.parametrize("name", ["farthest", "random", "greedy", "zero bits"])
@pytest.mark.parametrize("count", HUGE)
def test_huge_counts_of_anchors(name: str, count: int) -> None:
    data = forging.forged(FILES[name], vertices=count, parameters={"anchor_count": count})
    assert_refused_cheaply(data)
    many = {"anchor_count": count, "isolated": count - 42}
    assert_refused_cheaply(forging.forged(FILES[name], vertices=count, parameters=many))


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("change", [-2, -1, 1, 2])
def test_wrong_counts(name: str, change: int) -> None:
    """Off by little: the payloads of another mesh."""
    data = FILES[name]
    container = read_container(data)
    n, m, p = container.vertices, container.triangles, container.parameters
    refusal(forging.forged(data, vertices=n + change))
    refusal(forging.forged(data, triangles=m + change))
    refusal(forging.forged(data, vertices=n + change, triangles=m + 2 * change))
    if p.isolated + change >= 0:
        more = {"isolated": p.isolated + change}
        refusal(forging.forged(data, parameters=more))
        refusal(forging.forged(data, vertices=n + change, parameters=more))
    if p.anchor_count + change >= 0 and p.method == "highpass":
        refusal(forging.forged(data, parameters={"anchor_count": p.anchor_count + change}))


@pytest.mark.parametrize("name", FILES)
def test_no_faces(name: str) -> None:
    """No encoder writes a cloud of points."""
    data = FILES[name]
    nothing = {"CONN": b"\0\0\0"}
    refusal(forging.forged(data, triangles=0))
    for n in (0, 1, 5):
        parameters = {"isolated": n} | ({"anchor_count": 0} if n == 0 else {})
        parameters |= {"anchor_count": min(n, read_container(data).parameters.anchor_count)}
        empty = forging.forged(data, vertices=n, triangles=0, parameters=parameters, **nothing)
        refusal(empty)
        method = read_container(data).parameters.method
        payloads = {"cartesian": {"CART": b""}, "lossless": {"EXAC": EMPTY_FORMS}}
        payload = payloads.get(method, {"ANCH": bytes(3), "DELT": b""})
        forms = EMPTY_FORMS if method == "lossless" else b""
        checksum = digest_of_points(n, method in payloads, forms)
        refusal(forging.forged(empty, **payload, checksum=checksum))


# Of width 64, and on each axis one form, in which all is 0.
EMPTY_FORMS = b"@" + 3 * b"\1\0\0\2\0\0\1\0"


def digest_of_points(n, cartesian, forms):
    zeros, none = np.zeros((n, 3), dtype=np.int64), np.zeros(0, dtype=np.int64)
    values, isolated = (zeros, zeros[:0]) if cartesian else (zeros[:0], zeros)
    told = np.array(list(forms), dtype=np.int64)
    return digest(zeros[:0], NONE, Integers(values, none, zeros[:0], isolated, formats=told))


# ---- Limits ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(FILES))
def test_limits_are_met_exactly(name: str) -> None:
    data = FILES[name]
    container = read_container(data)
    needed = memory_needed(container)
    decode(data, max_vertices=container.vertices, memory=needed)
    with pytest.raises(LimitError, match=f"{container.vertices} vertices"):
        decode(data, max_vertices=container.vertices - 1)
    with pytest.raises(LimitError, match=f"{needed} bytes"):
        decode(data, memory=needed - 1)
    for options in ({"max_vertices": 0}, {"memory": 0}):
        assert_refused_cheaply(data, LimitError, **options)


def test_needed_memory_grows_with_the_counts() -> None:
    """And with a factor: bytes per vertex are at least those of the arrays themselves."""
    small, large = (read_container(encode(*meshes.icosphere(k), method="highpass")) for k in (1, 3))
    difference = memory_needed(large) - memory_needed(small)
    assert difference > 24 * (large.vertices - small.vertices + large.triangles - small.triangles)


# ---- Payloads under right checksums ------------------------------------------------------------


@pytest.mark.parametrize("name", FILES)
def test_wrong_digest(name: str) -> None:
    data = FILES[name]
    right = read_container(data)
    for at in range(8):
        wrong = bytearray(right.digest)
        wrong[at] ^= 1
        error = refusal(forging.forged(data, checksum=bytes(wrong)))
        assert "checksum" in str(error)
        assert error.offset == right.sections["CHEK"].offset


def payloads():
    """(file, section) for every payload of the codec's own."""
    return [
        (name, section)
        for name, data in FILES.items()
        for section in read_container(data).sections
        if section not in (layout.PARAMETERS, layout.META, layout.CHECK)
    ]


def refused_unless_the_same(name, section, payload):
    """There is one form only of each file; the frames in a second are a parameter."""
    begin = RATE_SIZE if section == layout.FRAMES else 0
    before = bytes(read_container(FILES[name]).sections[section].payload)
    if payload[begin:] != before[begin:]:
        # The records of frames have checksums of their own, which reading them all compares.
        refusal(forging.forged(FILES[name], **{section: payload}), read=verify)


@given(st.sampled_from(payloads()), st.binary(max_size=300))
def test_random_payloads(place: tuple[str, str], payload: bytes) -> None:
    refused_unless_the_same(*place, payload)


@given(st.sampled_from(payloads()), strategies.SMALL, st.integers(0, 7))
def test_flipped_bits_of_payloads(place: tuple[str, str], at: int, bit: int) -> None:
    name, section = place
    payload = bytearray(read_container(FILES[name]).sections[section].payload)
    if payload:
        payload[at % len(payload)] ^= 1 << bit
        refused_unless_the_same(name, section, bytes(payload))


@given(st.sampled_from(payloads()), strategies.SMALL)
def test_truncated_payloads(place: tuple[str, str], size: int) -> None:
    name, section = place
    payload = bytes(read_container(FILES[name]).sections[section].payload)
    refused_unless_the_same(name, section, payload[: size % max(len(payload), 1)])


@pytest.mark.parametrize("place", payloads(), ids=" ".join)
def test_payloads_with_more_behind(place: tuple[str, str]) -> None:
    name, section = place
    payload = bytes(read_container(FILES[name]).sections[section].payload)
    for more in (b"\0", b"\1", bytes(8), payload + b"\1"):
        refusal(forging.forged(FILES[name], **{section: payload + more}))


@given(st.sampled_from(payloads()), st.binary(max_size=100))
def test_payloads_that_agree_with_their_digest(place: tuple[str, str], payload: bytes) -> None:
    """A forger can compute the digest, too: what comes out is refused or a finite mesh."""
    name, section = place
    try:
        data = forging.consistent(forging.forged(FILES[name], **{section: payload}))
    except FormatError:
        return
    try:
        mesh = decode(data)
    except (FormatError, LimitError, SolveError):
        return
    container = read_container(data)
    assert mesh.triangles.shape == (container.triangles, 3)
    assert ((mesh.triangles >= 0) & (mesh.triangles < container.vertices)).all()
    assert mesh.vertices.shape == (container.vertices, 3)
    assert np.isfinite(mesh.vertices).all()


def test_sections_of_another_mesh() -> None:
    """Same counts, other connectivity or other geometry."""
    V, F = SPHERE
    other = encode(V, meshes.shuffled(V, F, 5)[0].faces, anchors=4, method="highpass")
    turned = encode(V[:, ::-1] * [1, 1, -1], F, anchors=4, method="highpass")
    for source in (other, turned):
        sections = read_container(source).sections
        for name in ("CONN", "ANCH", "DELT"):
            payload = bytes(sections[name].payload)
            if payload != bytes(read_container(FILES["farthest"]).sections[name].payload):
                refusal(forging.forged(FILES["farthest"], **{name: payload}))


def test_component_without_an_anchor() -> None:
    mesh = meshes.union(SPHERE, (SPHERE[0] + 9, SPHERE[1]))
    data = encode(*mesh, anchors=2, anchor_method="greedy", method="highpass")
    content = read_content(read_container(data), 10**9, 10**12)
    surface, integers = content.structure.surface, content.integers
    parameters = read_container(data).parameters
    for anchors in ([0, 1], [42, 83], [80, 81]):
        one_sided = Integers(
            integers.values, np.array(anchors), integers.positions, integers.isolated
        )
        payload = anchor_sections.encode(surface, parameters, one_sided)["ANCH"]
        checksum = digest(surface.faces, NONE, one_sided)
        error = refusal(forging.forged(data, ANCH=payload, checksum=checksum))
        assert "anchor" in str(error)
    for method in ("farthest", "random"):
        data = encode(*mesh, anchors=2, anchor_method=method, method="highpass")
        for count in (0, 1):
            refusal(forging.forged(data, parameters={"anchor_count": count}))


def test_anchors_that_are_no_vertices() -> None:
    data = FILES["greedy"]
    content = read_content(read_container(data), 10**9, 10**12)
    surface, integers = content.structure.surface, content.integers
    parameters = read_container(data).parameters
    values = np.pad(integers.values, ((0, 1), (0, 0)))
    outside = Integers(values, np.array([0, 1, 2, 42]), integers.positions, integers.isolated)
    larger = surface_of(surface.faces, 43, 0)
    payload = anchor_sections.encode(larger, parameters, outside)["ANCH"]
    refusal(forging.forged(data, ANCH=payload))


def lengths():
    """(file, parameter) for every length among the parameters that is not 0."""
    return [
        (name, field)
        for name, data in FILES.items()
        for field in ("step", "anchor_step", "origin")
        if getattr(read_container(data).parameters, field) and "lossless" not in name
    ]


@pytest.mark.parametrize("place", lengths(), ids=" ".join)
@pytest.mark.parametrize("value", [1e300, 1.7e308])
def test_positions_out_of_bounds(place: tuple[str, str], value: float) -> None:
    """No warning on a terminal, and no infinite coordinate: a finite mesh or a refusal."""
    name, field = place
    changed = {field: (value, -value, 0.0) if field == "origin" else value}
    changed |= {"bits": None} if field == "step" else {}
    data = forging.forged(FILES[name], parameters=changed)
    try:
        mesh = decode(data)
    except SolveError:
        return
    except FormatError:
        refusal(data)
        return
    assert np.isfinite(mesh.vertices).all()


@pytest.mark.parametrize("counts", [(1, 0, 0), (0, 0, 1), (2, 2, 0), (2**40, 2**40, 2**40)])
def test_counts_of_the_connectivity(counts: tuple[int, int, int]) -> None:
    data = FILES["farthest"]
    payload = bytes(read_container(data).sections["CONN"].payload)
    start = b"".join(map(write_varint, counts))
    assert_refused_cheaply(forging.forged(data, CONN=start + payload[3:]), FormatError)


# ---- What is not damage ------------------------------------------------------------------------


@pytest.mark.parametrize("name", FILES)
def test_unknown_optional_sections_and_meta_do_not_matter(name: str) -> None:
    data = FILES[name]
    expected = decode(data)
    for other in (forging.forged(data, meta=None), forging.forged(data, xtra=b"anything")):
        assert other != data
        mesh = decode(other)
        np.testing.assert_array_equal(mesh.triangles, expected.triangles)
        np.testing.assert_array_equal(mesh.vertices, expected.vertices)
    assert forging.forged(data) == data
    assert forging.consistent(data) == data
