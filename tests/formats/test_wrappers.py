"""Compression around files: gzip and zstandard."""

from __future__ import annotations

import gzip
import tracemalloc
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats import wrappers, zstd_frames
from deltamesh_formats.errors import FormatError, LimitError, MeshError
from deltamesh_formats.meshfiles.files import read_mesh, write_mesh
from deltamesh_formats.polymesh.mesh import from_triangles

NOISE = np.random.default_rng(7).bytes(300_000)
TEXT = b"v 0.25 1 0.125\n" * 40_000
SKIPPABLE = b"\x5f\x2a\x4d\x18\3\0\0\0abc"


def stream(suffix: str, data: bytes) -> bytes:
    return wrappers.wrapped("a" + suffix, data)


@pytest.mark.parametrize("data", [b"", b"ply\n", TEXT, NOISE], ids=("none", "few", "text", "noise"))
@pytest.mark.parametrize("suffix", ["", ".gz", ".zst", ".GZ", ".Zst"])
def test_files_come_back(suffix: str, data: bytes) -> None:
    made = stream(suffix, data)
    assert (made == data) == (suffix == "")
    assert wrappers.unwrapped(made, len(data)) == data
    assert stream(suffix, data) == made


def test_streams_are_those_of_others() -> None:
    assert gzip.decompress(stream(".gz", TEXT)) == TEXT
    assert wrappers.unwrapped(gzip.compress(TEXT)) == TEXT
    assert zstd_frames.decompressor().decompress(stream(".zst", TEXT)) == TEXT


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
def test_streams_in_a_row_are_one_file(suffix: str) -> None:
    parts = [b"a", b"", NOISE, TEXT, *(bytes([i]) for i in range(200))]
    assert wrappers.unwrapped(b"".join(stream(suffix, one) for one in parts)) == b"".join(parts)


def test_skippable_frames_are_skipped() -> None:
    made = SKIPPABLE + stream(".zst", TEXT) + SKIPPABLE + stream(".zst", b"end")
    assert wrappers.unwrapped(made) == TEXT + b"end"


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
@pytest.mark.parametrize("more", [b"\0", b"v 0 0 0\n", b"\x1f\x8b", b"\x28\xb5\x2f"])
def test_what_follows_is_refused(suffix: str, more: bytes) -> None:
    made = stream(suffix, NOISE)
    with pytest.raises(FormatError, match=f"^{len(more)} bytes follow the ") as caught:
        wrappers.unwrapped(made + more)
    assert caught.value.offset == len(made)


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
@pytest.mark.parametrize("data", [TEXT, NOISE], ids=("text", "noise"))
def test_damage_is_refused(suffix: str, data: bytes) -> None:
    made = stream(suffix, data)
    for at in (12, len(made) // 2, len(made) - 1):
        with pytest.raises(FormatError, match="truncated: the file ends within its"):
            wrappers.unwrapped(made[:at])
    for at in (len(made) // 2, len(made) - 1):
        wrong = made[:at] + bytes([made[at] ^ 0x10]) + made[at + 1 :]
        with pytest.raises(FormatError, match=r"stream is damaged|truncated|follow"):
            wrappers.unwrapped(wrong)


@given(st.binary(max_size=200), st.sampled_from([b"\x1f\x8b\x08", zstd_frames.MAGIC]))
def test_anything_is_read_or_refused(data: bytes, magic: bytes) -> None:
    with suppress(FormatError, LimitError):
        assert len(wrappers.unwrapped(magic + data, 1 << 20)) <= 1 << 20
    with suppress(FormatError):
        assert len(wrappers.beginning(magic + data, 9)) <= 9


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
def test_a_bomb_is_refused_before_its_bytes_are_there(suffix: str) -> None:
    bomb, limit = 40 * stream(suffix, bytes(1 << 23)), 1 << 22
    tracemalloc.start()
    with pytest.raises(LimitError, match=f"more than the limit of {limit} bytes"):
        wrappers.unwrapped(bomb, limit)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 6 * limit
    whole = stream(suffix, bytes(limit))
    assert wrappers.unwrapped(whole, limit) == bytes(limit)
    with pytest.raises(LimitError):
        wrappers.unwrapped(whole, limit - 1)


@pytest.mark.parametrize("suffix", ["", ".gz", ".zst"])
def test_the_beginning_needs_the_beginning_only(suffix: str) -> None:
    made = stream(suffix, TEXT + NOISE)
    assert wrappers.beginning(made[: 1 << 18], 64) == TEXT[:64]
    assert wrappers.beginning(stream(suffix, b"ab"), 64) == b"ab"


def test_names() -> None:
    assert wrappers.without_wrapper("scan.ply.zst") == ("scan.ply", ".zst")
    assert wrappers.without_wrapper("a.gz/scan.PLY.GZ") == ("a.gz/scan.PLY", ".GZ")
    assert wrappers.without_wrapper("a.gz/scan.ply") == ("a.gz/scan.ply", "")
    assert wrappers.without_wrapper(".gz") == (".gz", "")


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
@pytest.mark.parametrize("extension", ["ply", "obj", "stl", "off", "glb"])
def test_meshes_are_read_and_written(tmp_path: Path, extension: str, suffix: str) -> None:
    mesh = from_triangles(np.eye(4, 3), np.array([[0, 1, 2], [0, 3, 1]]))
    write_mesh(tmp_path / f"a.{extension}", mesh)
    write_mesh(tmp_path / f"a.{extension}{suffix}", mesh)
    plain, packed = (tmp_path / f"a.{extension}{one}" for one in ("", suffix))
    assert wrappers.unwrapped(packed.read_bytes()) == plain.read_bytes() != packed.read_bytes()
    again = read_mesh(packed)
    assert again.format == extension
    assert again.vertices.tolist() == read_mesh(plain).vertices.tolist()
    with packed.open("rb") as file:
        assert read_mesh(file, extension).faces.tolist() == again.faces.tolist()
    packed.write_bytes(packed.read_bytes()[:-1])
    with pytest.raises(MeshError, match=rf"a\.{extension}\{suffix}: truncated: the file ends"):
        read_mesh(packed)


def test_a_file_object_gets_the_bytes_as_they_are(tmp_path: Path) -> None:
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    with gzip.open(tmp_path / "a.off.gz", "wb") as file:
        write_mesh(file, mesh)
    assert gzip.decompress((tmp_path / "a.off.gz").read_bytes()).startswith(b"OFF")
    with gzip.open(tmp_path / "a.off.gz") as file:
        assert len(read_mesh(file).vertices) == 3


@pytest.mark.parametrize(("suffix", "title"), [(".gz", "gzip"), (".zst", "zstandard")])
def test_streams_that_are_cut_before_their_first_byte_are_truncated(
    suffix: str, title: str
) -> None:
    """Nothing has come, which is not the same as a file with nothing in it."""
    made = stream(suffix, NOISE)
    for size in (4, 9):
        for partial in (False, True):
            with pytest.raises(FormatError, match=f"^truncated: the file ends within its {title}"):
                wrappers.unwrapped(made[:size], partial=partial)
    whole = wrappers.unwrapped(made[:200_000], partial=True)
    assert whole == NOISE[: len(whole)]
    assert len(whole) > 100_000
    assert wrappers.unwrapped(stream(suffix, b""), partial=True) == b""
