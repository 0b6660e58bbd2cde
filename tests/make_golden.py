"""Write tests/data/golden and tests/data/refused anew: `just golden`, by hand only.

With --add, only the files that are missing are written.

Golden files pin the decoder, not the encoder: old bytes must decode to the same mesh for ever, new
bytes may become fewer. As long as SPEC.md says that the format is not frozen, both folders are
written anew when it changes; after that, files are added to them and none is changed.

What a golden file decodes to is compared here with what does not come from the decoder: the faces
with those of the input, positions with a dense least-squares solution.
"""

from __future__ import annotations

import argparse
import math
import struct
import zlib
from dataclasses import replace

import animated
import attributed
import forging
import golden_polymeshes
import meshes
import numpy as np
import oracle
import poisson_oracle
import posed
import spec_decoder
import stepped
import strategies
from graphs import tolerances_of
from places import GOLDEN, REFUSED
from second_opinion import assert_same

from deltamesh import frames, info
from deltamesh._codec.decoding import decode
from deltamesh._content import digest
from deltamesh._geometry import anchor_sections, cartesian, lossless, steps
from deltamesh._geometry.integers import NONE, Integers
from deltamesh._geometry.quantize import from_grid
from deltamesh._graph.adjacency import lowest, without_edges
from deltamesh._options import Options
from deltamesh._order.coding import encode_order
from deltamesh._order.reordering import Order
from deltamesh._pipeline.decoder import read_content
from deltamesh._pipeline.encoder import encode_mesh
from deltamesh._shape.polygons import plain
from deltamesh._shape.surface import surface_of
from deltamesh._streams import exact as exact_streams
from deltamesh._streams.columns import encode_three
from deltamesh._streams.conversions import ADD, MULTIPLY, Operation
from deltamesh._streams.number_formats import RAW_ONLY
from deltamesh._streams.vectors import encode_vectors
from deltamesh_formats import zstd_frames
from deltamesh_formats.container.attribute_table import entries_of
from deltamesh_formats.container.container import Section
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError, LimitError
from deltamesh_formats.polymesh.mesh import from_triangles

TABLE = REFUSED / "expected.tsv"
THROUGH = {"solution": "interpolated"}
CORRECTED = {"normal_error": 8.0, "max_error_rel": 1.5e-3}


# ---- Files that must decode --------------------------------------------------------------------


def surface_with_everything():
    """Holes, handles and components, flipped edges."""
    V, F = meshes.union(meshes.torus(7, 6), meshes.grid(6, 6), meshes.icosphere(1))
    faces = [tuple(map(int, f)) for f in F]
    for at in range(0, 600, 7):
        faces = strategies.flip(faces, at * 31)
    for at in range(0, 40, 5):
        faces = strategies.open_hole(faces, at * 17)
    for at in range(6):
        faces = strategies.join_by_tube(faces, at * 23, at * 41 + 90)
    assert strategies.is_manifold(faces)
    noise = np.random.default_rng(2006).normal(size=V.shape)
    return V + 0.02 * noise, np.array(faces)


def fan(valence):
    turn = np.linspace(0, 2 * np.pi, valence, endpoint=False)
    V = np.stack((np.cos(turn), np.sin(turn), 0.2 * np.sin(5 * turn)), axis=1)
    i = np.arange(valence)
    F = np.stack((i, (i + 1) % valence, np.full(valence, valence)), axis=1)
    return np.concatenate((V, [[0.1, 0, 0.3]])), F


def machine_part():
    """A comb on a lattice: few different coordinates, fans of slivers on the flat sides."""
    outline = [(0, 0), (30, 0), (30, 4)]
    for x in range(24, 2, -6):
        outline += [(x + 2, 4), (x + 2, 10), (x, 10), (x, 4)]
    outline = np.array([*outline, (0, 4)])
    n = len(outline)
    i, rim = np.arange(n), (np.arange(n) + 1) % n
    V = np.concatenate([np.pad(outline, ((0, 0), (0, 1)), constant_values=z) for z in (0, 5)])
    sides = [np.stack(f, axis=1) for f in ((i, rim, rim + n), (i, rim + n, i + n))]
    V = np.concatenate([V, [[15, 2, 0], [15, 2, 5]]]).astype(float)
    ends = [np.stack((rim, i, np.full(n, 2 * n)), axis=1)]
    ends += [np.stack((i + n, rim + n, np.full(n, 2 * n + 1)), axis=1)]
    return V, np.concatenate([*sides, *ends])


def slope(mesh):
    """An importance that falls along x, from 1 to an eighth."""
    x = mesh[0][:, 0]
    return 2.0 ** (-3 * (x.max() - x) / np.ptp(x))


def half(mesh):
    """An importance of 1 on one side, and none on the other."""
    return (mesh[0][:, 0] > 0.1).astype(float)


