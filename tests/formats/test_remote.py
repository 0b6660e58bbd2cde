"""Files at URLs: in memory, on a server of HTTP, and on this machine."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from cubes import OBJ, is_cube
from filetests import exact
from servers import Files, served

import deltamesh
from deltamesh_formats import places, remote
from deltamesh_formats.atomic import write_file
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.beside import in_folder, read_with
from deltamesh_formats.meshfiles.files import read_mesh, write_mesh, written

fsspec = pytest.importorskip("fsspec")


@pytest.fixture
def store() -> Iterator[str]:
    """A folder of the file system in memory, empty."""
    fs = fsspec.filesystem("memory")
    fs.store.clear()
    fs.pseudo_dirs[:] = [""]
    yield "memory://shop"
    fs.store.clear()


@pytest.fixture
def server() -> Iterator[tuple[str, Files]]:
    pytest.importorskip("aiohttp")
    with served() as found:
        yield found


def names(store: str) -> list[str]:
    return sorted(fsspec.filesystem("memory").store)


@pytest.mark.parametrize(
    ("name", "is_url"),
    [
        ("s3://bucket/a.ply", True),
        ("HTTP://host/a.ply", True),
        ("abfs+x://a", True),
        ("C://a.ply", False),
        ("c:\\a.ply", False),
        ("a.ply", False),
        ("/a://b", False),
        ("://a", False),
        ("-", False),
        (Path("a.ply"), False),
        (b"s3://a", False),
        (None, False),
    ],
)
def test_what_is_a_url(name: object, is_url: bool) -> None:
    assert remote.is_url(name) is is_url


def test_what_follows_the_path_of_http_is_no_extension() -> None:
    assert remote.without_query("https://h/a.ply.gz?x=b.obj#c") == "https://h/a.ply.gz"
    assert remote.without_query("s3://b/a?.ply") == "s3://b/a?.ply"
    assert remote.without_query("a?.ply") == "a?.ply"


# ---- In memory: written aside, and moved --------------------------------------------------------


def test_a_file_is_written_and_read(store: str) -> None:
    url = f"{store}/deep/a.bin"
    assert not remote.exists(url)
    write_file(url, b"one")
    assert (places.read_bytes(url), places.read_head(url, 2)) == (b"one", b"on")
    size, first = places.status(url)
    assert size == 3
    write_file(url, b"three")
    size, second = places.status(url)
    assert size == 5
    assert first is not None
    assert second is not None
    assert first <= second
    with pytest.raises(FileExistsError) as caught:
        write_file(url, b"four", overwrite=False)
    assert caught.value.filename == url
    assert names(store) == ["/shop/deep/a.bin"]
    assert remote.is_folder(f"{store}/deep")
    with pytest.raises(IsADirectoryError):
        remote.status(f"{store}/deep")


def test_a_file_is_there_whole_or_not_at_all(store: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What happens to the file while it is written: bytes go to another name first."""
    url, fs = f"{store}/a.bin", fsspec.filesystem("memory")
    write_file(url, b"old")
    seen: list[tuple[str, bytes]] = []
    pipe = type(fs).pipe_file

    def spied(self: object, path: str, value: bytes, **more: object) -> None:
        pipe(self, path, value, **more)
        seen.append((path, remote.read(url)))

    monkeypatch.setattr(type(fs), "pipe_file", spied)
    write_file(url, b"new")
    ((aside, meanwhile),) = seen
    assert aside.startswith("/shop/.deltamesh-")
    assert meanwhile == b"old"
    assert remote.read(url) == b"new"

    def broken(self: object, path: str, value: bytes, **more: object) -> None:
        pipe(self, path, value[:1], **more)
        raise OSError("the line is cut")

    monkeypatch.setattr(type(fs), "pipe_file", broken)
    with pytest.raises(OSError, match="the line is cut"):
        write_file(url, b"more")
    assert remote.read(url) == b"new"
    assert names(store) == ["/shop/a.bin"]


