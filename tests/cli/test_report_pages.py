"""Pages of `deltamesh bench --html` and `deltamesh batch --html`: what is in them, and when."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import sys
from pathlib import Path
from typing import Any

import meshes
import pytest
from commandline import cli

import deltamesh
from deltamesh._page import reports
from deltamesh._page.text_of_bytes import as_bytes
from deltamesh_cli.commands import batch
from deltamesh_cli.reports import files, measurements, writing
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import from_triangles

BALL = mesh_bytes(from_triangles(*meshes.icosphere(2)), "ply")


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "report.html"
    path.write_text("<title>{title}</title><script>{facts}</script>\n{meshes}", encoding="utf-8")
    for module in (reports, writing):
        monkeypatch.setattr(module, "REPORT", path)
    monkeypatch.chdir(tmp_path)
    return path


def report(name: str = "p.html") -> Any:
    found = re.search(r"<script>(.*)</script>\n", Path(name).read_text(encoding="utf-8"))
    assert found is not None
    return json.loads(found[1])["report"]


def held(name: str = "p.html") -> list[tuple[str, str, bytes]]:
    pattern = r'data-name="([^"]*)" data-role="([^"]*)"[^>]*>([^<]*)</script>'
    found = re.findall(pattern, Path(name).read_text(encoding="utf-8"))
    return [(name, role, as_bytes(text)) for name, role, text in found]


def scans(*names: str) -> None:
    for name in names:
        path = Path("scans", name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(BALL)


def columns(found: Any, title: str) -> list[Any]:
    k = [one["title"] for one in found["columns"]].index(title)
    return [row["cells"][k] for row in found["rows"]]


def test_bench_puts_files_of_about_as_many_bytes_beside_each_other() -> None:
    if not (importlib.util.find_spec("DracoPy") and importlib.util.find_spec("meshopt")):
        pytest.skip("without Draco and meshoptimizer")
    scans("a.ply")
    line = "bench -q scans --method refined --bits 5,9 --peers draco,meshopt,zstd --peer-bits 6,14"
    assert cli(f"{line} --html p.html") == 0
    found = report()
    codecs, sizes = columns(found, "codec"), columns(found, "bytes")
    files_held = held()
    assert files_held[0][:2] == ("a.ply", "original")
    assert {name for name, _, _ in files_held[1:]} == {*codecs} - {"zstd"}
    for row, codec in zip(found["rows"], codecs, strict=True):
        names = [files_held[i][0] for i in row["files"]]
        if codec == "zstd":
            assert (names, row["thumbnail"]) == ([], None)
            continue
        assert names[0] == "a.ply"
        assert files_held[row["thumbnail"]][0] == codec
        assert {codec, *(codecs[j] for j in row["beside"])} == {*names[1:]}
        if codec.startswith("refined"):
            peers = [j for j in range(len(codecs)) if codecs[j].startswith("draco")]
            own = sizes[codecs.index(codec)]
            nearest = min(peers, key=lambda j: max(sizes[j] / own, own / sizes[j]))
            assert nearest in row["beside"]
    assert found["curves"]["mesh"] == 0
    for _, _, data in files_held:
        deltamesh.decode(data)


def test_bench_shares_the_room_among_meshes(monkeypatch: pytest.MonkeyPatch) -> None:
    def small(*files: Any, most: int = 6000) -> reports.Travelling:
        return reports.Travelling(*files, most=most)

    monkeypatch.setattr(measurements, "Travelling", small)
    scans("a.ply", "b.ply", "c.ply")
    assert cli("bench -q scans --method refined --bits 5,8,9,10,11 --html p.html") == 0
    found = report()
    held_names = [name for name, _, _ in held()]
    assert {"a.ply", "b.ply", "c.ply"} <= {*held_names}
    assert sum(len(data) for _, _, data in held()) <= 6000
    assert any(row["without"] == "left out" for row in found["rows"])
    assert "Left out" in found["notes"][0]


def test_bench_pages_stay_unless_forced(capsys: pytest.CaptureFixture[str]) -> None:
    scans("a.ply")
    line = "bench -q scans --method cartesian --bits 6 --html p.html"
    assert [cli(line), cli(line), cli(f"{line} -f")] == [0, 1, 0]
    assert "p.html: cannot write: it exists already" in capsys.readouterr().err


def test_an_installation_without_the_page_says_so_before_the_work(
    template: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    template.unlink()
    scans("a.ply")
    assert cli("bench scans --html p.html") == 1
    assert cli("batch scans --html p.html") == 1
    assert capsys.readouterr().err.count("made without the page") == 2
    assert not Path("scans/a.ply.dmesh").exists()


def test_batch_has_a_row_for_each_file_whatever_becomes_of_it() -> None:
    evil = '"><script>alert(1)<'
    scans("a.ply", f"ü🐇{evil}.ply" if os.name == "posix" else "ü.ply", "c.ply")
    Path("scans/c.ply").write_bytes(b"ply\nnothing")
    head = "ply\nformat ascii 1.0\nelement vertex 1\n"
    rows = "".join(f"property float {axis}\n" for axis in "xyz")
    Path("scans/d.ply").write_text(f"{head}{rows}end_header\n0 0 0\n")
    assert cli("batch -q scans --output-dir-flat out --html p.html") == 1
    found = report()
    assert columns(found, "state") == ["done", "failed", "skipped", "done"]
    assert [row["failed"] for row in found["rows"]] == [False, True, False, False]
    assert ["ply" in text for text in columns(found, "notes")] == [False, True, True, False]
    assert [row["thumbnail"] for row in found["rows"]] == [0, None, None, 1]
    assert [row["files"] for row in found["rows"]] == [[0], [], [], [1]]
    assert found["summary"][0][1:] == ["files", "bytes in", "bytes out"]
    sizes = [Path(p).stat().st_size for p in ("out/a.ply.dmesh", "scans/a.ply")]
    assert [columns(found, title)[0] for title in ("bytes out", "bytes in")] == sizes
    assert columns(found, "out/in")[0] == sizes[0] / sizes[1]
    assert held()[0][2] == Path("out/a.ply.dmesh").read_bytes()
    text = Path("p.html").read_text(encoding="utf-8")
    assert text.count("<script") == 1 + len(held())
    assert "alert(1)<" not in text


@pytest.mark.skipif(sys.platform != "linux", reason="names of any bytes")
def test_names_that_are_no_text_are_in_pages() -> None:
    os.mkdir("scans")
    Path(os.fsdecode(b"scans/\xff\n.ply")).write_bytes(BALL)
    assert cli("batch -q scans --html p.html") == 0
    assert columns(report(), "file") == ["scans/\\udcff\\n.ply"]
    assert held()[0][0] == "\\udcff\\n.ply.dmesh"
    assert cli("bench -q scans --method cartesian --bits 6 --html b.html") == 0
    assert columns(report("b.html"), "mesh") == ["\\udcff\\n.ply"]


def test_a_batch_that_is_resumed_has_all_rows(capsys: pytest.CaptureFixture[str]) -> None:
    scans("a.ply", "b.ply")
    line = "batch -q scans --output-dir-flat out --manifest m.jsonl --html p.html"
    assert cli(line) == 0
    assert columns(report(), "state") == ["done", "done"]
    scans("c.ply")
    assert cli(f"{line} --resume") == 0
    found = report()
    assert columns(found, "state") == ["done before", "done before", "done"]
    assert [row["thumbnail"] for row in found["rows"]] == [0, 1, 2]
    assert None not in columns(found, "RMS / diagonal")
    # Without a manifest, too: outputs that are left have a row.
    assert cli("batch -q scans --output-dir-flat out --html p.html") == 1
    assert "p.html: cannot write: it exists already" in capsys.readouterr().err
    assert cli("batch -q scans --output-dir-flat out --skip-existing --html p.html") == 0
    assert columns(report(), "state") == ["skipped"] * 3


def test_decoding_has_the_files_that_were_read() -> None:
    scans("a.ply")
    assert cli("batch -q scans --output-dir-flat packed") == 0
    assert cli("batch -q -d packed --output-dir-flat meshes --html p.html") == 0
    (name, _, data), (row,) = held()[0], report()["rows"]
    assert (name, data) == ("a.ply.dmesh", Path("packed/a.ply.dmesh").read_bytes())
    assert (row["thumbnail"], columns(report(), "state")) == (0, ["done"])


def test_part_of_a_run_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    scans("a.ply", "b.ply", "c.ply")
    original = batch.run_batch

    def interrupted(*arguments: Any) -> int:
        listen = arguments[-1]

        def stop(record: Any, before: bool) -> None:
            listen(record, before)
            raise KeyboardInterrupt

        return original(*arguments[:-1], stop)

    monkeypatch.setattr(batch, "run_batch", interrupted)
    assert cli("batch -q scans --html p.html") == 130
    assert columns(report(), "state") == ["done", "not done yet", "not done yet"]


def test_a_dry_run_writes_no_page() -> None:
    scans("a.ply")
    assert cli("batch -q -n scans --html p.html") == 0
    assert not Path("p.html").exists()


def test_files_that_cannot_be_read_again_have_no_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    scans("a.ply", "b.ply")
    monkeypatch.setattr(files, "MOST_OF_ONE", 10)
    assert cli("batch -q scans --html p.html") == 0
    assert [row["without"] for row in report()["rows"]] == ["left out"] * 2
    assert report()["notes"][0].endswith(": 2.")
