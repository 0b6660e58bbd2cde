"""Paths, file objects and bytes: `.dmesh` files come from anywhere and go anywhere."""

from __future__ import annotations

import io
import mmap
import os
import pickle
import threading
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh._sources import bytes_of, read_file, read_source

MESH = deltamesh.from_arrays(*meshes.torus(9, 7))
DATA = deltamesh.encode(MESH, bits=8)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "tör us.dmesh"
    found.write_bytes(DATA)
    return found


def same(source: object, function: Callable[..., deltamesh.PolyMesh] = deltamesh.load) -> None:
    mesh = function(source)
    np.testing.assert_array_equal(mesh.vertices, deltamesh.decode(DATA).vertices)
    np.testing.assert_array_equal(mesh.faces, deltamesh.decode(DATA).faces)


@pytest.mark.parametrize(
    "buffer", [bytes, bytearray, memoryview, lambda data: np.frombuffer(data, np.int8)]
)
@pytest.mark.parametrize("function", ["info", "verify", "decode"])
def test_bytes_of_any_kind(buffer: type, function: str) -> None:
    made = getattr(deltamesh, function)(buffer(DATA))
    assert isinstance(made, deltamesh.PolyMesh) or made.size == len(DATA)


@pytest.mark.parametrize("function", ["info", "verify", "load"])
def test_paths_and_files(path: Path, function: str) -> None:
    for name in (path, str(path), io.BytesIO(DATA)):
        made = getattr(deltamesh, function)(name)
        assert isinstance(made, deltamesh.PolyMesh) or made.size == len(DATA)


def test_load_and_decode_name_each_other(path: Path) -> None:
    for wrong in (DATA, bytearray(DATA), memoryview(DATA)):
        with pytest.raises(TypeError, match="decode takes bytes"):
            deltamesh.load(wrong)
    for wrong in (path, str(path), io.BytesIO(DATA)):
        with pytest.raises(TypeError, match="load takes a path or a file"):
            deltamesh.decode(wrong)


def test_a_wrong_keyword_is_refused_before_anything_is_read_or_written(tmp_path: Path) -> None:
    nowhere, target = tmp_path / "none.dmesh", io.BytesIO()
    for function in (deltamesh.load, deltamesh.verify):
        with pytest.raises(TypeError, match="max_vertex"):
            function(nowhere, max_vertex=3)
    with pytest.raises(TypeError, match="qualty"):
        deltamesh.save(target, MESH, qualty=3)
    with pytest.raises(TypeError, match="qualty"):
        deltamesh.save(nowhere, MESH, qualty=3)
    assert target.getvalue() == b""
    assert not list(tmp_path.iterdir())


def test_files_from_where_they_are(path: Path) -> None:
    path.write_bytes(b"before" + DATA)
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as whole:
        stream.seek(6)
        same(stream)
        same(memoryview(whole)[6:].tobytes(), deltamesh.decode)


def test_pipes_that_cannot_be_sought() -> None:
    for buffering in (-1, 0):
        reading, writing = os.pipe()
        target = os.fdopen(writing, "wb", buffering)

        def send(target: io.IOBase = target) -> None:
            with target:
                deltamesh.save(target, MESH, bits=8)

        sender = threading.Thread(target=send)
        sender.start()
        with os.fdopen(reading, "rb", buffering) as source:
            assert deltamesh.info(source).size == len(DATA)
        sender.join()


class Small(io.RawIOBase):
    """A file that takes seven bytes at a time."""

    def __init__(self) -> None:
        self.taken = b""

    def write(self, data: memoryview) -> int:
        self.taken += bytes(data[:7])
        return min(len(data), 7)


def test_a_file_that_takes_parts_gets_them_all() -> None:
    target = Small()
    deltamesh.save(target, MESH, bits=8)
    assert target.taken == DATA
    parts, whole = Small(), io.BytesIO()
    for one in (parts, whole):
        deltamesh.write_mesh(one, MESH, "ply")
    assert parts.taken == whole.getvalue()


