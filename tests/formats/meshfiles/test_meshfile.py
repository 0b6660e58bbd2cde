"""Mesh files of any format: names, streams, limits of formats, any bytes, the real files."""

from __future__ import annotations

import io
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path
from typing import get_args

import children
import meshes
import numpy as np
import pytest
from filetests import POINTS, again, read, refused
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import (
    mesh_bytes,
    mesh_format,
    read_mesh,
    write_mesh,
    written,
)
from deltamesh_formats.meshfiles.formats import (
    EXTENSIONS,
    FORMATS,
    READABLE,
    advice,
    format_of_beginning,
    written_format,
)
from deltamesh_formats.meshfiles.unread import ADVICE
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.kinds import KIND_WORDS, Kind
from deltamesh_formats.polymesh.mesh import Parts, PolyMesh, from_triangles

# Numbers without an end in binary, and magnitudes that a fixed number of decimals would lose;
# vertices 2 and 5 are isolated, vertex 4 repeats vertex 0.
V = np.array(
    [
        [1 / 3, -2 / 7, 1e-17],
        [np.pi * 1e9, 0.1, -1e-300],
        [5.0, 5.0, 5.0],
        [0.0, -1 / 9, 2.0**-40],
        [1 / 3, -2 / 7, 1e-17],
        [9.0, 9.0, 9.0],
    ]
)
F = np.array([[3, 1, 0], [0, 1, 4], [4, 3, 0]])
MESH = from_triangles(V, F)
SMALL = from_triangles(np.array(POINTS, dtype=float), np.array([[0, 1, 2], [2, 1, 3]]))
ROUNDED = V.astype(np.float32).astype(np.float64)
ONLY_READ = [one for name, one in READABLE.items() if name not in FORMATS]


@pytest.mark.parametrize("file_format", FORMATS)
def test_round_trip(file_format, tmp_path):
    path = tmp_path / f"mesh.{file_format.upper()}"
    lost = write_mesh(path, MESH)
    rounded = "positions beyond float32 (by up to 78)"
    losses = {"stl": ("vertices of no face", rounded), "glb": (rounded,), "gltf": (rounded,)}
    assert lost == losses.get(file_format, ())
    mesh = read_mesh(path)
    assert (mesh.format, mesh.vertices.dtype, mesh.triangles.dtype) == (
        file_format,
        float,
        np.int64,
    )
    assert mesh.vertices.flags.c_contiguous
    assert mesh.triangles.flags.c_contiguous
    assert mesh.precision == ("float32" if file_format in ("stl", "glb", "gltf") else "float64")
    if file_format == "stl":
        np.testing.assert_array_equal(mesh.vertices, ROUNDED[[3, 1, 0]])
        np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [2, 1, 2], [2, 0, 2]])
    else:
        np.testing.assert_array_equal(mesh.triangles, F)
        np.testing.assert_array_equal(
            mesh.vertices, ROUNDED if file_format in ("glb", "gltf") else V
        )


@pytest.mark.parametrize("file_format", FORMATS)
def test_files_and_paths_are_alike(file_format, tmp_path):
    path, stream = tmp_path / f"mesh.{file_format}", io.BytesIO()
    write_mesh(str(path), MESH)
    write_mesh(stream, MESH, file_format)
    assert path.read_bytes() == stream.getvalue() == mesh_bytes(MESH, file_format)
    with path.open("rb") as file:
        named = read_mesh(file)
    np.testing.assert_array_equal(named.vertices, read_mesh(path).vertices)


# Large offsets: millimetres at the size of the earth.

FAR = from_triangles(
    np.array(POINTS) * 1e-3 + [4_512_345.678, -5_200_000.123, 0.0], SMALL.triangles
)


@pytest.mark.parametrize("file_format", ["obj", "ply", "off"])
def test_large_offsets_keep_their_detail(file_format):
    np.testing.assert_array_equal(again(FAR, file_format).vertices, FAR.vertices)


def test_large_offsets_become_translations_in_glb():
    made = written(FAR, "glb")
    assert made.lost == ()
    np.testing.assert_allclose(read(made.data, "glb").vertices, FAR.vertices, rtol=0, atol=2e-9)


