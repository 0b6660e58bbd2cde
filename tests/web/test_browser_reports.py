"""The pages of `deltamesh bench --html` and `deltamesh batch --html` in a browser, offline."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import browser as browsers
import meshes
import pytest
from browser import Browser

import deltamesh
from deltamesh_cli.program import run
from deltamesh_formats.polymesh.mesh import from_triangles

EVIL = '"><script>document.title = "evil"<' if os.name == "posix" else "evil"


@pytest.fixture(scope="module")
def folder(pages: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page of measurements, and one of a batch, of the same folder."""
    top = tmp_path_factory.mktemp("reports")
    scans = top / "scans"
    scans.mkdir()
    for name, mesh in {"ball": meshes.icosphere(3), f"{EVIL} ü🐇": meshes.torus(20, 15)}.items():
        deltamesh.write_mesh(scans / f"{name}.ply", from_triangles(*mesh))
    peers = ["--peers", "draco"] if importlib.util.find_spec("DracoPy") else []
    measure = ["bench", "-q", str(scans), "--method", "refined", "--bits", "5,7,9", *peers]
    assert run([*measure, "--html", str(top / "bench.html")]) == 0
    (scans / "cut.ply").write_bytes(b"ply\nnothing")
    packed = ["--output-dir-flat", str(top / "packed"), "--html", str(top / "batch.html")]
    assert run(["batch", "-q", str(scans), *packed]) == 1
    return top


def texts(browser: Browser, column: int) -> list[str]:
    """What the cells of a column say, from the top."""
    rows = "[...document.querySelectorAll('#rows tbody tr')]"
    found: list[str] = browser.run(
        f"return {rows}.map((r) => r.cells[arguments[0]].textContent)", column
    )
    return found


def filtered(browser: Browser, words: str) -> None:
    script = "const i = document.querySelector('#filter input'); i.value = arguments[0];"
    browser.run(script + "i.dispatchEvent(new Event('input'))", words)


def numbers(browser: Browser, column: int) -> list[float]:
    return [
        float(one.replace(",", "").replace("\N{MINUS SIGN}", "-")) for one in texts(browser, column)
    ]


def looked_at(browser: Browser, row: int) -> list[list[Any]]:
    """Look at a row; return the name, the role and the size of each mesh that is seen."""
    browser.run(
        "document.querySelectorAll('#rows tbody tr')[arguments[0]].querySelector('button').click()",
        row,
    )
    seen = "deltameshViewer.panels.map((p) => [p.name, p.role, p.size])"
    count = f"deltameshReport.table.rows[deltameshReport.table.chosen()[{row}]].files.length"
    browser.wait(f"return {seen}.length === {count}")
    found: list[list[Any]] = browser.run(f"return {seen}")
    return found


@pytest.fixture
def bench(browser: Browser, folder: Path) -> Iterator[Browser]:
    browser.open(folder / "bench.html")
    yield browser
    assert browser.log() == []


@pytest.fixture
def batch(browser: Browser, folder: Path) -> Iterator[Browser]:
    browser.open(folder / "batch.html")
    yield browser
    assert browser.log() == []


def test_rows_are_sorted_by_any_column_and_filtered_by_words(bench: Browser) -> None:
    everything = texts(bench, 3)
    assert len(everything) >= 6
    heads = "document.querySelectorAll('#rows thead button')"
    for column in (2, 4):
        for falling in (False, True):
            bench.run(f"{heads}[{column}].click()")
            found = numbers(bench, column + 1)
            assert found == sorted(found, reverse=falling)
            sorting = bench.run(f"return {heads}[{column}].parentElement.ariaSort")
            assert sorting == ("descending" if falling else "ascending")
    filtered(bench, "BALL bits=7")
    assert set(texts(bench, 1)) == {"ball.ply"}
    assert set(texts(bench, 2)) == {"refined bits=7"}
    assert bench.run("return document.querySelector('#count').textContent").startswith("1 of ")
    filtered(bench, "nothing like it")
    assert texts(bench, 1) == []


def test_rows_beyond_some_hundreds_are_shown_when_they_are_asked_for(bench: Browser) -> None:
    bench.run(
        "const t = deltameshReport.table; t.rows = Array(450).fill(t.rows[0]);"
        "t.texts = Array(450).fill(''); t.fill()"
    )
    assert len(texts(bench, 1)) == 200
    bench.run("document.querySelector('#more').click()")
    assert len(texts(bench, 1)) == 400
    assert bench.run("return document.querySelector('#more').textContent") == "50 more"