def golden():
    """Name, mesh and options of each golden file; the name begins with the method."""
    sphere, torus = meshes.icosphere(2), meshes.torus(9, 7)
    patch, isolated = meshes.grid(10, 10), meshes.with_isolated()
    far = sphere[0] * 50 + [4e6, -3e5, 12.5], sphere[1]
    parts = meshes.union(meshes.icosphere(1), meshes.torus(7, 5), meshes.tetrahedron())
    return [
        ("highpass-farthest", sphere, {"bits": 8, "anchors": 5}),
        ("highpass-greedy", sphere, {"bits": 6, "anchors": 9, "anchor_method": "greedy"}),
        (
            "highpass-random",
            torus,
            {"bits": 7, "anchors": 0.1, "anchor_method": "random", "seed": 2**63 + 5},
        ),
        ("highpass-default", torus, {}),
        ("highpass-no-diffusion", torus, {"bits": 8, "diffusion": False}),
        ("highpass-step", torus, {"step": 0.01, "source_format": "ply"}),
        ("highpass-20-bits", torus, {"bits": 20}),
        ("highpass-0-bits", sphere, {"bits": 0, "anchors": 12}),
        ("highpass-corrected", patch, {"anchors": 1} | CORRECTED),
        ("refined-default", torus, {}),
        ("refined-fine", sphere, {"coarse": 2.5, "bits": 9, "anchors": 4}),
        ("refined-corrected", patch, {"anchors": 1} | CORRECTED),
        ("refined-corrected-isolated", meshes.with_isolated(patch), {"anchors": 1} | CORRECTED),
        ("refined-quality", torus, {"quality": 4}),
        ("refined-steps-importance", torus, {"bits": 8, "importance": slope(torus)}),
        ("refined-interpolated-no-importance", torus, {"bits": 8, "importance": half(torus)}),
        ("highpass-0-bits-greedy", torus, {"bits": 0, "anchors": 12, "anchor_method": "greedy"}),
        ("highpass-far-away", far, {"bits": 10}),
        ("highpass-interpolated", torus, THROUGH | {"bits": 8, "anchors": 7}),
        (
            "highpass-interpolated-components",
            parts,
            THROUGH | {"bits": 9, "anchors": 11, "anchor_method": "greedy"},
        ),
        ("highpass-interpolated-20-bits", torus, THROUGH | {"bits": 20, "anchors": 3}),
        ("refined-interpolated", torus, {"step": 0.02, "anchors": 9}),
        (
            "refined-interpolated-components",
            parts,
            {"step": 0.03, "anchors": 12, "anchor_method": "random", "seed": 11},
        ),
        ("refined-interpolated-boundary", meshes.grid(7, 9), {"step": 0.003, "anchors": 6}),
        (
            "refined-interpolated-everything",
            surface_with_everything(),
            {"step": 0.05, "anchors": 30},
        ),
        ("refined-interpolated-all", meshes.icosphere(1), {"step": 0.05, "anchors": 42}),
        ("refined-least-squares", torus, {"step": 0.02, "anchors": 5, "solution": "least-squares"}),
        ("highpass-tetrahedron", meshes.tetrahedron(), {}),
        ("highpass-triangle", (np.eye(3), np.array([[0, 1, 2]])), {}),
        ("highpass-valence-300", fan(300), {"bits": 6}),
        ("highpass-boundary", meshes.grid(7, 9), {"bits": 8}),
        ("highpass-genus-2", meshes.double_torus(), {"bits": 8}),
        ("highpass-components", meshes.two_components(), {"bits": 8, "anchors": 2}),
        ("highpass-isolated", isolated, {"bits": 8}),
        ("highpass-everything", surface_with_everything(), {"bits": 9, "anchors": 0.02}),
        ("cartesian", torus, {"bits": 11}),
        ("cartesian-1-bit", torus, {"bits": 1}),
        ("cartesian-30-bits", torus, {"bits": 30}),
        ("cartesian-step", sphere, {"step": 0.003}),
        ("cartesian-triangle", (np.eye(3), np.array([[0, 1, 2]])), {}),
        ("cartesian-isolated", isolated, {}),
        ("cartesian-everything", surface_with_everything(), {}),
        ("cartesian-machine-part", machine_part(), {"step": 0.01}),
        ("cartesian-valence-300", fan(300), {"bits": 9}),
        ("highpass-order", shuffled(surface_with_everything()), {"bits": 8, "keep_order": True}),
        ("cartesian-order", torus, {"keep_order": True}),
        (
            "cartesian-order-isolated",
            shuffled(isolated),
            {"keep_order": True},
        ),
        ("lossless-double", torus, {}),
        ("lossless-single", as_single(torus), {}),
        ("lossless-decimals", rounded(far), {}),
        ("lossless-single-decimals", as_single(rounded(sphere)), {}),
        ("lossless-whole-or-not", half_rounded(torus), {}),
        ("lossless-wild", meshes.wild(torus), {}),
        ("lossless-triangle", (np.eye(3), np.array([[0, 1, 2]])), {}),
        ("lossless-everything", surface_with_everything(), {}),
        ("lossless-inches", in_inches(sphere), {}),
        ("lossless-centred", centred(sphere), {}),
        ("lossless-dequantized", dequantized(sphere), {}),
        ("lossless-unit-box", in_unit_box(torus), {}),
        ("cartesian-moebius", meshes.moebius(9), {}),
        ("cartesian-fan-of-three", meshes.three_pages(), {}),
        ("cartesian-hourglass", meshes.hourglass(), {}),
        ("cartesian-crossing", meshes.crossing(), {}),
        ("cartesian-doubled", meshes.doubled(), {}),
        ("cartesian-degenerate", meshes.with_degenerate(), {}),
        ("cartesian-mixed-winding", meshes.mixed_winding(), {}),
        ("cartesian-seams", meshes.seams(), {}),
        ("cartesian-soup", meshes.soup(), {}),
        ("cartesian-collapsed", meshes.collapsed(), {}),
        ("highpass-collapsed", meshes.collapsed(), {}),
        ("highpass-complex", meshes.union(*meshes.complexes().values()), {"bits": 9}),
        ("refined-complex", meshes.union(*meshes.complexes().values()), {"step": 0.02}),
    ]


def shuffled(mesh):
    """In an order without any pattern, but for a part of the faces that goes by the vertices."""
    mesh = meshes.shuffled(*mesh, 1968)[0]
    first = mesh.faces.min(axis=1)
    first[::3] = -1
    return mesh.vertices, mesh.faces[np.argsort(first, kind="stable")]


def as_single(mesh):
    return mesh[0].astype(np.float32).astype(np.float64), mesh[1]


def rounded(mesh):
    return mesh[0].round(3), mesh[1]


def in_inches(mesh):
    """Decimals in float32, multiplied, but for one vertex."""
    V, F = as_single(rounded(mesh))
    V = np.float32(25.4) * V.astype(np.float32)
    V[17] *= np.float32(1.0001)
    return V.astype(np.float64), F


def centred(mesh):
    """Decimals in float32, less others."""
    V, F = as_single(rounded(mesh))
    return as_single((V - as_single((np.array([1.4, -2.25, 0.5]), F))[0], F))


def dequantized(mesh):
    """A grid of 12 bits, multiplied and moved in float64, as float32; one axis is none of it."""
    V = np.rint((mesh[0] + 1) * 2047.5) * (3.7 / 4095) - 1.3
    return as_single((np.where([True, False, True], V, mesh[0]), mesh[1]))


def in_unit_box(mesh):
    """Decimals in float64, turned before, less their mean, divided by what they extend over."""
    V = (mesh[0] @ [[2, 3, 6], [3, -6, 2], [6, 2, -3]]).round(3)
    return (V - V.mean(axis=0)) / np.ptp(V, axis=0).max(), mesh[1]


def half_rounded(mesh):
    """Two forms: two coordinates of each vertex are whole, as marching cubes make them."""
    V = np.floor(4096 * mesh[0]) / 64
    whole = np.arange(3) != np.arange(len(V))[:, None] % 3
    return np.where(whole, np.floor(V), V), mesh[1]