def test_large_offsets_do_not_fit_stl():
    assert written(FAR, "stl").lost == ("positions beyond float32 (by up to 0.18)",)


@pytest.mark.parametrize("file_format", ["stl", "glb"])
def test_float32_overflow_is_refused(file_format):
    with pytest.raises(MeshError, match="float32"):
        mesh_bytes(from_triangles(V * 1e200, F), file_format)


@pytest.mark.parametrize("file_format", FORMATS)
def test_a_mesh_without_faces_is_not_written(file_format):
    with pytest.raises(MeshError, match="without faces"):
        mesh_bytes(from_triangles(V, F[:0]), file_format)


@pytest.mark.parametrize("file_format", ["obj", "ply", "off"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_positions_that_are_not_finite_are_refused(file_format, bad):
    vertices = SMALL.vertices.copy()
    vertices[2, 1] = bad
    data = mesh_bytes(from_triangles(vertices, SMALL.triangles), file_format)
    refused(data, file_format, "vertex 2 is not finite")


# Names and formats


def test_format_by_name():
    assert mesh_format("a.b/c.PLY").name == "ply"
    assert mesh_format(Path("x.obj")).name == "obj"
    assert mesh_format("x.obj", "OFF").name == mesh_format("x", ".off").name == "off"


@pytest.mark.parametrize(
    ("name", "file_format", "message"),
    [
        ("a.foo", None, "a.foo: 'foo' is not a known mesh format: obj, ply, off, stl, glb, gltf"),
        ("a.obj", "step", "'step' is not read: a shape without triangles; gmsh makes them"),
        ("noname", None, "noname: .* give one of obj, ply, off, stl, glb"),
        (io.BytesIO(), None, "<stream>: .* give one of obj, ply, off, stl, glb"),
    ],
)
def test_unknown_formats(name, file_format, message):
    for attempt in (lambda: read_mesh(name, file_format), lambda: write_mesh(name, MESH, "x")):
        with pytest.raises(MeshError, match=r"not a known mesh format|give one of|is not read"):
            attempt()
    with pytest.raises(MeshError, match=message):
        mesh_format(name, file_format)


_PLY_READER = "deltamesh_formats.meshfiles.ply.reader.read"


def test_other_errors_pass(tmp_path, monkeypatch):
    with pytest.raises(FileNotFoundError):
        read_mesh(tmp_path / "absent.ply")
    with pytest.raises(FileNotFoundError):
        write_mesh(tmp_path / "absent" / "mesh.ply", MESH)
    for error in (MemoryError, KeyboardInterrupt, OSError):

        def fail(data, error=error):
            raise error

        monkeypatch.setattr(_PLY_READER, fail)
        with pytest.raises(error):
            read(b"", "ply")


def test_a_fault_of_a_reader_is_told_as_one(monkeypatch):
    def fail(data):
        raise ZeroDivisionError("oh")

    monkeypatch.setattr(_PLY_READER, fail)
    with pytest.raises(MeshError, match=r"not readable as PLY \(ZeroDivisionError: oh\)"):
        read(b"", "ply")


def test_importing_is_cheap():
    code = "import sys, deltamesh_formats.meshfiles.files\n"
    code += "assert not {'scipy', 'trimesh'} & {*sys.modules}"
    assert children.run([sys.executable, "-c", code]).returncode == 0


# The table of the formats


def test_importing_the_table_imports_no_format():
    code = "import sys, deltamesh_formats.meshfiles.formats; sys.exit('numpy' in sys.modules)"
    assert children.run([sys.executable, "-c", code]).returncode == 0


def test_names_and_extensions_are_unique():
    extensions = [extension for one in FORMATS.values() for extension in one.extensions]
    extensions += [extension for one in ONLY_READ for extension in one.extensions]
    assert len(extensions) == len(set(extensions)) == len(EXTENSIONS)
    assert not {*extensions} & {*ADVICE}
    assert all(name == one.name == one.extensions[0] for name, one in FORMATS.items())
    assert len({one.title for one in READABLE.values()}) == len(READABLE)
    assert all(one.write is None and written_format(one.name) is None for one in ONLY_READ)
    assert all(written_format(one.name) is one for one in FORMATS.values())


@pytest.mark.parametrize("extension", ADVICE)
def test_formats_that_are_not_read_have_advice(extension):
    assert advice(f".{extension.upper()}") == ADVICE[extension]
    with pytest.raises(MeshError) as caught:
        mesh_format(f"a.{extension}")
    assert str(caught.value) == f"a.{extension}: '{extension}' is not read: {ADVICE[extension]}"


@pytest.mark.parametrize("file_format", FORMATS)
def test_files_begin_as_the_table_says(rich, file_format):
    one = FORMATS[file_format]
    assert format_of_beginning(rich[file_format]) in (one, None)
    # JSON, whose numbers are binary.
    text = one.is_text or file_format == "gltf" or rich[file_format].startswith(b"solid")
    assert text == rich[file_format].isascii() == (b"\0" not in rich[file_format])


@pytest.mark.parametrize(
    ("beginning", "name"),
    [(b"ply\n", "ply"), (b"STOFF\n", "off"), (b"solid x", "stl"), (b"glTF\2", "glb"), (b"v 0", "")],
)
def test_formats_by_their_beginnings(beginning, name):
    found = format_of_beginning(beginning)
    assert ("" if found is None else found.name) == name


@pytest.mark.parametrize("file_format", FORMATS)
def test_files_hold_what_the_table_says(file_format):
    """Of a mesh with everything, what comes back and what is named as lost."""
    kinds = get_args(Kind)
    square = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]], dtype=float
    )
    moved = np.tile(np.eye(4), (2, 1, 1))
    moved[1, 0, 3] = 1
    parts = tuple(
        Parts(kind, (f"{kind} a", f"{kind} b"), np.arange(2), moved if kind == "object" else None)
        for kind in kinds
    )
    keys = ("comments", "obj_info", "mtllib", "header", "copyright")
    mesh = from_arrays(square, [[0, 1, 2, 3], [1, 4, 5, 2]])
    metadata = {key: (f"some {key}",) for key in keys} | {"units": ("inch",)}
    mesh = replace(mesh, parts=parts, metadata=metadata)
    one = FORMATS[file_format]
    # The words of an STL have no header; it has one where there are no names.
    bare = replace(mesh, parts=()) if file_format == "stl" else mesh
    found = again(mesh, file_format)
    assert {part.kind for part in found.parts} == {*one.parts}
    assert {*again(bare, file_format).metadata} == {*one.metadata}
    assert one.polygons == (found.sizes == 4).all()
    transforms = [part.transforms for part in found.parts if part.transforms is not None]
    assert one.transforms == bool(transforms)
    lost = written(mesh, file_format).lost
    assert ("transforms" in lost) != one.transforms
    assert ("polygons of more than three corners" in lost) != one.polygons
    assert {kind for kind in kinds if KIND_WORDS[kind] not in lost} == {*one.parts}


