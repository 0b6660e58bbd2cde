"""Encoding and decoding of one file into another, and the options that say how."""

from __future__ import annotations

import base64
import json
import zipfile
from pathlib import Path

import click
import pytest

from deltamesh_cli.decoding import decode_to_file, output_name_and_format
from deltamesh_cli.encode_options import check_encode_options, encode_options
from deltamesh_cli.encoding import encode_file
from deltamesh_cli.failures import Failure
from deltamesh_cli.options import decode_options, flag_of, parameters_of, specified
from deltamesh_formats.meshfiles.files import read_mesh, written


def silent(stage: str) -> None:
    """Tell nobody."""


@pytest.mark.parametrize(
    ("source", "target", "chosen", "stored", "expected"),
    [
        ("a.ply.dmesh", None, None, "", ("a.ply", "ply")),
        ("a.dmesh", None, None, "obj", ("a.obj", "obj")),
        ("a.dmesh", None, None, "", ("a.ply", "ply")),
        ("a.dmesh", None, None, "unheard", ("a.ply", "ply")),
        ("a.obj.dmesh", None, "stl", "obj", ("a.stl", "stl")),
        # A format that is only read.
        ("a.dae.dmesh", None, None, "dae", ("a.ply", "ply")),
        ("a.dae.dmesh.zst", None, "obj", "dae", ("a.obj", "obj")),
        ("a.b.dmesh", None, None, "obj", ("a.b.obj", "obj")),
        ("a.dmesh", "b.off", None, "obj", ("b.off", "off")),
        ("a.dmesh", "b.off", "obj", "ply", ("b.off", "obj")),
        ("a.dmesh", "-", None, "obj", ("-", "obj")),
    ],
)
def test_a_mesh_has_the_name_and_the_format_that_are_told(
    source: str, target: str | None, chosen: str | None, stored: str, expected: tuple[str, str]
) -> None:
    assert output_name_and_format(source, target, chosen, stored) == expected


def test_a_file_is_encoded_and_decoded(folder: Path) -> None:
    options = {"method": "lossless", "bits": None}
    made = encode_file("torus.ply", "new", None, silent, options, force=False)
    container = made.container
    assert made.source_size == (folder / "torus.ply").stat().st_size
    assert container.size == (folder / "new").stat().st_size
    assert made.lost == ()
    assert made.cost is None
    assert len(made.report.lost) == len(made.report.turned) == 0
    decode_to_file("back.obj", "obj", "new", container, silent, {}, force=False)
    mesh, again = read_mesh("torus.ply"), read_mesh("back.obj")
    assert sorted(again.vertices.tolist()) == sorted(mesh.vertices.tolist())
    with pytest.raises(Failure, match=r"^back\.obj: cannot write: "):
        decode_to_file("back.obj", "ply", "new", container, silent, {}, force=False)


def test_buffers_of_a_gltf_are_bytes_of_the_source_and_a_zip_has_its_own(folder: Path) -> None:
    text = json.loads(written(read_mesh("torus.ply"), "gltf").data)
    buffer = base64.b64decode(text["buffers"][0]["uri"].partition(",")[2])
    text["buffers"][0]["uri"] = "a.bin"
    (folder / "a.bin").write_bytes(buffer)
    (folder / "a.gltf").write_text(json.dumps(text))
    with zipfile.ZipFile("a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write("a.gltf")
        archive.write("a.bin")
    sizes = {"a.gltf": len(json.dumps(text)) + len(buffer)}
    sizes["a.zip"] = (folder / "a.zip").stat().st_size
    for name, size in sizes.items():
        made = encode_file(name, f"{name}.dmesh", None, silent, {"method": "lossless"}, force=False)
        assert made.source_size == size
        assert made.container.meta.source == "gltf"
    made = [(folder / f"{name}.dmesh").read_bytes() for name in sizes]
    assert made[0] == made[1]


def test_what_is_no_mesh_is_not_encoded(folder: Path) -> None:
    (folder / "bad.ply").write_bytes(b"ply")
    with pytest.raises(Failure, match=r"^bad\.ply: cannot read: "):
        encode_file("bad.ply", "new", None, silent, {"method": "auto"}, force=False)
    assert not (folder / "new").exists()


def test_options_are_those_of_the_library() -> None:
    assert flag_of("max_error") == "--max-error"
    assert specified({"bits": None, "step": 0.0, "seed": 0}) == {"step": 0.0, "seed": 0}
    both = parameters_of(encode_options).keys() & parameters_of(decode_options).keys()
    assert both == {"solver", "threads"}


@click.command()
@encode_options
@click.pass_context
def chosen(context: click.Context, **parameters: object) -> dict[str, object]:
    check_encode_options(parameters)
    return specified(parameters)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--bits 8 --step 1", "--bits and --step"),
        ("--lossless --method cartesian", "--lossless and --method cartesian exclude"),
        ("--lossless --bits 8", "--bits"),
        ("--quality 0", "is not a whole number from 1"),
        ("--coarse 0.5", "is not a number from 1 to"),
    ],
)
def test_options_that_exclude_each_other_are_refused(line: str, message: str) -> None:
    with pytest.raises(click.UsageError, match=message):
        chosen.main(line.split(), standalone_mode=False)


def test_lossless_is_a_method() -> None:
    found = chosen.main(["--lossless"], standalone_mode=False)
    assert found["method"] == "lossless"
    assert "lossless" not in found