def assert_right(encoded, V, F):
    """Compare what a file decodes to with what does not come from the decoder."""
    decoded = decode(encoded.data)
    assert strategies.canonical(encoded.order[decoded.faces]) == strategies.canonical(F)
    container = read_container(encoded.data)
    content = read_content(container, 10**9, 2**40)
    structure, integers, kept = content.structure, content.integers, content.order
    surface = structure.surface
    p, n = container.parameters, surface.vertex_count
    origin = np.array(p.origin)
    if p.method == "lossless":
        assert decoded.vertices.tobytes() == V[encoded.order].tobytes()
        return decoded
    if kept is not None:
        np.testing.assert_array_equal(decoded.faces, F)
        assert strategies.canonical(kept.vertices[F]) == strategies.canonical(structure.faces)
    # Where the vertices of the codec's own order are in the decoded mesh.
    places = np.arange(len(V)) if kept is None else np.argsort(kept.vertices)
    each = np.ones((len(integers.values), 1))
    each[: len(integers.exponents), 0] = 2.0 ** (-integers.exponents / 4)
    if p.method == "cartesian":
        expected = from_grid(integers.values, origin, p.step * each)[structure.points]
        error = np.abs(expected - V[encoded.order[places]])
        assert (error <= 0.500001 * p.step * each[structure.points] + 1e-15).all()
    else:
        anchored = from_grid(integers.positions, origin, p.anchor_step * each[integers.anchors])
        L = oracle.laplacian(surface.faces, n)
        delta = integers.values * (p.coarse * p.step * each)
        solution = solution_of(L, delta, anchored, p, integers, each, 0)
        if p.method == "refined":
            N = oracle.normals(solution, surface.faces, p.coarse * p.step * each)
            delta = delta + p.step * each * integers.refinements * N
            solution = solution_of(L, delta, anchored, p, integers, each, 1)
        if len(integers.corrections):
            solution += p.step * each * integers.corrections
        isolated = from_grid(integers.isolated, origin, p.anchor_step)
        expected = np.concatenate((solution, isolated))[structure.points]
    error = np.abs(decoded.vertices[places] - expected)
    assert (error <= tolerances_of(encoded.data, decoded)[places]).all()
    return decoded


def solution_of(L, delta, anchored, p, integers, each, stage):
    """The dense solution for some deltas, of the kind that the parameters say."""
    anchors = integers.anchors.tolist()
    if not p.interpolated:
        return oracle.solution_by_component(L, integers.anchors, delta, anchored)
    y = np.zeros((len(anchors), 3))
    if len(integers.cells):
        stored = integers.cells[stage], integers.units[stage]
        y = poisson_oracle.vectors(L, anchors, *stored, p.step * each)
    d = poisson_oracle.completed(L, anchors, delta, y)
    return poisson_oracle.solution(L, anchors, d, anchored)


def is_missing(name, folder=GOLDEN):
    return not (folder / f"{name}.dmesh").exists()


def missing(rows):
    """The rows, each of which begins with a name, of golden files that are missing."""
    return [row for row in rows if is_missing(row[0])]


def write_golden():
    for name, (V, F), options in missing(golden()):
        encoded = encode_mesh(from_triangles(V, F), Options(method=name.split("-")[0], **options))
        write_triangles(name, encoded, V, F)


def write_stepped():
    for name, (V, F), *_ in missing(stepped.golden()):
        write_triangles(name, stepped.file_of(name), V, F)


def write_triangles(name, encoded, V, F):
    decoded = assert_right(encoded, V, F)
    sections = read_container(encoded.data).sections
    found = "FIXS" in sections, "STEP" in sections
    assert ("corrected" in name, "steps" in name) == found, name
    assert "CELL" in sections or "interpolated" not in name, name
    (GOLDEN / f"{name}.dmesh").write_bytes(encoded.data)
    faces = decoded.triangles.astype(np.uint16)
    np.savez_compressed(GOLDEN / f"{name}.npz", vertices=decoded.vertices, faces=faces)


def write_sequences():
    """Frames beyond the first are compared with those of the second decoder."""
    for name in [name for name in animated.MADE if is_missing(name)]:
        data = animated.file_of(name)
        assert_same(data)
        first, *further = frames(data)
        moved = np.stack([frame.vertices for frame in further])
        (GOLDEN / f"{name}.dmesh").write_bytes(data)
        faces = first.triangles.astype(np.uint16)
        arrays = {"vertices": first.vertices, "faces": faces, "frames": moved}
        np.savez_compressed(GOLDEN / f"{name}.npz", **arrays)


def write_polymeshes():
    for name, mesh, options in filter(
        lambda row: is_missing(row[0]), golden_polymeshes.polymeshes()
    ):
        encoded = encode_mesh(mesh, Options(method=name.split("-")[0], **options))
        decoded = golden_polymeshes.assert_right(name, mesh, encoded)
        (GOLDEN / f"{name}.dmesh").write_bytes(encoded.data)
        np.savez_compressed(GOLDEN / f"{name}.npz", **golden_polymeshes.stored(decoded))


def assert_attributes(encoded, decoded):
    """Compare attributes with those of the input, in the order in which the file has them."""
    entries = entries_of(read_container(encoded.data))
    for entry, wanted, found in zip(
        entries, encoded.mesh.attributes, decoded.attributes, strict=True
    ):
        rows = wanted.rows(), found.rows()
        np.testing.assert_array_equal(*(row < 0 for row in rows))
        a, b = (one.values[row[row >= 0]] for one, row in zip((wanted, found), rows, strict=True))
        assert a.dtype == b.dtype
        if entry.coding == "octahedral":
            bound = 1.42 / (2 ** (entry.bits - 1) - 1)
            cross = np.linalg.norm(np.cross(a.astype(float), b.astype(float)), axis=1)
            assert (cross <= bound).all()
            np.testing.assert_array_equal(a.any(axis=1), b.any(axis=1))
            assert ((a * b).sum(axis=1) >= 0).all()
        elif entry.coding == "grid":
            assert np.abs(a.astype(float) - b.astype(float)).max() <= 0.51 / entry.density
        else:
            assert a.tobytes() == b.tobytes()


def referenced(mesh):
    """Return a mesh without the rows of attributes that nothing refers to, which are losses."""
    attributes = []
    for one in mesh.attributes:
        if one.index is not None:
            has = one.index >= 0
            rows, numbers = np.unique(one.index[has], return_inverse=True)
            index = np.full(len(has), -1)
            index[has] = numbers
            one = replace(one, values=one.values[rows], index=index)
        attributes.append(one)
    return replace(mesh, attributes=tuple(attributes))


def write_attributed():
    """The golden files with attributes; `values` are 0 where `has` says that there are none."""
    for name, mesh, options in missing(attributed.golden()):
        mesh = referenced(mesh)
        encoded = encode_mesh(mesh, Options(method=name.split("-")[0], **options))
        decoded = decode(encoded.data)
        np.testing.assert_array_equal(decoded.corners, encoded.mesh.corners)
        np.testing.assert_array_equal(decoded.offsets, encoded.mesh.offsets)
        if (mesh.sizes == 3).all():
            assert_right(encoded, mesh.vertices, mesh.faces)
        assert_attributes(encoded, decoded)
        if (mesh.sizes == 3).all():
            arrays = {"vertices": decoded.vertices, "faces": decoded.triangles.astype(np.uint16)}
        else:
            arrays = golden_polymeshes.stored(decoded)
        for i, attribute in enumerate(decoded.attributes):
            has = attribute.rows() >= 0
            arrays[f"values{i}"] = np.zeros((len(has), attribute.width), attribute.values.dtype)
            arrays[f"values{i}"][has] = attribute.values[attribute.rows()[has]]
            if not has.all():
                arrays[f"has{i}"] = has
        (GOLDEN / f"{name}.dmesh").write_bytes(encoded.data)
        np.savez_compressed(GOLDEN / f"{name}.npz", **arrays)


