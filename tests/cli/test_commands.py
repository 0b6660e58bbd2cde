"""Each command, on the torus that the repository carries."""

from __future__ import annotations

import json
import re
from pathlib import Path

import click
import numpy as np
import pytest
from commandline import TORUS, cli, damaged

from deltamesh_cli import failures, output, value_types
from deltamesh_formats.meshfiles import files as meshfile
from deltamesh_formats.meshfiles.formats import FORMATS, READABLE
from deltamesh_formats.polymesh.mesh import from_triangles


def test_round_trip(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode torus.ply --quality 3") == 0
    printed = capsys.readouterr()
    assert "2592 vertices, 5184 faces" in printed.out
    assert "bits per vertex" in printed.out
    assert "achieved: RMS" in printed.out
    told = r"note: torus\.ply: triangles that turned over: [1-9]\d*, the first in face \d+\n"
    assert re.fullmatch(told, printed.err)
    assert cli("decode torus.ply.dmesh back.obj") == 0
    mesh = meshfile.read_mesh("back.obj")
    assert (len(mesh.vertices), len(mesh.faces)) == (2592, 5184)


def test_a_collapsed_surface_is_noted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def notes(options: str) -> list[str]:
        assert cli(f"encode torus.ply -f {options}") == 0
        found = capsys.readouterr().err.splitlines()
        return [line for line in found if "of the area" in line]

    (note,) = notes("--bits 0 --anchors 3")
    advice = re.fullmatch(
        r"note: torus\.ply: with 0 bits and anchors as few as 3, (\d+) % of the area is left:"
        r" --anchors (\d+) keeps more of the shape",
        note,
    )
    assert advice
    assert int(advice[1]) < 75
    assert not notes(f"--bits 0 --anchors {advice[2]}")
    assert not notes("--bits 5 --method highpass --anchors 3")
    assert not notes("--bits 0 --anchors 3 -q")


def test_the_options_reach_the_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = "encode torus.ply a.dmesh --method highpass --bits 6 --anchors 20 --seed 7 --json"
    line += " --solution interpolated"
    assert cli(line, "--anchor-method", "random", "--no-diffusion") == 0
    made = json.loads(capsys.readouterr().out)
    assert made["parameters"] | {"step": 0, "anchor_step": 0, "origin": []} == {
        "method": "highpass",
        "bits": 6,
        "diffusion": False,
        "anchors": 20,
        "anchor_method": "random",
        "solution": "interpolated",
        "seed": 7,
        "isolated_vertices": 0,
        "coarse": 1,
        "dead_zone": 0,
        "normal_dead_zone": 0,
        "step": 0,
        "anchor_step": 0,
        "origin": [],
    }
    assert made["source"] == "torus.ply"
    assert made["source_bytes"] == TORUS.stat().st_size
    assert made["bytes"] == Path("a.dmesh").stat().st_size
    assert made["bytes"] == made["header"]["bytes"] + sum(s["bytes"] for s in made["sections"])


def test_cartesian(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode torus.ply a.dmesh --method cartesian -b 12") == 0
    assert cli("info a.dmesh") == 0
    assert "Cartesian: 12 bits" in capsys.readouterr().out


def test_the_last_of_repeated_options_wins(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("encode torus.ply -b 8 -b 9 -o a.dmesh -o b.dmesh --json") == 0
    assert json.loads(capsys.readouterr().out)["parameters"]["bits"] == 9
    assert not Path("a.dmesh").exists()


def test_info_and_test_go_on_after_a_failure_and_exit_with_the_worst_code(
    folder: Path, torus_dmesh: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("bad.dmesh").write_bytes(damaged(torus_dmesh))
    names = ["missing.dmesh", "bad.dmesh", "torus.dmesh"]
    for command in ("info", "test"):
        assert cli(command, *names) == failures.REFUSED
        printed = capsys.readouterr()
        assert "torus.dmesh" in printed.out
        assert printed.err.count("\n") == 2
        assert cli(command, *names[::2]) == failures.FAILED
        capsys.readouterr()
        assert cli(command, "--json", *names) == failures.REFUSED
        told = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert [one["file"] for one in told] == names
        assert [one.get("exit_code", 0) for one in told] == [1, 3, 0]


def test_info(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("info torus.dmesh") == 0
    text = capsys.readouterr().out
    size = Path("torus.dmesh").stat().st_size
    assert text.startswith(f"torus.dmesh: {size} bytes, 2592 vertices, 5184 faces, ")
    for word in ("high-pass", "anchors:", "errors: RMS", "from ply", "PARM", "CONN", "CHEK"):
        assert word in text
    assert text.splitlines()[-1].split()[:2] == ["total", str(size)]


def test_test_is_quiet_when_asked(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("test torus.dmesh") == 0
    assert capsys.readouterr().out == "torus.dmesh: OK\n"
    assert cli("test -q torus.dmesh") == 0
    assert capsys.readouterr() == ("", "")


def test_compare(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("compare torus.ply torus.dmesh") == 0
    text = capsys.readouterr().out
    for word in ("bits per vertex", "RMS", "Hausdorff", "visual", "face normals", "dihedral"):
        assert word in text
    assert cli("compare --json torus.ply torus.dmesh") == 0
    told = json.loads(capsys.readouterr().out)
    assert [told[key]["file"] for key in "ab"] == ["torus.ply", "torus.dmesh"]
    assert told["a"]["bits_per_vertex"] is None
    assert told["b"]["bits_per_vertex"] > 0
    errors = told["errors"]
    assert 0 < errors["rms_relative"] < errors["max_relative"] < 0.01
    assert errors["rms"] == pytest.approx(errors["rms_relative"] * errors["diagonal"])


def test_compare_tells_what_the_encoder_told(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli("info --json torus.dmesh") == 0
    told = json.loads(capsys.readouterr().out)["errors"]
    assert cli("compare --json torus.ply torus.dmesh") == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    for name in ("rms", "max", "normal_deviation_degrees", "dihedral_degrees", "diagonal"):
        assert errors[name] == pytest.approx(told[name], rel=1e-5)


def test_compare_with_itself(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("compare --json torus.ply torus.ply") == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    assert errors["rms"] == errors["max"] == errors["normal_deviation_degrees"] == 0


def test_compare_of_a_soup_with_isolated_vertices(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh = meshfile.read_mesh("torus.ply")
    soup = np.concatenate([mesh.vertices[mesh.faces].reshape(-1, 3), [[0, 0, 0], [0, 0, 1]]])
    faces = np.arange(3 * len(mesh.faces)).reshape(-1, 3)
    meshfile.write_mesh("soup.off", from_triangles(soup, faces))
    assert cli("encode -q soup.off --drop-isolated") == 0
    for line in ("compare --json soup.off soup.off.dmesh", "compare --json soup.off torus.ply"):
        assert cli(line) == 0
        errors = json.loads(capsys.readouterr().out)["errors"]
        assert 0 <= errors["rms_relative"] < 0.01
        assert errors["dihedral_degrees"] < 10


def test_compare_measures_surfaces_where_vertices_do_not_correspond(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("a.off").write_text("OFF\n3 1 0\n0 0 0\n4 0 0\n0 3 0\n3 0 1 2\n")
    Path("b.off").write_text("OFF\n4 2 0\n0 0 1\n4 0 1\n0 3 1\n2 1.5 1\n3 0 1 3\n3 0 3 2\n")
    assert cli("compare --json a.off b.off") == 0
    errors = json.loads(capsys.readouterr().out)["errors"]
    assert errors["hausdorff"] == pytest.approx(1)
    assert errors["hausdorff_relative"] == pytest.approx(0.2)
    assert errors["rms"] is errors["dihedral_degrees"] is None
    assert cli("compare a.off b.off") == 0
    assert ["RMS", "-", "-"] in [line.split() for line in capsys.readouterr().out.splitlines()]


def parts_obj(*names: str) -> str:
    """Two triangles of other shapes, each in a group of its own, with normals."""
    return (
        "v 0 0 0\nv 4 0 0\nv 0 3 0\nv 9 9 1\nvn 0 0 1\n"
        f"g {names[0]}\nf 1//1 2//1 3//1\ng {names[1]}\nf 2//1 4//1 3//1\n"
    )


def test_compare_tells_whether_parts_are_alike(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("a.obj").write_text(parts_obj("left", "right"))
    Path("b.obj").write_text(parts_obj("right", "left"))
    assert cli("encode -q a.obj") == 0
    told = {}
    for other in ("a.obj.dmesh", "b.obj", "torus.ply"):
        assert cli("compare --json a.obj", other) == 0
        told[other] = json.loads(capsys.readouterr().out)["parts"]
    group = {"kind": "group", "a": 2, "b": 2}
    assert told == {
        "a.obj.dmesh": [group | {"alike": True}],
        "b.obj": [group | {"alike": False}],
        "torus.ply": None,
    }
    for other, words in {"a.obj.dmesh": "alike", "b.obj": "not alike"}.items():
        assert cli("compare a.obj", other) == 0
        text = capsys.readouterr().out
        assert text.splitlines()[-1].split() == ["groups", "2", "2", *words.split()]
        assert "largest difference" in text


def test_compare_names_parts_that_only_one_has(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("a.obj").write_text(parts_obj("left", "right"))
    assert cli("encode -q a.obj --drop group --lossless-attributes") == 0
    for line, (first, second) in {"a.obj a.obj.dmesh": (2, 0), "a.obj.dmesh a.obj": (0, 2)}.items():
        assert cli("compare --json", *line.split()) == 0
        (told,) = json.loads(capsys.readouterr().out)["parts"]
        assert told == {"kind": "group", "a": first, "b": second, "alike": False}


def test_compare_tells_angles_as_degrees(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.obj").write_text(parts_obj("left", "right"))
    Path("b.obj").write_text(parts_obj("left", "right").replace("vn 0 0 1", "vn 0 1 1"))
    for other, words in {"a.obj": "none", "b.obj": "45 degrees"}.items():
        assert cli("compare a.obj", other) == 0
        (line,) = (one for one in capsys.readouterr().out.splitlines() if "normal " in one)
        assert line.endswith(words)


@pytest.mark.parametrize(
    ("text", "number"),
    [("1000", 1000), ("1k", 1024), ("512M", 512 << 20), ("8G", 8 << 30), ("1.5 GiB", 3 << 29)],
)
def test_sizes(text: str, number: int) -> None:
    assert value_types.size(text) == number


@pytest.mark.parametrize("text", ["", "M", "-1", "1X", "1e3", "nan", "1 000"])
def test_what_is_no_size(text: str) -> None:
    with pytest.raises(click.BadParameter):
        value_types.size(text)


def test_anchor_counts() -> None:
    assert value_types.anchor_count("100") == 100
    assert value_types.anchor_count("0.25") == 0.25
    assert isinstance(value_types.anchor_count("1"), int)


def test_json_is_json_whatever_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    output.print_json({"a": float("nan"), "b": [float("inf"), 1.5], "c": {"d": "\udcff"}})
    assert json.loads(capsys.readouterr().out) == {
        "a": None,
        "b": [None, 1.5],
        "c": {"d": "\udcff"},
    }


def test_a_table_is_aligned() -> None:
    assert output.table([("a", "1"), ("long", "23")]) == "  a      1\n  long  23"


@pytest.mark.parametrize("command", ["encode", "decode", "bench"])
def test_help_names_every_mesh_format(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(f"{command} --help") == 0
    said = " ".join(capsys.readouterr().out.split())
    known = FORMATS if command == "decode" else READABLE
    *some, last = (one.title for one in known.values())
    assert f"{', '.join(some)} or {last}" in said
    assert command == "bench" or f"put-format [{'|'.join(known)}]" in said


def test_a_target_that_cannot_be_met_has_its_own_exit_code(folder: Path, capsys) -> None:
    for bound, why in (("--max-error-rel 1e-15", "promised"), ("--normal-error 1e-12", "met")):
        code = cli(f"encode torus.ply out.dmesh --method cartesian {bound}")
        assert code == 4
        assert f"cannot be {why}" in capsys.readouterr().err
    assert not (folder / "out.dmesh").exists()


def test_a_target_is_met_and_told(folder: Path, capsys) -> None:
    assert cli("encode torus.ply out.dmesh --normal-error 0.5 --json") == 0
    told = json.loads(capsys.readouterr().out)
    assert 0.3 < told["errors"]["normal_deviation_degrees"] <= 0.5


def test_two_rates_are_a_usage_error(folder: Path, capsys) -> None:
    assert cli("encode torus.ply out.dmesh --bits 8 --normal-error 1") == 2
    assert "exclude each other" in capsys.readouterr().err


def test_encode_keeps_the_order(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mesh = meshfile.read_mesh("torus.ply")
    rng = np.random.default_rng(12)
    faces = mesh.faces[rng.permutation(len(mesh.faces))]
    meshfile.write_mesh("mixed.off", from_triangles(mesh.vertices, faces))
    assert cli("encode -q mixed.off --keep-order --method cartesian") == 0
    assert cli("decode -q mixed.off.dmesh back.off") == 0
    np.testing.assert_array_equal(meshfile.read_mesh("back.off").faces, faces)
    assert cli("info mixed.off.dmesh") == 0
    assert "order of vertices and faces: that of the source" in capsys.readouterr().out
    for name, kept in (("mixed.off.dmesh", True), ("torus.dmesh", False)):
        assert cli("info --json", name) == 0
        assert json.loads(capsys.readouterr().out)["order_kept"] is kept


def test_polygons_come_back(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A pyramid over a pentagon, and a quad at one of its sides."""
    points = "0 0 0\n3 0 0\n4 2 0\n2 4 0\n-1 2 0\n1 2 3\n0 0 -2\n3 0 -2\n"
    faces = "5 4 3 2 1 0\n3 0 1 5\n3 1 2 5\n3 2 3 5\n3 3 4 5\n3 4 0 5\n4 0 6 7 1\n"
    Path("a.off").write_text(f"OFF\n8 7 0\n{points}{faces}")
    assert cli("encode a.off --lossless") == 0
    printed = capsys.readouterr()
    assert "8 vertices, 7 polygons (10 triangles)" in printed.out
    assert printed.err == ""
    assert cli("info --json a.off.dmesh") == 0
    described = json.loads(capsys.readouterr().out)
    assert (described["faces"], described["polygons"]) == (10, 7)
    assert cli("decode a.off.dmesh back.off") == 0
    assert "8 vertices, 7 faces" in capsys.readouterr().out
    assert sorted(meshfile.read_mesh("back.off").sizes) == [3, 3, 3, 3, 3, 4, 5]
    assert cli("compare --json a.off a.off.dmesh") == 0
    assert json.loads(capsys.readouterr().out)["errors"]["max"] == 0


TEXTURED = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nl 1 2\nusemtl red\nf 1/1 2/1 3/1\n"


COLOURED = """ply
format ascii 1.0
element vertex 4
property double x
property double y
property double z
property uchar red
property uchar green
property uchar blue
property short rank
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
end_header
0 0 0 255 0 128 -5
1 0 0 0 255 1 7
1 1 0 9 9 9 300
0 1 0 1 2 3 -32768
3 0 1 2 6 0 0 0.5 0 0.5 0.5
3 0 2 3 6 0 0 0.5 0.5 0.25 1
"""


def test_attributes_survive_the_commands(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.ply").write_text(COLOURED)
    given = meshfile.read_mesh("a.ply")
    assert cli("encode a.ply --keep-order --lossless") == 0
    assert cli("decode a.ply.dmesh b.ply") == 0
    found = meshfile.read_mesh("b.ply")
    assert capsys.readouterr().err == ""
    for a, b in zip(given.attributes, found.attributes, strict=True):
        assert (a.name, a.domain, a.role, a.values.dtype) == (
            *(b.name, b.domain, b.role, b.values.dtype),
        )
        np.testing.assert_array_equal(a.dense(), b.dense())
    assert cli("info a.ply.dmesh") == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["rank", "vertex", "1", "int16", "integer", "none"] in [row[:6] for row in rows]
    assert cli("info --json a.ply.dmesh") == 0
    told = json.loads(capsys.readouterr().out)["attributes"]
    assert [(a["name"], a["type"], a["width"], a["largest_error"]) for a in told] == [
        ("colour", "uint8", 3, 0.0),
        ("rank", "int16", 1, 0.0),
        ("uv", "float32", 2, 0.0),
    ]
    assert cli("encode -f a.ply --drop colour --drop uv --drop nothing") == 0
    assert cli("info --json a.ply.dmesh") == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])["attributes"]
    assert [a["name"] for a in told] == ["rank"]


def test_what_is_not_kept_is_named_once(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.obj").write_text(TEXTURED)
    words = ["lines"]
    note = f"note: a.obj: {', '.join(words)} are not kept\n"
    assert cli("encode a.obj") == 0
    assert capsys.readouterr().err == note
    assert cli("encode -f -q a.obj") == 0
    assert capsys.readouterr().err == ""
    assert cli("encode -f --json a.obj") == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["not_kept"] == words
    assert printed.err == note
    assert cli("encode --json torus.ply second.dmesh") == 0
    assert json.loads(capsys.readouterr().out)["not_kept"] == []


def test_names_from_a_file_are_fit_for_a_terminal(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    header = b"ply\nformat ascii 1.0\nelement vertex 3\n"
    header += b"".join(b"property float %s\n" % name for name in (b"x", b"y", b"z", b"\x1b[2J\xff"))
    faces = b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    points = b"0 0 0 1\n1 0 0 1\n0 1 0 1\n"
    Path("a.ply").write_bytes(header + faces + points + b"3 0 1 2\n")
    assert cli("encode -v a.ply") == 0
    assert cli("info a.ply.dmesh") == 0
    assert r"  \x1b[2J\udcff  vertex  1 float32" in capsys.readouterr().out
    assert cli("decode a.ply.dmesh a.off") == 0
    assert r"note: a.off: \x1b[2J\udcff of vertices are not kept" in capsys.readouterr().err


def test_what_the_output_cannot_hold_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh = meshfile.read_mesh("torus.ply")
    far = from_triangles(mesh.vertices + 1e9, mesh.faces)
    meshfile.write_mesh("far.ply", far)
    assert cli("encode -q far.ply far.dmesh --bits 14 --method cartesian") == 0
    assert cli("decode far.dmesh far.stl") == 0
    assert "note: far.stl: positions beyond float32 (by up to" in capsys.readouterr().err
    assert cli("decode -q far.dmesh far.glb") == 0
    np.testing.assert_allclose(meshfile.read_mesh("far.glb").vertices.mean(axis=0), 1e9, rtol=1e-9)