def test_curves_have_a_point_for_each_row_and_open_it(bench: Browser) -> None:
    points = "document.querySelectorAll('#curves .point')"
    own = bench.run(
        "const mesh = document.querySelector('#curve-mesh').value;"
        "return deltameshReport.rows.filter((r) => r.cells[0] === mesh).length"
    )
    assert bench.run(f"return {points}.length") == own
    places = bench.run(f"return [...{points}].map((p) => p.getAttribute('transform'))")
    bench.run(
        "const s = document.querySelector('#curve-error'); s.selectedIndex = 4;"
        "s.dispatchEvent(new Event('change'))"
    )
    assert bench.run(f"return [...{points}].map((p) => p.getAttribute('transform'))") != places
    # From the left, sizes rise, and errors of one codec fall.
    title = bench.run(f"return {points}[0].querySelector('title').textContent")
    assert "refined bits=5" in title
    bench.run("document.querySelector('#curves .name').dispatchEvent(new Event('click'))")
    assert bench.run(f"return {points}.length") == own - 3
    bench.run("document.querySelector('#curves .name').dispatchEvent(new Event('click'))")
    bench.run(f"{points}[0].dispatchEvent(new Event('click'))")
    assert not bench.run("return document.body.matches('.reporting')")


def test_files_of_about_as_many_bytes_are_seen_with_the_original(bench: Browser) -> None:
    filtered(bench, "ball refined bits=7")
    seen = looked_at(bench, 0)
    assert seen[0][:2] == ["ball.ply", "original"]
    assert seen[1][0] == "refined bits=7"
    if importlib.util.find_spec("DracoPy"):
        assert [name.split()[0] for name, _, _ in seen[2:]] == ["draco"]
    # Vertex by vertex: there are errors of angles, too.
    angles = """
    const [original, ...others] = deltameshViewer.panels;
    return others.map((p) => p.field('normals', original)?.length);
    """
    assert set(bench.run(angles)) == {3 * len(meshes.icosphere(3)[1])}
    assert "face normals, °" in bench.run("return document.querySelector('#numbers').textContent")
    assert not bench.run("return document.body.matches('.reporting')")
    bench.press("\ue00c")
    assert bench.run("return document.body.matches('.reporting')")
    filtered(bench, "ball draco bits=10")
    if texts(bench, 1):
        assert [name.split()[0] for name, _, _ in looked_at(bench, 0)[1:]] == ["refined", "draco"]
        bench.run("document.querySelector('#back').click()")
        assert bench.run("return document.body.matches('.reporting')")


def test_errors_in_views_are_those_of_the_table(bench: Browser) -> None:
    filtered(bench, "ball refined bits=5")
    looked_at(bench, 0)
    script = """
    const [original, own] = deltameshViewer.panels;
    const at = new Map(); const field = own.field('distance', original);
    own.mesh.triangles.forEach((v, c) => at.set(v, field[c]));
    let sum = 0; at.forEach((x) => { sum += x * x; });
    return Math.sqrt(sum / at.size);
    """
    rms = bench.run(
        "return deltameshReport.rows.find(({ cells: [mesh, codec] }) =>"
        "mesh === 'ball.ply' && codec === 'refined bits=5').cells[4]"
    )
    assert bench.run(script) == pytest.approx(rms, rel=0.01)


def test_thumbnails_are_drawn_of_the_files(batch: Browser) -> None:
    drawn = "return document.querySelectorAll('#rows canvas').length"
    batch.wait(f"{drawn} === 2")
    shades = """
    return [...document.querySelectorAll('#rows canvas')].map((c) => {
      const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
      return new Set(Array.from({ length: d.length / 4 }, (_, i) => d[4 * i])).size;
    });
    """
    assert all(count > 20 for count in batch.run(shades))


def test_a_batch_has_states_and_names_that_stay_words(batch: Browser) -> None:
    assert batch.run("return document.title") == "deltamesh batch"
    states = dict(zip(texts(batch, 1), texts(batch, 2), strict=True))
    assert sorted(states.values()) == ["done", "done", "failed"]
    assert any("🐇" in name and EVIL in name for name in states)
    filtered(batch, "failed")
    assert "cut.ply" in texts(batch, 1)[0]
    assert batch.run("return document.querySelectorAll('#rows tr.failed').length") == 1
    # Facts, two meshes, the core, the program twice, and what starts it.
    assert batch.run("return document.querySelectorAll('script').length") == 7
    filtered(batch, "🐇")
    ((name, _, size),) = looked_at(batch, 0)
    assert EVIL in name
    assert str(size) == texts(batch, 4)[0].replace(",", "")


def test_a_report_without_webgl_has_its_rows(folder: Path, tmp_path: Path) -> None:
    if browsers.chromium() is None:
        pytest.skip("no chromium with chromedriver")
    with browsers.started(tmp_path / "p", "--disable-3d-apis") as one:
        one.open(folder / "batch.html")
        assert len(texts(one, 1)) == 3
        assert one.run("return document.querySelector('.look').textContent") == "look"


def test_keys_of_the_viewer_do_nothing_in_a_report(batch: Browser) -> None:
    look = "return JSON.stringify(deltameshViewer.look)"
    before = batch.run(look)
    for key in "fwac":
        batch.press(key)
    assert batch.run(look) == before