def write_posed():
    """The golden files with poses: positions are those of the second decoder."""
    for name, data in posed.golden():
        if not is_missing(name):
            continue
        mesh = decode(data)
        arrays = {"vertices": mesh.vertices, "faces": mesh.triangles.astype(np.uint16)}
        for pose in posed.NAMES:
            arrays[f"pose {pose}"] = decode(data, pose=pose).vertices
            found = spec_decoder.decode(data, pose=pose)[0]
            error = np.abs(found - arrays[f"pose {pose}"])
            assert (error <= posed.tolerances(data, mesh)).all()
        (GOLDEN / f"{name}.dmesh").write_bytes(data)
        np.savez_compressed(GOLDEN / f"{name}.npz", **arrays)


# ---- Files that must be refused ----------------------------------------------------------------


def encoded(mesh, method="highpass", **options):
    return encode_mesh(from_triangles(*mesh), Options(method=method, **options)).data


def payload_of(data, name):
    return bytes(read_container(data).sections[name].payload)


def raw_section(data, name):
    """The bytes of a section, and those before and after it."""
    section = read_container(data).sections[name]
    end = section.offset + section.size
    return data[: section.offset], data[section.offset : end], data[end:]


def exchanged(data, first, second):
    """The file with two sections, one after the other, the other way round."""
    before, one, _ = raw_section(data, first)
    _, two, after = raw_section(data, second)
    return before + two + one + after


def with_section(data, name, replacement):
    before, _, after = raw_section(data, name)
    return before + replacement + after


def with_parameter_bytes(data, at, value):
    """PARM with some of its bytes replaced."""
    payload = payload_of(data, "PARM")
    changed = payload[:at] + value + payload[at + len(value) :]
    return with_section(data, "PARM", forging.section("PARM", changed))


def flipped(data, at, bit=0):
    out = bytearray(data)
    out[at] ^= 1 << bit
    return bytes(out)


def one_sided_anchors():
    """Two components, both anchors in the first, and the digest right."""
    data = encoded(meshes.two_components(), bits=6, anchors=2, anchor_method="greedy")
    container = read_container(data)
    content = read_content(container, 10**9, 2**40)
    surface, integers = content.structure.surface, content.integers
    anchors = np.array([0, 1])
    wrong = Integers(integers.values, anchors, integers.positions, integers.isolated)
    payload = anchor_sections.encode(surface, container.parameters, wrong)["ANCH"]
    return forging.forged(data, ANCH=payload, checksum=digest(surface.faces, NONE, wrong))


def corrected_file():
    """A file with FIXS."""
    return encoded(meshes.grid(10, 10), method="refined", anchors=1, **CORRECTED)


def long_varint(data):
    """The count of vertices in one byte more than it needs."""
    container = read_container(data)
    start = next(iter(container.sections.values())).offset
    vertices = bytearray(write_varint(container.vertices))
    vertices[-1] |= 0x80
    raw = data[:12] + bytes(vertices) + b"\0" + write_varint(container.triangles)
    return raw + zlib.crc32(raw).to_bytes(4, "little") + data[start:]


def infinite(data):
    """A file of raw coordinates, one of which is infinite, and the digest right."""
    container = read_container(data)
    content = read_content(container, 10**9, 2**40)
    surface, integers = content.structure.surface, content.integers
    values = integers.values.copy()
    values[7, 1] = np.float64("inf").view(np.int64)
    wrong = lossless.exactly(
        values, exact_streams.pack_formats(exact_streams.DOUBLE, [RAW_ONLY] * 3)
    )
    payloads = lossless.encode(surface, container.parameters, wrong)
    return forging.forged(data, **payloads, checksum=digest(surface.faces, NONE, wrong))


def wrongly_converted():
    """Files with conversions at fault."""
    inches = encoded(in_inches(meshes.icosphere(2)), method="lossless")
    exact = payload_of(inches, "EXAC")
    width, columns, at = exact_streams.unpack_formats(memoryview(exact))
    surface = surface_of(decode(inches).faces, 162, 0)
    numbers = exact_streams.decode_numbers(memoryview(exact), at, surface.elements, width, columns)

    def changed(width=width, deviations=numbers[2], **fields):
        """The file with other fields of the conversion of the last axis."""
        conversion = replace(columns[2].conversion, **fields)
        other = [*columns[:2], replace(columns[2], conversion=conversion)]
        stream = exact_streams.encode_numbers(
            surface.elements, width, other, *numbers[:2], deviations
        )
        head = exact_streams.pack_formats(width, other)
        return forging.forged(inches, EXAC=head + stream)

    def operand(x):
        return changed(operations=(Operation(MULTIPLY, 1.0), Operation(MULTIPLY, x)))

    beyond, misplaced = numbers[2].copy(), numbers[2].copy()
    beyond[numbers[1][:, 2].argmax(), 2] = 2**31 - 1
    misplaced[7, 0] = 1
    return {
        "lossless-three-operations": changed(operations=3 * (Operation(ADD, 1.0),)),
        "lossless-operator": changed(operations=(Operation(3, 1.0),)),
        "lossless-operand-zero": operand(0.0),
        "lossless-operand-infinite": operand(np.inf),
        "lossless-operand-nan": operand(np.nan),
        "lossless-operand-subnormal": operand(2.0**-1023),
        "lossless-operand-large": operand(1e151),
        "lossless-overflow": operand(1e39),
        "lossless-binary64-of-none": changed(operations=(), double=True),
        "lossless-binary64-of-binary64": changed(width=64, double=True),
        "lossless-deviation-beyond": changed(deviations=beyond),
        "lossless-deviation-of-none": changed(deviations=misplaced),
        "lossless-numbers-cut": forging.forged(inches, EXAC=exact[: at + 9]),
    }