# Any bytes


@pytest.mark.parametrize("file_format", FORMATS)
def test_every_truncation_is_read_or_refused(file_format):
    whole = mesh_bytes(SMALL, file_format)
    for size in range(len(whole)):
        # Text can end within its last number, or before faces that OBJ announces nowhere.
        if file_format in ("obj", "off") and (faces := read_or_refused(whole[:size], file_format)):
            assert faces <= 2
        elif file_format not in ("obj", "off"):
            refused(whole[:size], file_format)


def read_or_refused(data: bytes, file_format: str) -> int:
    """Return the number of triangles that is read, 0 for a refusal."""
    try:
        mesh = read(data, file_format)
    except MeshError:
        return 0
    check_whole(mesh)
    return len(mesh.triangles)


RICH = """mtllib a.mtl
v 0 0 0 1 0 0
v 1 0 0 0 1 0
v 0 1 0 0 0 1
v 1 1 0 1 1 1
vt 0 0
vt 1 0
vt 0 1
vn 0 0 1
o first
usemtl red
f 1/1/1 2/2/1 3/3/1
o second
f 2/2/1 4/1/1 3/3/1
"""


@pytest.fixture(scope="module")
def rich():
    """A mesh with attributes and names as each format writes it."""
    mesh = read(RICH, "obj")
    return {file_format: mesh_bytes(mesh, file_format) for file_format in FORMATS}


