"""Commands on files that are compressed around."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import children
import pytest
from commandline import PROGRAM, TORUS, cli

import deltamesh
from deltamesh_formats.errors import LimitError, OptionError
from deltamesh_formats.wrappers import unwrapped, wrapped

FAST = "--method cartesian --bits 8"


@pytest.fixture
def packed(folder: Path) -> Path:
    """The folder with the torus compressed, plain and encoded."""
    for name in ("torus.ply", "torus.dmesh"):
        for suffix in (".gz", ".zst"):
            (folder / (name + suffix)).write_bytes(
                wrapped(name + suffix, (folder / name).read_bytes())
            )
    return folder


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
def test_a_mesh_is_encoded_and_decoded_as_without(packed: Path, suffix: str) -> None:
    assert cli(f"encode -q torus.ply plain.dmesh {FAST}") == 0
    plain = Path("plain.dmesh").read_bytes()
    assert cli(f"encode -q torus.ply{suffix} {FAST}") == 0
    assert Path(f"torus.ply{suffix}.dmesh").read_bytes() == plain
    assert cli(f"encode -q torus.ply out.dmesh{suffix} {FAST}") == 0
    assert unwrapped(Path(f"out.dmesh{suffix}").read_bytes()) == plain
    assert cli("decode -q plain.dmesh plain.ply") == 0
    assert cli(f"decode -q -f torus.ply{suffix}.dmesh") == 0
    assert cli(f"decode -q out.dmesh{suffix} x.ply") == 0
    made = Path("plain.ply").read_bytes()
    assert unwrapped(Path(f"torus.ply{suffix}").read_bytes()) == made
    assert len(Path(f"torus.ply{suffix}").read_bytes()) < len(made)
    assert Path("x.ply").read_bytes() == made


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("torus.ply.zst.dmesh", "", "torus.ply.zst"),
        ("torus.ply.dmesh.zst", "", "torus.ply"),
        ("torus.DMESH.GZ", "", "torus.ply"),
        ("torus.zst.dmesh", "", "torus.ply.zst"),
        ("torus.ply.gz.dmesh", "--output-format obj", "torus.obj.gz"),
        ("torus.dmesh", "x.off.zst", "x.off.zst"),
        ("torus.dmesh", "x.gz --output-format off", "x.gz"),
    ],
)
def test_names_of_decoded_files(
    folder: Path, torus_dmesh: bytes, name: str, arguments: str, expected: str
) -> None:
    Path("torus.ply").unlink()
    Path("torus.dmesh").unlink()
    Path(name).write_bytes(wrapped(name, torus_dmesh))
    assert cli("decode -q", name, *arguments.split()) == 0
    assert {path.name for path in folder.iterdir()} == {name, expected}
    data = Path(expected).read_bytes()
    assert (unwrapped(data) != data) == expected.endswith((".gz", ".zst"))


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
def test_pipes_are_known_by_their_first_bytes(packed: Path, suffix: str) -> None:
    def piped(name: str, *arguments: str) -> bytes:
        with open(name, "rb") as stdin:
            return bytes(children.run([*PROGRAM, *arguments], stdin=stdin, check=True).stdout)

    encode = ("encode", "-", "--input-format", "ply", *FAST.split())
    assert piped(f"torus.ply{suffix}", *encode) == piped("torus.ply", *encode)
    decode = ("decode", "-", "--output-format", "off")
    assert piped(f"torus.dmesh{suffix}", *decode) == piped("torus.dmesh", *decode)


def test_all_commands_read_them(packed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("test torus.dmesh.gz torus.dmesh.zst") == 0
    assert cli("info torus.dmesh.zst") == 0
    assert "2592 vertices" in capsys.readouterr().out.replace(",", "")
    assert cli("compare --json torus.ply.gz torus.dmesh.zst") == 0
    compared = json.loads(capsys.readouterr().out)
    assert compared["b"]["bytes"] == Path("torus.dmesh.zst").stat().st_size
    assert cli(f"bench torus.ply.zst {FAST} --save rates.csv.gz") == 0
    assert gzip.decompress(Path("rates.csv.gz").read_bytes()).startswith(b"mesh,codec")
    assert cli(f"bench torus.ply.zst {FAST} --check rates.csv.gz") == 0


def test_a_batch_finds_them(folder: Path) -> None:
    Path("scans").mkdir()
    for name in ("a.ply", "a.ply.zst", "b.PLY.gz", "c.txt.gz", "d.gz"):
        Path("scans", name).write_bytes(wrapped(name, TORUS.read_bytes()))
    assert cli(f"batch -q -r scans --output-dir-mirror packed {FAST}") == 0
    made = sorted(path.name for path in Path("packed").rglob("*.*"))
    assert made == ["a.ply.dmesh", "a.ply.zst.dmesh", "b.PLY.gz.dmesh"]
    (path,) = Path("packed").rglob("a.ply.dmesh")
    path.with_name("e.dmesh.zst").write_bytes(wrapped("x.zst", path.read_bytes()))
    assert cli("batch -q -d -r packed --output-dir-flat back") == 0
    back = {path.name: path.read_bytes() for path in Path("back").iterdir()}
    assert sorted(back) == ["a.ply", "a.ply.zst", "b.PLY.gz", "e.ply"]
    assert {unwrapped(data) for data in back.values()} == {back["a.ply"]}


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
@pytest.mark.parametrize("name", ["torus.ply", "torus.dmesh"])
def test_damage_is_refused(
    packed: Path, name: str, suffix: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(name + suffix)
    data = path.read_bytes()
    command = "encode" if name == "torus.ply" else "test"
    for wrong, message in (
        (data[:-3], "truncated: the file ends within its"),
        (data + b"\n", "1 bytes follow the"),
        (data[:-1] + bytes([data[-1] ^ 1]), "is damaged"),
    ):
        path.write_bytes(wrong)
        assert cli(command, str(path)) == 3
        error = capsys.readouterr().err
        assert error.startswith(f"deltamesh: {path}: cannot read: ")
        assert message in error
    assert not Path(f"{path}.dmesh").exists()


def test_a_bomb_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("bomb.dmesh.zst").write_bytes(wrapped("x.zst", bytes(1 << 24)))
    for command in ("decode", "test", "compare bomb.dmesh.zst"):
        assert cli(f"{command} --memory 1M bomb.dmesh.zst") == 3
        error = capsys.readouterr().err
        assert "it decompresses to more than the limit of 1048576 bytes" in error
        assert "(--memory raises the limit)" in error
    assert cli("batch -d --memory 1M bomb.dmesh.zst") == 3
    assert "more than the limit of 1048576 bytes" in capsys.readouterr().err


@pytest.mark.parametrize("suffix", [".gz", ".zst"])
def test_the_library_reads_and_writes_them(packed: Path, suffix: str) -> None:
    mesh = deltamesh.read_mesh(f"torus.ply{suffix}")
    deltamesh.save(f"new.dmesh{suffix}", mesh, method="cartesian", bits=8)
    data = unwrapped(Path(f"new.dmesh{suffix}").read_bytes())
    assert data == deltamesh.encode(mesh, method="cartesian", bits=8)
    assert len(deltamesh.load(f"new.dmesh{suffix}").vertices) == 2592
    assert deltamesh.info(f"new.dmesh{suffix}").vertices == 2592
    with Path(f"new.dmesh{suffix}").open("rb") as file:
        assert deltamesh.verify(file).vertices == 2592
    with pytest.raises(LimitError, match="more than the limit of 99 bytes"):
        deltamesh.load(f"new.dmesh{suffix}", memory=99)
    with pytest.raises(LimitError, match="more than the limit of 99 bytes"):
        deltamesh.verify(f"new.dmesh{suffix}", memory=99)
    with pytest.raises(OptionError, match=r"write_mesh writes PLY"):
        deltamesh.save(f"new.ply{suffix}", mesh)