def refused():
    """Name and bytes of each file that must be refused."""
    h = encoded(meshes.icosphere(1), bits=8, anchors=3)
    c = encoded(meshes.icosphere(1), method="cartesian", bits=9)
    f = corrected_file()
    zero = encoded(meshes.icosphere(1), bits=0, anchors=3)
    x = encoded(meshes.icosphere(1), method="lossless")
    exact = payload_of(x, "EXAC")
    stream = exact_streams.unpack_formats(memoryview(exact))[2]
    s = encoded(meshes.union(meshes.crossing(), meshes.doubled()), method="cartesian")
    d = encoded(meshes.with_degenerate(), method="cartesian")
    k = encoded(meshes.seams(), method="cartesian")
    sections = read_container(h).sections
    connectivity, check = sections["CONN"], sections["CHEK"]
    another = encoded(meshes.torus(7, 6), bits=8, anchors=3)  # 42 vertices, too
    n, m = 42, 80
    damage = {
        "empty": b"",
        "truncated-in-magic": h[:5],
        "truncated-in-header": h[:14],
        "truncated-between-sections": h[: connectivity.offset],
        "truncated-in-section": h[: connectivity.offset + 9],
        "truncated-before-chek": h[: check.offset],
        "truncated-by-one-byte": h[:-1],
        "appended-byte": h + b"\n",
        "two-files": h + c,
        "flipped-in-header": flipped(h, 12),
        "flipped-in-id": flipped(h, connectivity.offset),
        "flipped-in-payload": flipped(h, connectivity.offset + 8, 3),
        "flipped-in-digest": flipped(h, check.offset + 7),
        "flipped-in-crc": flipped(h, len(h) - 1, 7),
        "text-transfer": h.replace(b"\r\n", b"\n"),
        "seven-bits": bytes(byte & 0x7F for byte in h),
        "a-png": b"\x89PNG\r\n\x1a\n" + bytes(20),
        "a-ply": b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n",
    }
    header = {
        "version-0": forging.with_header(h, version=0),
        "version-3": forging.with_header(h, version=3),
        "version-5": forging.with_header(h, version=5),
        "reserved-bit": forging.with_header(h, reserved=0x8000),
        "long-varint": long_varint(h),
        "terabytes": forging.forged(h, vertices=2**38, triangles=2**39),
        "too-many-faces": forging.forged(h, triangles=2**30),
        "too-many-isolated": forging.forged(c, vertices=2**25, parameters={"isolated": 2**25 - n}),
        "too-many-anchors": forging.forged(h, parameters={"anchor_count": n - 1}),
        "one-vertex-less": forging.forged(h, vertices=n - 1),
        "one-face-more": forging.forged(h, triangles=m + 1),
        "no-faces": forging.forged(h, triangles=0),
    }
    frames = {
        "conn-missing": with_section(h, "CONN", b""),
        "conn-twice": with_section(h, "CONN", 2 * raw_section(h, "CONN")[1]),
        "sections-exchanged": exchanged(h, "ANCH", "DELT"),
        "corrections-too-early": exchanged(f, "NORM", "FIXS"),
        "corrections-twice": with_section(f, "FIXS", 2 * raw_section(f, "FIXS")[1]),
        "corrections-of-cartesian": with_section(
            c, "CHEK", forging.section("FIXS", b"") + raw_section(c, "CHEK")[1]
        ),
        "method-of-the-other": with_parameter_bytes(h, 0, b"\1"),
        "unknown-required-section": with_section(
            h, "CHEK", forging.section("XTRA", b"?") + raw_section(h, "CHEK")[1]
        ),
        "unknown-method": with_parameter_bytes(h, 0, b"\7"),
        "unknown-anchor-method": with_parameter_bytes(h, 2, b"\3"),
        "step-nan": with_parameter_bytes(h, 4, np.float64("nan").tobytes()),
        "step-negative": with_parameter_bytes(h, 4, np.float64(-0.01).tobytes()),
        "step-huge": with_parameter_bytes(h, 4, np.float64(1.7e308).tobytes()),
        "origin-infinite": with_parameter_bytes(h, 12, np.float64("inf").tobytes()),
    }
    payloads = {
        "digest-wrong": forging.forged(h, checksum=bytes(8)),
        "connectivity-of-another": forging.forged(h, CONN=payload_of(another, "CONN")),
        "connectivity-empty": forging.forged(h, CONN=b""),
        "connectivity-noise": forging.forged(h, CONN=b"\0\0\0" + bytes(range(1, 30))),
        "connectivity-counts": forging.forged(h, CONN=b"\2\1\0" + payload_of(h, "CONN")[3:]),
        "connectivity-and-more": forging.forged(h, CONN=payload_of(h, "CONN") + b"\1"),
        "connectivity-and-zero": forging.forged(h, CONN=payload_of(h, "CONN") + b"\0"),
        "anchors-grid": forging.forged(h, ANCH=b"\37" + payload_of(h, "ANCH")[1:]),
        "anchors-noise": forging.forged(h, ANCH=payload_of(h, "ANCH")[:3] + bytes(range(9, 50))),
        "anchors-one-sided": one_sided_anchors(),
        "deltas-noise": forging.forged(h, DELT=bytes(range(1, 200))),
        "deltas-cut": forging.forged(h, DELT=payload_of(h, "DELT")[:-7]),
        "deltas-of-0-bits": forging.forged(h, parameters={"bits": 0, "step": 0.0}),
        "corrections-noise": forging.forged(f, FIXS=bytes(range(1, 200))),
        "corrections-dropped": with_section(f, "FIXS", b""),
        "corrections-of-0-bits": forging.forged(zero, FIXS=b""),
        "cartesian-noise": forging.forged(c, CART=bytes(range(1, 200))),
        "cartesian-and-more": forging.forged(c, CART=payload_of(c, "CART") + b"\1"),
        "lossless-width": forging.forged(x, EXAC=b"\x18" + exact[1:]),
        "lossless-base": forging.forged(x, EXAC=exact[:4] + b"\3" + exact[5:]),
        "lossless-cut-in-forms": forging.forged(x, EXAC=exact[:20]),
        "lossless-noise": forging.forged(x, EXAC=exact[:stream] + bytes(range(1, 200))),
        "lossless-and-more": forging.forged(x, EXAC=exact + b"\1"),
        "lossless-step": with_parameter_bytes(x, 4, np.float64(0.5).tobytes()),
        "lossless-bits": with_parameter_bytes(x, 3, b"\10"),
        "lossless-infinite": infinite(x),
        **wrongly_converted(),
    }
    kept = encoded(meshes.icosphere(1), method="cartesian", bits=9, keep_order=True)
    order = payload_of(kept, "ORDR")
    orders = {
        "order-empty": forging.forged(kept, ORDR=b""),
        "order-of-another-plan": forging.forged(kept, ORDR=b"\3" + order[1:]),
        "order-too-long": forging.forged(kept, ORDR=order[:1] + b"\x7f" + order[2:]),
        "order-noise": forging.forged(kept, ORDR=b"\5\x14" + bytes(range(1, 90))),
        "order-of-all-near": forging.forged(kept, ORDR=b"\2\2\1\1" + bytes([1] * 40)),
        "order-and-more": forging.forged(kept, ORDR=order + b"\1"),
        "order-of-another": forging.forged(kept, ORDR=backwards(c)),
        "order-misplaced": exchanged(kept, "CART", "ORDR"),
    }
    complexes = {
        "stitches-of-nothing": forging.forged(c, STCH=bytes((n, m, 0, 0))),
        "stitches-missing": with_section(s, "STCH", b""),
        "stitches-noise": forging.forged(s, STCH=payload_of(s, "STCH")[:4] + bytes(range(5, 60))),
        "stitches-cut": forging.forged(s, STCH=payload_of(s, "STCH")[:-2]),
        "stitches-and-more": forging.forged(s, STCH=payload_of(s, "STCH") + b"\1"),
        "stitches-counts": forging.forged(s, STCH=b"\1" + payload_of(s, "STCH")[1:]),
        "stitches-of-another": forging.forged(s, STCH=payload_of(d, "STCH")),
        "stitches-before-conn": exchanged(s, "CONN", "STCH"),
        "degenerate-noise": forging.forged(d, STCH=payload_of(d, "STCH")[:4] + bytes(range(99))),
        "copies-missing": with_section(k, "COPY", b""),
        "copies-of-nothing": forging.forged(c, COPY=bytes((n, 0))),
        "copies-noise": forging.forged(k, COPY=payload_of(k, "COPY")[:2] + bytes(range(7, 60))),
        "copies-cut": forging.forged(k, COPY=payload_of(k, "COPY")[:-2]),
        "copies-and-zero": forging.forged(k, COPY=payload_of(k, "COPY") + b"\0"),
        "copies-counts": forging.forged(k, COPY=b"\x01" + payload_of(k, "COPY")[1:]),
        "copies-too-many": forging.forged(k, vertices=2**27),
    }
    return damage | header | frames | payloads | orders | complexes | refused_polymeshes()