@given(st.sampled_from([*FORMATS]), st.binary(max_size=80), st.data())
def test_arbitrary_bytes_are_read_or_refused(rich, file_format, noise, data):
    whole = rich[file_format]
    at = data.draw(st.integers(0, len(whole)))
    for raw in (noise, whole[:at] + noise + whole[at + len(noise) :]):
        read_or_refused(raw, file_format)


@given(st.sampled_from([*FORMATS]), st.data())
def test_texts_with_other_tokens_are_read_or_refused(rich, file_format, data):
    """Exchange, repeat and leave out tokens: what no bit of noise would hit upon."""
    tokens = rich[file_format].split(b" ")
    for _ in range(data.draw(st.integers(1, 3))):
        i, j = (data.draw(st.integers(0, len(tokens) - 1)) for _ in range(2))
        new = [tokens[j], tokens[i] + b" " + tokens[j], b"", b"-1", b"1e9", b"nan", b"1//"]
        tokens[i] = data.draw(st.sampled_from(new))
    read_or_refused(b" ".join(tokens), file_format)


def check_whole(mesh: PolyMesh) -> None:
    """What `PolyMesh` promises of its arrays."""
    n, c, p = len(mesh.vertices), len(mesh.corners), len(mesh.sizes)
    assert np.isfinite(mesh.vertices).all()
    assert mesh.sizes.min() >= 3
    assert mesh.offsets[-1] == c
    assert 0 <= mesh.corners.min() <= mesh.corners.max() < n
    for a in mesh.attributes:
        assert len(a.rows()) == {"vertex": n, "corner": c, "face": p}[a.domain]
        assert -1 <= a.rows().min() <= a.rows().max() < len(a.values)
    for part in mesh.parts:
        assert len(part.of_face) == p
        assert -1 <= part.of_face.min() <= part.of_face.max() < len(part.names)
    assert mesh.triangles.max() < n


LIES = {
    "ply": [
        b"ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
        b"property float z\nelement face %d\nproperty list uint int vertex_indices\n"
        b"end_header\n" % (form, n, m) + body
        for form in (b"ascii", b"binary_little_endian", b"binary_big_endian")
        for n, m in ((10**17, 1), (1, 10**17), (2**31, 2**31))
        for body in (b"", b"\xff" * 40, b"1 " * 30, b"4000000000 " * 30)
    ],
    "off": [
        b"OFF%s\n%s" % (binary, counts)
        for binary in (b"", b" BINARY")
        for counts in (b"99999999999 1 0\n0 0 0\n", b"1 99999999999 0\n0 0 0\n", b"\x7f" * 40)
    ],
    "stl": [bytes(80) + b"\xff\xff\xff\xff" + bytes(50)],
}


@pytest.mark.parametrize("file_format", LIES)
def test_counts_that_lie_allocate_nothing(file_format):
    for data in LIES[file_format]:
        tracemalloc.start()
        with pytest.raises(MeshError):
            read(data, file_format)
        assert tracemalloc.get_traced_memory()[1] < 1 << 20
        tracemalloc.stop()


# The real files

CLOUD = "a point cloud, which LAZ, Draco and pcodec compress"
REFUSED = {
    "edge/empty.ply": "it holds no mesh: no vertices and no faces",
    "edge/obj_empty.obj": "it holds no mesh: no vertices and no faces",
    "edge/stl_empty_bin.stl": "it holds no mesh: no vertices and no faces",
    "edge/ply_points_bin.ply": f"it holds 8 vertices but no faces: {CLOUD}",
    "edge/points_emptyface.ply": f"it holds 1024 vertices but no faces: {CLOUD}",
}