def test_one_that_appears_meanwhile_stays(store: str, monkeypatch: pytest.MonkeyPatch) -> None:
    url, fs = f"{store}/a.bin", fsspec.filesystem("memory")
    pipe = type(fs).pipe_file

    def late(self: object, path: str, value: bytes, **more: object) -> None:
        pipe(self, path, value, **more)
        pipe(self, "/shop/a.bin", b"theirs")

    monkeypatch.setattr(type(fs), "pipe_file", late)
    with pytest.raises(FileExistsError):
        write_file(url, b"ours", overwrite=False)
    assert remote.read(url) == b"theirs"
    assert names(store) == ["/shop/a.bin"]


def test_folders_and_patterns(store: str) -> None:
    remote.make_folder(f"{store}/new/deep")
    assert remote.is_folder(f"{store}/new/deep")
    for name in ("a.ply", "b.obj", "deep/c.ply"):
        remote.write(f"{store}/{name}", b"x", overwrite=True)
    below = [f"memory:///shop/{name}" for name in ("a.ply", "b.obj", "deep/c.ply")]
    assert remote.files_below(store) == below
    assert remote.matching(f"{store}/*.ply") == below[:1]
    assert remote.matching(f"{store}/**/*.ply")[-1] == below[2]
    assert remote.read(below[2]) == b"x"
    assert remote.files_below(store, recursive=False) == below[:2]


def test_meshes_and_their_buffers(store: str) -> None:
    cube = read_mesh(io.BytesIO(OBJ.encode()), "obj")
    assert write_mesh(f"{store}/a.obj.gz", cube) == ()
    assert remote.read(f"{store}/a.obj.gz")[:2] == b"\x1f\x8b"
    assert is_cube(read_mesh(f"{store}/a.obj.gz"))
    deltamesh.save(f"{store}/a.dmesh", cube, method="lossless")
    assert is_cube(deltamesh.load(f"{store}/a.dmesh"))
    assert deltamesh.info(f"{store}/a.dmesh").vertices == 8
    tree = json.loads(written(cube, "gltf").data)
    uri = tree["buffers"][0]["uri"]
    buffer = fsspec.filesystem("data").cat_file(uri)
    tree["buffers"][0]["uri"] = "data/b.bin"
    remote.write(f"{store}/data/b.bin", buffer, overwrite=True)
    remote.write(f"{store}/a.gltf", json.dumps(tree).encode(), overwrite=True)
    assert is_cube(read_mesh(f"{store}/a.gltf"))
    assert [*read_with(f"{store}/a.gltf")] == [f"{store}/data/b.bin"]
    for name, message in (("../a", "outside"), ("/a", "outside"), ("no.bin", "not there")):
        with pytest.raises(MeshError, match=message):
            in_folder(f"{store}/data")(name, 5)
    assert in_folder(store)("data/b.bin", 5) == buffer[:5]


class Store:
    """A store of objects that notes what it is asked."""

    def __init__(self, protocol: str | tuple[str, ...], has: tuple[str, ...] = ()) -> None:
        self.protocol, self.has = protocol, has
        self.asked: list[tuple[str, dict[str, object]]] = []

    def exists(self, path: str) -> bool:
        return path in self.has

    def pipe_file(self, path: str, data: bytes, **options: object) -> None:
        self.asked.append((path, options))