def refused_polymeshes():
    """Likewise, of polygons and parts; digests are right where something is decoded."""
    meshes_of = {name: (mesh, options) for name, mesh, options in golden_polymeshes.polymeshes()}

    def file_of(name):
        mesh, options = meshes_of[name]
        return encode_mesh(mesh, Options(method=name.split("-")[0], **options)).data

    q, n, k = map(file_of, ("cartesian-quads", "cartesian-ngons-listed", "cartesian-quads-order"))
    glue, listed, order = payload_of(q, "POLY"), payload_of(n, "POLY"), payload_of(k, "ORDR")
    p, text = file_of("cartesian-parts"), b"\1\2\1\1a\0\0"
    t = file_of("cartesian-parts-one")
    parts, one, two = payload_of(p, "PART"), payload_of(t, "PART"), b"\0\0"
    assert tuple(glue[:4]) == (20, 4, 4, 0)
    assert listed[:3] == b"\74\4\4"
    assert one == plain_block(b"\1\0\1\x09an object\0\0") + two
    unit = plain_block(b"\1" + np.eye(4).tobytes())
    small = zlib.compress(b"\0\0\1\x80\x08" + 1024 * b"b", 9)[2:-4]
    deflated = b"\1\x85\x08" + write_varint(len(small)) + small
    polygons = {
        "polygons-empty": forging.forged(q, POLY=b""),
        "polygons-missing": with_section(q, "POLY", b""),
        "polygons-twice": with_section(q, "POLY", 2 * raw_section(q, "POLY")[1]),
        "polygons-misplaced": exchanged(q, "POLY", "CART"),
        "polygons-of-nothing": forging.forged(q, POLY=bytes((40, 3, 3, 0))),
        "polygons-one-less": forging.forged(q, POLY=b"\x13" + glue[1:]),
        "polygons-of-size-two": forging.forged(q, POLY=b"\x14\2" + glue[2:]),
        "polygons-too-large": forging.forged(q, POLY=b"\x14\4\x2b" + glue[3:]),
        "polygons-least-too-low": forging.forged(q, POLY=b"\x14\3" + glue[2:]),
        "polygons-most-too-high": forging.forged(q, POLY=b"\x14\4\5" + glue[3:]),
        "polygons-listed-not-found": forging.forged(q, POLY=b"\x14\4\4\1" + glue[4:]),
        "polygons-listed-too-few": forging.forged(n, POLY=listed[:3] + b"\1" + listed[4:]),
        "polygons-noise": forging.forged(q, POLY=glue[:4] + bytes(range(9, 40))),
        "polygons-cut": forging.forged(n, POLY=listed[:-2]),
        "polygons-and-zero": forging.forged(q, POLY=glue + b"\0"),
        "polygons-order-cut": forging.forged(k, ORDR=order[:-1]),
        "polygons-order-noise": forging.forged(k, ORDR=order[:2] + bytes(range(9, 99))),
    }
    told = {
        "parts-empty": forging.forged(p, PART=b""),
        "parts-missing": with_section(p, "PART", b""),
        "parts-misplaced": exchanged(p, "CART", "PART"),
        "parts-cut": forging.forged(p, PART=parts[:-1]),
        "parts-and-more": forging.forged(p, PART=parts + b"\0"),
        "parts-noise": forging.forged(p, PART=parts[:80] + bytes(range(150, 250))),
        "parts-form": forging.forged(t, PART=b"\3" + one[1:]),
        "parts-of-nothing": forging.forged(t, PART=plain_block(b"\0\0\0")),
        "parts-text-cut": forging.forged(t, PART=plain_block(text[:-1]) + two),
        "parts-text-and-more": forging.forged(t, PART=plain_block(text + b"\0") + two),
        "parts-text-too-long": forging.forged(t, PART=b"\0\x81\x80\x80\x08" + text + two),
        "parts-of-kind-5": forging.forged(t, PART=plain_block(b"\1\5" + text[2:]) + two),
        "parts-reserved": forging.forged(t, PART=plain_block(b"\1\x22" + text[2:]) + two),
        "parts-kind-twice": forging.forged(t, PART=plain_block(b"\2" + 2 * text[1:5] + two)),
        "parts-key-twice": forging.forged(t, PART=plain_block(b"\0\2" + 2 * b"\1k\0" + b"\0")),
        "parts-no-utf-8": forging.forged(t, PART=plain_block(b"\0\0\1\1\xff")),
        "parts-of-no-faces": forging.forged(t, PART=plain_block(b"\1\2\0\0\0") + two),
        "parts-too-many-labels": forging.forged(t, PART=plain_block(text) + b"\1\x80\0"),
        "parts-labels-and-zero": forging.forged(t, PART=plain_block(text) + b"\1\0\0"),
        "parts-next-as-another": forging.forged(t, PART=plain_block(text) + b"\0\1\x80"),
        "parts-none-but-partly": forging.forged(
            t, PART=plain_block(b"\1\x0a" + text[2:]) + b"\0\1\x80"
        ),
        "parts-identity": forging.forged(t, PART=plain_block(b"\1\x12" + text[2:]) + two + unit),
        "parts-moved-too-many": forging.forged(
            t, PART=plain_block(b"\1\x12" + text[2:]) + two + plain_block(b"\2")
        ),
        "parts-deflate-and-more": forging.forged(
            t, PART=deflated[:3] + write_varint(len(small) + 1) + small + b"\0"
        ),
        "parts-deflate-too-short": forging.forged(t, PART=b"\1\x84\x08" + deflated[3:]),
        "parts-no-deflate": forging.forged(t, PART=b"\1\x09\2\xff\xff"),
        "parts-of-another": forging.forged(t, PART=plain_block(text) + two),
    }
    return polygons | told | refused_frames(t)


