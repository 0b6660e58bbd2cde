"""Commands that pages show: each runs, or is a command line, and the numbers beside them hold."""

from __future__ import annotations

import importlib
import re
import shlex
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import click
import meshes
import numpy as np
import pytest
from places import BENCHMARKS, ROOT

import deltamesh
from deltamesh import bench
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

sys.path.append(str(BENCHMARKS))
corpus = importlib.import_module("corpus")

PAGES = {
    name: (ROOT / name).read_text(encoding="utf-8")
    for name in ("README.md", "benchmarks/README.md")
}
README = PAGES["README.md"]
# Blocks of a shell, with the name by which another test or CI runs them.
_BLOCK = re.compile(r"(?:<!-- run: ([\w-]+) -->\n+)?```sh\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COMMANDS = README.partition("\n## Commands\n")[2].partition("```sh\n")[2].partition("```")[0]
# What their lines name: meshes of these formats, and folders.
FILES = ("bunny.ply", "scan.ply", "part.stl", "part.3mf", "rig.obj", "part.obj")


def test_every_block_is_run_by_a_test_or_by_ci() -> None:
    by_ci = re.findall(r"for block in (.*); do", (ROOT / ".ci" / "run").read_text())[0].split()
    (commands,) = (code for name, code in _BLOCK.findall(README) if not name)
    assert commands == COMMANDS
    assert {name for name, _ in _BLOCK.findall(README) if name} <= {*by_ci}
    assert all(lines(code) for _, code in _BLOCK.findall(PAGES["benchmarks/README.md"]))


def lines(code: str) -> list[list[str]]:
    """Return the words of each line of a block, without its comment."""
    return [shlex.split(line, comments=True) for line in code.splitlines() if line.strip()]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    V, F = meshes.torus(16, 12)
    uv = Attribute("uv", "vertex", V[:, :2].astype(np.float32), "uv")
    normals = Attribute("normal", "vertex", V / np.linalg.norm(V, axis=1, keepdims=True), "normal")
    quality = Attribute("quality", "vertex", (V[:, :1] > 0).astype(np.float32))
    for name in (*FILES, "scans/a.ply", "scans/deep/b.obj"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        deltamesh.write_mesh(name, replace(from_triangles(V, F), attributes=(uv, normals, quality)))
    assert run(["batch", "-q", "-r", "scans", "--output-dir-flat", "archive"]) == 0
    assert run(["batch", "-q", "-r", "scans", "--output-dir-mirror", "."]) == 0
    (tmp_path / "packed").mkdir()
    for name in ("a.ply.dmesh", "deep/b.obj.dmesh"):
        place = tmp_path / "packed" / name
        place.parent.mkdir(exist_ok=True)
        (tmp_path / "scans" / name).rename(place)
    return tmp_path


def test_the_commands_of_the_readme_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for text, words in zip(COMMANDS.splitlines(), lines(COMMANDS), strict=True):
        program, name, *_ = words
        assert program == "deltamesh"
        for made in folder.glob("*.dmesh") if name == "encode" else ():
            made.unlink()
        if name in ("decode", "info") or "bunny.ply.dmesh" in words:
            run(["encode", "-q", "-f", "bunny.ply"])
        assert run(words[1:]) == 0, (text, capsys.readouterr().err)
        if written := re.search(r"# writes ([\w.]+);", text):
            assert (folder / written[1]).exists()
    assert (folder / "scans" / "deep" / "b.obj.dmesh").exists()


def scripts() -> Iterator[tuple[str, list[str]]]:
    """Yield each call of a script that a page shows, in a block or in a table."""
    calls = set()
    for page in PAGES.values():
        calls |= set(re.findall(r"python benchmarks/(\w+)\.py((?: [^`\n#]*)?)", page))
    for name, arguments in sorted(calls):
        yield name, shlex.split(arguments.replace("...", ""))


def test_there_are_calls_of_most_scripts() -> None:
    assert len({name for name, _ in scripts()}) > 15


@pytest.mark.parametrize(("name", "arguments"), list(scripts()))
def test_the_calls_of_scripts_are_command_lines(
    name: str, arguments: list[str], tmp_path: Path
) -> None:
    (tmp_path / "FILE").touch()
    (tmp_path / "FOLDER").mkdir()
    arguments = [str(tmp_path / one) if one.isupper() else one for one in arguments]
    script = importlib.import_module(name)
    if isinstance(getattr(script, "command", None), click.Command):
        script.command.make_context(name, arguments)
    elif hasattr(script, "parser"):
        script.parser().parse_args(arguments)
    else:  # it takes names alone
        assert not [one for one in arguments if one.startswith("-")]


def test_the_check_of_the_benchmarks_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    (words,) = (
        line
        for _, code in _BLOCK.findall(PAGES["benchmarks/README.md"])
        for line in lines(code)
        if line[:2] == ["deltamesh", "bench"]
    )
    assert run(words[1:]) == 0
    assert "rows match benchmarks/results.csv" in capsys.readouterr().out


# ---- Numbers of the figures ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def bunny() -> Path:
    path = corpus.path("bunny")
    if not path.is_file():
        pytest.skip(f"no bunny in {corpus.folder()}")
    return path


def numbers(pattern: str) -> list[float]:
    """Return the numbers of the one place of the README where a sentence is so."""
    (found,) = re.findall(pattern, " ".join(README.split()))
    return [float(one.replace(",", "")) for one in ([found] if isinstance(found, str) else found)]


def test_the_bunny_of_the_benchmarks_has_its_bytes(
    bunny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (text,) = re.findall(r"^deltamesh encode .*$", PAGES["benchmarks/README.md"], re.MULTILINE)
    words = shlex.split(text, comments=True)
    more = re.findall(r"# (\d) bytes more", text)
    (size,) = numbers(r"deltamesh in ([\d,]+) bytes")
    monkeypatch.chdir(tmp_path)
    words[words.index("bun_zipper.ply")] = str(bunny)
    assert run([*words[1:], "-q", "-o", "bunny.dmesh"]) == 0
    assert (tmp_path / "bunny.dmesh").stat().st_size == size + int(more[0])


@pytest.mark.slow
def test_the_numbers_of_the_figures_are_what_is_measured(bunny: Path) -> None:
    mesh = corpus.bare("bunny")
    highpass, cartesian, normals, others = numbers(
        r"at 5 bits high-pass \(([\d,]+) bytes\) looks like the bunny at 11 bits Cartesian"
        r" \(([\d,]+) bytes\): the normals are off by ([\d.]+) and ([\d.]+) degrees"
    )
    for label, size, degrees in (
        ("highpass bits=5", highpass, normals),
        ("cartesian bits=11", cartesian, others),
    ):
        found = bench.measure("bunny", mesh, bench.codec_of(label))
        assert (found.bytes, round(found.normal_deg, 2)) == (size, degrees)


@pytest.mark.slow
def test_the_sizes_beside_draco_are_what_is_measured(bunny: Path) -> None:
    pytest.importorskip("DracoPy")
    mesh = corpus.bare("bunny")
    ours, draco, degrees, of_draco, rms, rms_of_draco = numbers(
        r"deltamesh in ([\d,]+) bytes, Draco \(level 10\) in ([\d,]+)\. On average, deltamesh bends"
        r" the normals by ([\d.]+) degrees and Draco by ([\d.]+)\. The RMS distance is ([\d.]+) %"
        r" of the diagonal of the bounding box, and ([\d.]+) % with Draco"
    )
    for label, expected in (
        ("auto normal_error=2.679", (ours, degrees, rms)),
        ("draco bits=8", (draco, of_draco, rms_of_draco)),
    ):
        found = bench.measure("bunny", mesh, bench.codec_of(label))
        measured = found.bytes, round(found.normal_deg, 2), round(100 * found.rms, 2)
        assert measured == expected


@pytest.mark.slow
def test_the_angles_of_spheres_are_what_is_measured() -> None:
    pytest.importorskip("trimesh")
    icosphere = importlib.import_module("renderings").icosphere
    coarse, few, fine, many, differential = numbers(
        r"of a sphere by ([\d.]+) degrees at ([\d,]+) vertices and by ([\d.]+) degrees at ([\d,]+);"
        r" differential quantization bends them by ([\d.]+) degrees"
    )
    for levels, count, degrees in ((4, few, coarse), (6, many, fine)):
        mesh = icosphere(levels)
        assert len(mesh.vertices) == count
        cartesian, highpass = (
            bench.measure("sphere", mesh, bench.codec_of(f"{method} bits=8"))
            for method in ("cartesian", "highpass")
        )
        assert round(cartesian.normal_deg, 2) == degrees
        assert round(highpass.normal_deg, 2) == differential
        assert 3.8 < highpass.bytes / cartesian.bytes < 4.2