@pytest.mark.parametrize(
    ("protocol", "options"),
    [(("s3", "s3a"), {"mode": "create"}), ("gs", {"mode": "create"}), (("abfs", "az"), {})],
)
def test_a_store_of_objects_takes_a_file_at_once(
    protocol: str | tuple[str, ...], options: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    fs = Store(protocol, has=("b/old",))
    monkeypatch.setattr(remote, "_store", lambda url: (fs, url.partition("://")[2]))
    remote.write("s3://b/new", b"x", overwrite=False)
    remote.write("s3://b/old", b"x", overwrite=True)
    with pytest.raises(FileExistsError):
        remote.write("s3://b/old", b"x", overwrite=False)
    remote.make_folder("s3://b/c")  # which would be a bucket
    assert fs.asked == [("b/new", options), ("b/old", {})]


# ---- HTTP ---------------------------------------------------------------------------------------


def test_a_server_is_read_and_written(server: tuple[str, Files]) -> None:
    url, files = server
    files["in/a.obj"] = OBJ.encode()
    assert is_cube(read_mesh(f"{url}/in/a.obj"))
    assert is_cube(read_mesh(f"{url}/in/a.obj?version=2"))
    assert places.status(f"{url}/in/a.obj") == (len(OBJ), None)
    assert places.read_head(f"{url}/in/a.obj", 5) == OBJ[:5].encode()
    assert remote.exists(f"{url}/in/a.obj")
    assert not remote.exists(f"{url}/in/b.obj")
    write_file(f"{url}/out/b.bin", b"bytes", overwrite=False)
    assert files["out/b.bin"] == b"bytes"
    with pytest.raises(FileExistsError):
        write_file(f"{url}/out/b.bin", b"other", overwrite=False)
    write_file(f"{url}/out/b.bin", b"third")
    assert files["out/b.bin"] == b"third"
    assert sorted(files) == ["in/a.obj", "out/b.bin"]
    assert remote.files_below(f"{url}/in/") == [f"{url}/in/a.obj"]


def test_faults_of_a_server_are_errors_of_the_system(server: tuple[str, Files]) -> None:
    url, _ = server
    with pytest.raises(FileNotFoundError) as caught:
        read_mesh(f"{url}/no.obj")
    assert caught.value.filename == f"{url}/no.obj"
    with served(writable=False) as (closed, files), pytest.raises(OSError, match="403"):
        write_file(f"{closed}/a.bin", b"x")
    assert files == {}
    with pytest.raises(OSError, match="127"):  # it is closed by now
        remote.read(f"{closed}/a.bin")


# ---- Others -------------------------------------------------------------------------------------


def test_files_of_this_machine_are_written_as_paths_are(tmp_path: Path) -> None:
    path = tmp_path / "a b.bin"
    url = f"file://{path.as_posix()}"
    path.write_bytes(b"old")
    path.chmod(0o640)
    write_file(url, b"new")
    assert path.read_bytes() == remote.read(url) == b"new"
    if os.name == "posix":
        assert path.stat().st_mode & 0o777 == 0o640
    assert [one.name for one in tmp_path.iterdir()] == ["a b.bin"]
    assert remote.local_path("memory://a") is None


def test_stores_that_are_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(OSError, match="Protocol not known: nothing") as caught:
        read_mesh("nothing://a.ply")
    assert caught.value.filename == "nothing://a.ply"
    for module in ("fsspec", "fsspec.core"):
        monkeypatch.setitem(sys.modules, module, None)
    message = exact("fsspec reads and writes URLs: pip install 'deltamesh[remote]'")
    with pytest.raises(OSError, match=message):
        read_mesh("s3://bucket/a.ply")
    with pytest.raises(OSError, match=message):
        write_file("memory://a.ply", b"")


def test_a_package_of_a_store_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "s3fs", None)
    with pytest.raises(OSError, match="s3fs"):
        remote.read("s3://bucket/a.ply")


def test_names_in_folders_and_stores() -> None:
    assert places.joined("s3://b/c/", os.path.join("d", "a.ply")) == "s3://b/c/d/a.ply"
    assert places.joined("out", "a.ply") == os.path.join("out", "a.ply")
    assert places.parent("http://h/d/a.ply?x/y") == "http://h/d"
    assert places.base_name("http://h/d/a.ply?x/y") == "a.ply"
    assert places.path_below("s3://b/c/../a.ply") == os.path.join("b", "a.ply")
    assert places.absolute("s3://b/a") == "s3://b/a"
    assert places.absolute("a") == os.path.abspath("a")
    assert (places.parent("a.ply"), places.base_name("d/a.ply")) == ("", "a.ply")