def refused_frames(data):
    """Of zstandard frames around the text of parts."""
    text = b"\0\0\1\x80\x08" + 1024 * b"b"
    n = len(text)
    good = zstd_frames.frame(text)
    # Descriptor 60: a single segment, and a size of two bytes, of which 256 is left off.
    assert good[:7] == zstd_frames.MAGIC + b"\x60" + struct.pack("<H", n - 256)
    magic, blocks = good[:4], good[7:]
    size = struct.pack("<I", n)
    checksum = b"\x31\xa2\x18\x9b"  # the low half of XXH64 of the text
    frames = {
        "no-frame": b"\xff" + good[1:],
        "frame-skippable": b"\x50\x2a\x4d\x18\0\0\0\0" + good,
        "frame-and-more": good + b"\0",
        "frame-and-skippable": good + b"\x50\x2a\x4d\x18\0\0\0\0",
        "frame-twice": good + zstd_frames.frame(b""),
        "frame-cut": good[:-1],
        "frame-cut-in-header": good[:6],
        "frame-of-magic": magic,
        "frame-without-size": magic + b"\0\x68" + blocks,
        "frame-of-window": magic + b"\x80\x69" + size + blocks,
        "frame-of-another-size": magic + b"\x60" + struct.pack("<H", n - 257) + blocks,
        "frame-of-more-than-size": magic + b"\xa0" + struct.pack("<I", n + 1) + blocks,
        "frame-with-checksum": magic + b"\x64" + good[5:] + checksum,
        "frame-with-dictionary": magic + b"\x61\0" + good[5:],
        "frame-reserved": magic + b"\x68" + good[5:],
        "frame-unused": magic + b"\x70" + good[5:],
        "frame-noise": good[:7] + bytes(range(150, 150 + len(blocks))),
    }
    made = {
        f"parts-{name}": forging.forged(data, PART=zstd_block(n, one))
        for name, one in frames.items()
    }
    # The frames are right: the blocks say other sizes, or are no smaller than what they hold.
    made["parts-frame-in-smaller-block"] = forging.forged(data, PART=zstd_block(n - 1, good))
    made["parts-frame-in-larger-block"] = forging.forged(data, PART=zstd_block(n + 1, good))
    raw = zstd_frames.frame(b"\0\0\1\1a")
    made["parts-frame-not-smaller"] = forging.forged(data, PART=zstd_block(5, raw))
    return made


def zstd_block(size, frame):
    return b"\2" + write_varint(size) + write_varint(len(frame)) + frame


def plain_block(data):
    return b"\0" + write_varint(len(data)) + data


def backwards(data):
    """The payload of an order that is right, but for the digest of the file."""
    mesh = decode(data)
    n, m = len(mesh.vertices), len(mesh.faces)
    order = Order(np.arange(n)[::-1].copy(), np.arange(m), np.ones(m, int))
    return encode_order(mesh.faces, plain(m), order)


def refused_steps():
    """Of steps by vertex; digests are right where something is decoded."""
    h, a, c = (
        stepped.file_of(f"{name}-steps{rest}").data
        for name, rest in (("highpass", ""), ("highpass", "-across"), ("cartesian", ""))
    )
    step, across, roots = payload_of(h, "STEP"), payload_of(a, "STEP"), payload_of(c, "CART")
    plain = encoded(meshes.icosphere(1), bits=8, anchors=3)
    zero = encoded(meshes.icosphere(1), bits=0, anchors=3)
    exact = encoded(meshes.icosphere(1), method="lossless")
    assert (step[0], step[1]) == (3, 0)
    assert roots[3] < 128
    return {
        "steps-empty": forging.forged(h, STEP=b""),
        "steps-missing": with_section(h, "STEP", b""),
        "steps-twice": with_section(h, "STEP", 2 * raw_section(h, "STEP")[1]),
        "steps-misplaced": exchanged(h, "STEP", "ANCH"),
        "steps-of-lossless": with_section(
            exact, "EXAC", forging.section("STEP", step) + raw_section(exact, "EXAC")[1]
        ),
        "steps-of-0-bits": forging.forged(zero, STEP=step),
        "steps-all-alike": forging.forged(plain, STEP=b"\1\0"),
        "steps-one-label": forging.forged(plain, STEP=b"\2\0\4"),
        "steps-too-fine": forging.forged(h, STEP=step[:3] + b"\x79" + step[4:]),
        "steps-exponent-twice": forging.forged(h, STEP=step[:3] + step[2:3] + step[4:]),
        "steps-no-coarsest": forging.forged(h, STEP=b"\3\1" + step[2:]),
        "steps-too-few": forging.forged(h, STEP=b"\2" + step[1:3] + step[4:]),
        "steps-too-many": forging.forged(h, STEP=b"\4" + step[1:4] + b"\1" + step[4:]),
        "steps-cut": forging.forged(a, STEP=across[:-1]),
        "steps-and-zero": forging.forged(h, STEP=step + b"\0"),
        "steps-noise": forging.forged(a, STEP=across[:11] + bytes(range(9, 40))),
        "steps-exchanged": forging.forged(h, STEP=step[:2] + step[3:1:-1] + step[4:]),
        "steps-roots-grid": forging.forged(c, CART=b"\37" + roots[1:]),
        "steps-roots-size": forging.forged(c, CART=roots[:3] + b"\x7f\x7f" + roots[4:]),
        "steps-roots-cut": forging.forged(c, CART=roots[:3] + bytes([roots[3] - 1]) + roots[4:]),
        "steps-roots-moved": moved_root(c),
        "steps-within-a-component": uneven(c),
        "parts-told-of-nothing": told(h, b"\0\0\1"),
        "parts-told-of-0": told(h, b"\1\0\0"),
        "parts-told-cut": told(h, b"\0\0\2" + bytes(12)),
        "parts-told-and-more": told(h, b"\1\0\1\0"),
        "parts-told-infinite": told(h, b"\0\0\2" + struct.pack("<fd", 0, math.inf) + b"\0"),
        "parts-told-unprintable": told(h, b"\0\0\2" + bytes(12) + b"\2\x1b["),
    }