def test_save_to_a_path_or_a_file_writes_the_same(tmp_path: Path) -> None:
    target = io.BytesIO()
    deltamesh.save(target, MESH, bits=8)
    deltamesh.save(tmp_path / "ü.dmesh", MESH, bits=8)
    assert target.getvalue() == (tmp_path / "ü.dmesh").read_bytes() == DATA
    assert [each.name for each in tmp_path.iterdir()] == ["ü.dmesh"]


def test_what_is_neither_is_refused_before_any_work(path: Path) -> None:
    for wrong in (3, None, [1, 2], np.zeros((4, 4))[:, ::2]):
        for function in (deltamesh.info, deltamesh.verify):
            with pytest.raises(TypeError, match="a path, a binary file or bytes are needed"):
                function(wrong)
        with pytest.raises(TypeError, match="a path or a binary file is needed"):
            deltamesh.load(wrong)
    for wrong in (3, None, [1, 2], np.zeros((4, 4))[:, ::2]):
        with pytest.raises(TypeError, match="bytes are needed, not"):
            deltamesh.decode(wrong)
    with path.open(encoding="latin-1") as text, pytest.raises(TypeError, match="binary mode"):
        deltamesh.load(text)
    with pytest.raises(TypeError, match="binary mode"):
        deltamesh.save(io.StringIO(), None)
    with pytest.raises(FileNotFoundError):
        deltamesh.info(path.with_name("none.dmesh"))
    with pytest.raises(deltamesh.MeshError, match="str without faces"):
        deltamesh.save(io.BytesIO(), "torus")


def test_save_writes_no_dmesh_under_the_name_of_a_mesh_file(tmp_path: Path) -> None:
    with pytest.raises(deltamesh.OptionError, match=r"save writes \.dmesh, write_mesh writes PLY"):
        deltamesh.save(tmp_path / "torus.PLY", MESH)
    assert not list(tmp_path.iterdir())


def test_meshes_and_what_is_known_of_files_go_to_other_processes(path: Path) -> None:
    for copy in (deepcopy, lambda value: pickle.loads(pickle.dumps(value))):
        mesh = copy(deltamesh.load(path))
        np.testing.assert_array_equal(mesh.faces, deltamesh.load(path).faces)
        assert mesh == mesh
        assert mesh != deltamesh.load(path)
        known = copy(deltamesh.info(path))
        assert known == deltamesh.info(path)
        assert known.sections["CONN"].payload == deltamesh.info(path).sections["CONN"].payload


def test_mesh_files_have_a_door(tmp_path: Path) -> None:
    assert deltamesh.write_mesh(tmp_path / "torus.ply", MESH) == ()
    np.testing.assert_array_equal(deltamesh.read_mesh(tmp_path / "torus.ply").faces, MESH.faces)


@pytest.mark.parametrize("reader", [bytes_of, read_source])
def test_bytes_are_read_without_a_copy(reader) -> None:
    data = bytearray(b"0123456789abcdef")
    for view in (data, memoryview(data)[8:], np.frombuffer(data, dtype=np.uint16)):
        found = reader(view)
        assert bytes(found) == bytes(memoryview(view).cast("B"))
    found = reader(data)
    data[0] = ord("x")
    assert found[0] == ord("x")


def test_read_file_takes_paths_and_binary_files_only(tmp_path: Path) -> None:
    path = tmp_path / "some"
    path.write_bytes(b"whole")
    assert read_file(path) == read_file(str(path)) == read_source(path) == b"whole"
    with path.open("rb") as stream:
        stream.read(2)
        assert read_file(stream) == b"ole"
    with path.open() as text, pytest.raises(TypeError, match="binary mode"):
        read_file(text)
    with pytest.raises(TypeError, match="not bytes: decode takes bytes"):
        read_file(b"whole")
    for nothing in (7, None, [b"a"]):
        with pytest.raises(TypeError, match="a path, a binary file or bytes are needed"):
            read_source(nothing)
        with pytest.raises(TypeError, match="bytes are needed"):
            bytes_of(nothing)
    with pytest.raises(FileNotFoundError):
        read_source(tmp_path / "nothing")