# Vertices, polygons, triangles, what else there is.
REAL = {
    "clean/spot.obj": (2930, 5856, 5856, "uv/corner"),
    "clean/pizza.obj": (24916, 49954, 49954, "uv/corner"),
    "clean/tank.obj": (24950, 44590, 44590, "normal/vertex object group material"),
    "clean/chair_model.obj": (3186, 12756, 12756, "uv/corner object material smoothing"),
    "clean/cow_ngon.obj": (2903, 3263, 5804, "normal/corner group smoothing"),
    "clean/sword_quad_dominant.obj": (22293, 22465, 44582, ""),
    "clean/cycloidal.ply": (21384, 43368, 43368, "colour/vertex colour/face"),
    "clean/featuretype.ply": (5096, 3476, 3476, "normal/vertex"),
    "clean/1002_tray_bottom.STL": (2216, 4520, 4520, "object"),
    "copyleft/bearing.stl": (12405, 24696, 24696, ""),
    "copyleft/face000_rangemap.ply": (
        85849,
        166259,
        166259,
        "flags/vertex quality/vertex flags/face quality/face",
    ),
    "copyleft/rgb_nefertiti.off": (10013, 20022, 20022, "colour/vertex"),
    "unstated/cube_40k.obj": (9261, 48000, 96000, ""),
    "unstated/bun_zipper.ply": (35947, 69451, 69451, "confidence/vertex intensity/vertex"),
    "unstated/horse.ply": (48485, 96966, 96966, "confidence/vertex colour/vertex"),
    "unstated/armadillo.obj": (43243, 86482, 86482, ""),
    "unstated/camelhead.off": (11381, 22704, 22704, ""),
    "edge/moebius.obj": (280, 224, 448, "smoothing"),
    "edge/dodecahedron_poly.obj": (20, 12, 36, "object"),
    "edge/negative_indices.obj": (8, 6, 12, "uv/corner normal/corner"),
    "edge/nancolor.obj": (8, 12, 12, "colour/vertex"),
    "edge/fuze.ply": (502, 1000, 1000, "colour/vertex colour/face uv/corner"),
    "edge/multi.ply": (4, 1, 2, "uv/vertex colour/vertex"),
    "edge/wuson_badheader.ply": (11184, 3732, 3732, "normal/vertex uv/vertex"),
    "edge/comments.off": (8, 6, 12, "colour/face"),
    "edge/inspired_quads_smooth.off": (1963, 1838, 3676, ""),
    "edge/fairing_cross_binary.off": (4983, 9762, 9762, ""),
    "edge/multibody.stl": (20, 32, 32, "object"),
}


def path_of(name):
    path = meshes.folder() / name
    if not path.exists():
        pytest.skip(f"no {path}: DELTAMESH_MESHES names the folder of larger meshes")
    return path


@pytest.mark.parametrize("name", REAL)
def test_real_files(name):
    mesh = read_mesh(path_of(name))
    check_whole(mesh)
    found = [f"{a.name}/{a.domain}" for a in mesh.attributes] + [p.kind for p in mesh.parts]
    counts = len(mesh.vertices), len(mesh.sizes), len(mesh.triangles)
    assert (*counts, " ".join(found)) == REAL[name]


@pytest.mark.parametrize("name", REFUSED)
def test_real_files_that_hold_no_mesh(name):
    path = path_of(name)
    with pytest.raises(MeshError) as caught:
        read_mesh(path)
    assert str(caught.value) == f"{path}: {REFUSED[name]}"


def test_every_real_file_is_read_or_refused_and_written_in_every_format():
    found = [p for p in sorted(meshes.folder().rglob("*")) if p.suffix[1:].lower() in EXTENSIONS]
    if not found:
        pytest.skip(f"no {meshes.folder()}: DELTAMESH_MESHES names the folder of larger meshes")
    for path in found:
        if path.relative_to(meshes.folder()).as_posix() in REFUSED or path.stat().st_size > 400_000:
            continue
        mesh = read_mesh(path)
        for file_format in FORMATS:
            back = again(mesh, file_format)
            assert len(back.triangles) == len(mesh.triangles), (path, file_format)
            first, second = (m.vertices[m.triangles].min(axis=1) for m in (mesh, back))
            if file_format != "glb":
                scale = np.abs(mesh.vertices).max()
                np.testing.assert_allclose(first, second, rtol=0, atol=1e-6 * scale)


def test_real_obj_positions_are_the_lines_of_the_file():
    path = path_of("clean/spot.obj")
    lines = [line.split()[1:4] for line in path.read_text().splitlines() if line[:2] == "v "]
    np.testing.assert_array_equal(read_mesh(path).vertices, np.array(lines, dtype=float))