def refused_cells():
    """Of what the cells of interpolated anchors have lost; digests are right where they matter."""
    h = encoded(meshes.icosphere(1), bits=8, anchors=3, **THROUGH)
    r = encoded(meshes.icosphere(1), method="refined", step=0.05, anchors=3)
    one = encoded(meshes.icosphere(1), bits=8, anchors=1, **THROUGH)
    plain = encoded(meshes.icosphere(1), bits=8, anchors=3)
    zero = encoded(meshes.icosphere(1), bits=0, anchors=3)
    c = encoded(meshes.icosphere(1), method="cartesian", bits=9)
    cells, both = payload_of(h, "CELL"), payload_of(r, "CELL")

    def added(data, name):
        """The file with these cells before a section."""
        return with_section(data, name, forging.section("CELL", cells) + raw_section(data, name)[1])

    return {
        "interpolated-of-0-bits": with_flags(zero, 4),
        "interpolated-cartesian": with_flags(c, 4),
        "interpolated-or-not": with_flags(h, 0),
        "cells-of-least-squares": forging.forged(plain, CELL=cells),
        "cells-of-cartesian": added(c, "meta"),
        "cells-of-one-anchor": forging.forged(one, CELL=cells),
        "cells-missing": with_section(h, "CELL", b""),
        "cells-twice": with_section(h, "CELL", 2 * raw_section(h, "CELL")[1]),
        "cells-too-early": exchanged(r, "NORM", "CELL"),
        "cells-after-corrections": cells_after_corrections(),
        "cells-empty": forging.forged(h, CELL=b""),
        "cells-without-a-unit": forging.forged(r, CELL=both[:1]),
        "cells-unit": forging.forged(h, CELL=b"\x41" + cells[1:]),
        "cells-second-unit": forging.forged(r, CELL=both[:1] + b"\xff" + both[2:]),
        "cells-another-unit": forging.forged(h, CELL=bytes([cells[0] ^ 1]) + cells[1:]),
        "cells-all-zero": forging.forged(h, CELL=cells[:1] + zero_vectors(3)),
        "cells-cut": forging.forged(r, CELL=both[:-1]),
        "cells-and-zero": forging.forged(r, CELL=both + b"\0"),
        "cells-noise": forging.forged(r, CELL=both[:2] + bytes(range(1, 60))),
        "cells-huge": huge_cells(),
    }


def refused_tables_of_frames():
    """Tables of frames that no encoder writes."""
    refined, cartesian = map(animated.file_of, ("refined-sequence", "cartesian-sequence"))
    bare = encoded(meshes.icosphere(1), bits=0, anchors=4)
    payload = payload_of(refined, "FRAM")
    damaged = bytearray(payload)
    damaged[-20] ^= 1
    first = animated.with_first
    maps = [bytes(frame.sections["MAPS"].payload) for frame in info(refined).frames]
    return {
        "frames-of-0-bits": forging.forged(bare, FRAM=payload),
        "frames-none": forging.forged(refined, FRAM=payload[:8] + b"\0"),
        "frames-more-than-bytes": forging.forged(refined, FRAM=payload[:8] + b"\x7f" + payload[9:]),
        "frames-cut": forging.forged(refined, FRAM=payload[:-1]),
        "frames-and-more": forging.forged(refined, FRAM=payload + b"\0"),
        "frames-damaged": forging.forged(refined, FRAM=bytes(damaged)),
        "frames-rate": animated.with_frames(refined, lambda frames: frames, rate=-1.0),
        "frames-key-first": first(refined, is_key=True),
        "frames-finer": first(refined, finer=31),
        "frames-step": first(refined, step=0.0),
        "frames-step-of-grid": first(cartesian, step=1.5),
        "frames-coarse": first(refined, coarse=0.5),
        "frames-error": first(refined, normal=math.inf),
        "frames-maps": first(refined, maps=1000),
        "frames-maps-cartesian": animated.with_frames(
            cartesian,
            lambda frames: [
                replace(frames[0], maps=1, sections={**frames[0].sections, **maps_of(maps[0])}),
                *frames[1:],
            ],
        ),
        "frames-unit": first(refined, unit=31),
    }


def maps_of(stream):
    return {"MAPS": Section("MAPS", 0, stream)}


def with_flags(data, flags):
    """The file with the bit of interpolated anchors as it is in these flags."""
    own = payload_of(data, "PARM")[1] & ~4
    return with_parameter_bytes(data, 1, bytes([own | flags]))


def zero_vectors(count):
    """A stream of so many vectors that are 0."""
    return encode_vectors(*without_edges(count), np.zeros((count, 3), dtype=np.int64))


def cells_after_corrections():
    one = encoded(meshes.grid(15, 15), anchors=2, **CORRECTED, **THROUGH)
    return exchanged(one, "CELL", "FIXS")


def huge_cells():
    """Nothing but vectors of cells, that are too large; the digest is right."""
    V, F = meshes.icosphere(1)
    data = encoded((V * 1e140, F), step=1e138, anchors=3, **THROUGH)
    container = read_container(data)
    integers = read_content(container, 10**9, 2**40).integers
    none = without_edges(len(integers.anchors))
    large = np.full((len(integers.anchors), 3), 2**20)
    return forging.consistent(forging.forged(data, CELL=b"\x40" + encode_vectors(*none, large)))


def told(data, tail):
    """The file with this after the source in `meta`."""
    return with_section(data, "meta", forging.section("meta", payload_of(data, "meta") + tail))


def moved_root(data):
    """A Cartesian file in which the root of a component is a step from where it is stored."""
    container = read_container(data)
    content = read_content(container, 10**9, 2**40)
    surface, integers = content.structure.surface, content.integers
    payload = payload_of(data, "CART")
    values = cartesian.from_roots(surface, integers)
    values[lowest(surface.labels)[1]] += 1
    start = 4 + payload[3]
    stream = encode_three(surface.elements, values)
    return forging.forged(data, CART=payload[:start] + stream)


def uneven(data):
    """A Cartesian file with an exponent more at one vertex, and the digest right."""
    container = read_container(data)
    content = read_content(container, 10**9, 2**40)
    surface, integers = content.structure.surface, content.integers
    exponents = integers.exponents.copy()
    exponents[5] += 1
    wrong = replace(integers, exponents=exponents)
    payload = steps.encode(surface, exponents)["STEP"]
    return forging.forged(data, STEP=payload, checksum=digest(surface.faces, NONE, wrong))


def write_refused():
    known = TABLE.read_text(encoding="utf-8").splitlines()[1:] if TABLE.exists() else []
    known = {row.split("\t")[0]: row for row in known}
    rows = ["file\terror\toffset\tmessage begins with"]
    files = refused() | refused_steps() | refused_cells() | posed.refused()
    for name, data in (files | refused_tables_of_frames()).items():
        if not is_missing(name, REFUSED):
            rows.append(known[name])
            continue
        try:
            decode(data)
        except (FormatError, LimitError) as error:
            offset = getattr(error, "offset", None)
            start = str(error).split(" (at byte")[0][:48].rstrip()
            where = "" if offset is None else str(offset)
            rows.append("\t".join((name, type(error).__name__, where, start)))
        else:
            raise AssertionError(f"{name} is not refused")
        (REFUSED / f"{name}.dmesh").write_bytes(data)
    TABLE.write_text("\n".join(rows) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--add", action="store_true", help="write only what is missing")
    add = parser.parse_args().add
    for folder in (GOLDEN, REFUSED):
        folder.mkdir(exist_ok=True)
        for path in () if add else folder.iterdir():
            path.unlink()
    write_golden()
    write_stepped()
    write_sequences()
    write_polymeshes()
    write_attributed()
    write_posed()
    write_refused()


if __name__ == "__main__":
    main()
