"""The page of `deltamesh view` in a browser, from a file, without a network."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import browser as browsers
import numpy as np
import pytest
from browser import Browser
from graphs import tolerances_of
from places import GOLDEN

import deltamesh
from deltamesh._page.filling import PAGE, REPORT, PageFile, page_of
from deltamesh_cli.program import run
from deltamesh_formats.container.pose_table import entries_of
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh

# Pages of golden files, of some twenty meshes each: a page of all takes a busy machine a minute.
PAGES = 6
SELECT = "const s = document.querySelector('#colouring'); s.value = arguments[0];"
CHOOSE = SELECT + "s.dispatchEvent(new Event('change')); return s.value"
PIXELS = """
const c = document.querySelector('canvas');
return new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => {
  const o = document.createElement('canvas'); o.width = c.width; o.height = c.height;
  const x = o.getContext('2d'); x.drawImage(c, 0, 0);
  const d = x.getImageData(0, 0, o.width, o.height).data; const seen = new Map();
  for (let i = 0; i < d.length; i += 4) {
    const k = d[i] + ',' + d[i + 1] + ',' + d[i + 2]; seen.set(k, (seen.get(k) ?? 0) + 1);
  }
  resolve([...seen].sort((a, b) => b[1] - a[1]));
})));
"""


def scene() -> PolyMesh:
    """A grid of quads with a wave, in two parts, with colours and texture coordinates."""
    n = 24
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    z = 0.1 * np.sin(6 * x) * np.cos(5 * y)
    V = np.stack([x, y, z], axis=2).reshape(-1, 3)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    corners = np.stack([i, i + 1, i + n + 1, i + n], axis=1)
    colours = (255 * (V - V.min(0)) / np.ptp(V, axis=0)).astype(np.uint8)
    left = (V[corners[:, 0], 0] > 0.5).astype(np.int64)
    return PolyMesh(
        V,
        corners.ravel().astype(np.int64),
        np.arange(0, corners.size + 1, 4),
        attributes=(
            Attribute("colour", "vertex", colours, "colour", normalized=True),
            Attribute("uv", "vertex", V[:, :2].copy(), "uv"),
        ),
        parts=(Parts("object", ("left", "right"), left),),
    )


@pytest.fixture(scope="module")
def compared(pages: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a file and its original, by the command line."""
    folder = tmp_path_factory.mktemp("compared")
    original, file, made = (folder / name for name in ("scene.obj", "scene.dmesh", "view.html"))
    deltamesh.write_mesh(original, scene())
    file.write_bytes(deltamesh.encode(scene(), bits=7, method="refined"))
    assert run(["view", "--no-open", "-q", str(file), str(original), "-o", str(made)]) == 0
    return made


def colours(browser: Browser) -> list[tuple[str, int]]:
    return [(colour, count) for colour, count in browser.run(PIXELS)]


def test_pages_are_small_enough_to_mail(pages: None) -> None:
    assert len(PAGE.read_bytes()) <= 150_000
    assert len(REPORT.read_bytes()) <= 160_000


def test_it_shows_both_meshes(browser: Browser, compared: Path, tmp_path: Path) -> None:
    browser.open(compared)
    assert browser.run(browsers.MESSAGES) == ""
    panels = "return deltameshViewer.panels.map((p) => [p.name, p.role, p.mesh.positions.length])"
    n = 3 * len(scene().vertices)
    assert browser.run(panels) == [["scene.obj", "original", n], ["scene.dmesh", "", n]]
    names = browser.run("return document.querySelector('#names').textContent")
    assert "scene.obj" in names
    # Ground, and a surface of many shades.
    found = colours(browser)
    assert len(found) > 100
    assert found[0][1] > 1000
    assert browser.log() == []


def test_numbers_are_those_of_info_and_compare(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    text = browser.run("return document.querySelector('#numbers').textContent")
    container = deltamesh.info((compared.parent / "scene.dmesh").read_bytes())
    assert "Hausdorff" in text
    assert container.meta is not None
    for number in (f"{container.vertices}", f"{container.triangles:,}", "refined", "RMS"):
        assert number in text


@pytest.mark.parametrize(
    "key",
    ["plain", "colour:colour", "uv:uv", "part:object", "distance", "signed", "normals", "dihedral"],
)
def test_colourings_change_the_picture(browser: Browser, compared: Path, key: str) -> None:
    browser.open(compared)
    before = colours(browser)
    assert browser.run(CHOOSE, key) == key
    after = colours(browser)
    assert (after == before) == (key == "plain")
    legend = browser.run("return document.querySelector('#legend').hidden")
    assert legend == (key not in ("distance", "signed", "normals", "dihedral"))


def test_errors_are_those_of_compare(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    script = """
    const [original, own] = deltameshViewer.panels;
    const field = own.field('distance', original);
    const at = new Map(); own.mesh.triangles.forEach((v, c) => at.set(v, field[c]));
    let sum = 0; at.forEach((x) => { sum += x * x; });
    return Math.sqrt(sum / at.size);
    """
    container = deltamesh.info((compared.parent / "scene.dmesh").read_bytes())
    assert container.meta is not None
    expected = container.meta.rms / container.meta.diagonal
    assert browser.run(script) == pytest.approx(expected, rel=0.01, abs=2e-6)


@pytest.mark.parametrize(
    ("key", "button"),
    [
        ("f", "flat"),
        ("w", "wire"),
        ("a", "anchors"),
        ("s", "side"),
        ("1", "single"),
        ("x", "flicker"),
    ],
)
def test_keys_press_buttons(browser: Browser, compared: Path, key: str, button: str) -> None:
    browser.open(compared)
    pressed = f"return document.querySelector('#{button}').ariaPressed"
    start = browser.run(pressed)
    browser.press(key)
    assert browser.run(pressed) == "true"
    browser.run(f"document.querySelector('#{button}').click()")
    assert browser.run(pressed) == ("true" if button in ("side", "single", "flicker") else start)


def place_on_canvas(browser: Browser, x: float, y: float) -> tuple[int, int]:
    """Return a place of the page by the shares of the width and height of the canvas."""
    script = """
    const { left, top, width, height } = document.querySelector('canvas').getBoundingClientRect();
    return [left + arguments[0] * width, top + arguments[1] * height].map(Math.round);
    """
    found: list[int] = browser.run(script, x, y)
    return found[0], found[1]


def test_keys_and_pointers_move_the_camera(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    where = "return JSON.stringify(deltameshViewer.camera)"
    seen = [browser.run(where)]

    def moved() -> None:
        browser.wait(f"return !{json.dumps(seen)}.includes(JSON.stringify(deltameshViewer.camera))")
        seen.append(browser.run(where))

    for key in ("\ue014", "\ue013", "+", "z"):
        browser.press(key)
        moved()
    x, y = place_on_canvas(browser, 0.25, 0.5)
    drag = (
        {"type": "pointerMove", "x": x, "y": y},
        {"type": "pointerDown", "button": 0},
        {"type": "pointerMove", "x": x + 60, "y": y + 30},
        {"type": "pointerUp", "button": 0},
    )
    for kind in ("mouse", "touch"):
        browser.pointer(*drag, kind=kind)
        moved()
    browser.press("r")
    assert '"distance":2.1' in browser.run(where)


def test_the_vertex_under_the_pointer_is_told(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    browser.run(CHOOSE, "distance")
    x, y = place_on_canvas(browser, 0.75, 0.5)
    browser.pointer({"type": "pointerMove", "x": x, "y": y})
    text = browser.wait("return document.querySelector('#pointer').textContent")
    for word in ("vertex", "face", "object", "distance"):
        assert word in text


def test_parts_can_be_hidden(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    shown = "return deltameshViewer.panels.map((p) => p.buffers.shown)"
    everything = browser.run(shown)
    browser.run("document.querySelector('#parts input').click()")
    some = browser.run(shown)
    assert all(0 < a < b for a, b in zip(some, everything, strict=True))
    browser.run("document.querySelector('#parts input').click()")
    assert browser.run(shown) == everything


def dropped(browser: Browser, name: str, data: bytes) -> None:
    """Drop a file on the page."""
    script = """
    const bytes = Uint8Array.from(atob(arguments[1]), (c) => c.charCodeAt(0));
    const given = new DataTransfer(); given.items.add(new File([bytes], arguments[0]));
    dispatchEvent(new DragEvent('drop', { dataTransfer: given }));
    """
    browser.run(script, name, base64.b64encode(data).decode())


def empty_page(folder: Path) -> Path:
    path = folder / "empty.html"
    path.write_text(page_of([], "empty"), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["a.obj", "a.ply", "b.dmesh"])
def test_files_can_be_dropped(browser: Browser, tmp_path: Path, name: str) -> None:
    browser.open(empty_page(tmp_path))
    assert "Drop" in browser.run(browsers.MESSAGES)
    file = tmp_path / name
    if name.endswith(".dmesh"):
        file.write_bytes(deltamesh.encode(scene(), method="lossless"))
    else:
        deltamesh.write_mesh(file, scene())
    dropped(browser, name, file.read_bytes())
    counts = "return deltameshViewer.panels.map(({mesh}) => [mesh.positions.length / 3, mesh.offsets.length - 1])"  # noqa: E501
    browser.wait("return deltameshViewer.panels.length")
    assert browser.run(counts) == [[len(scene().vertices), len(scene().sizes)]]
    assert browser.run(browsers.MESSAGES) == ""
    assert len(colours(browser)) > 20


AXES = "property float x\nproperty float y\nproperty float z\n"
HEAD = f"ply\nformat ascii 1.0\nelement vertex 3\n{AXES}"
FACES = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
ROWS = "0 0 0\n1 0 0\n0 1 0\n"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("cut.ply", HEAD + FACES + ROWS + "3 0 1", "cut short"),
        ("many.ply", HEAD.replace("x 3", "x 999999999") + FACES + ROWS, "cut short"),
        ("bytes.ply", HEAD.replace("ascii", "binary_little_endian") + FACES + ROWS, "cut short"),
        ("nan.ply", HEAD + FACES + ROWS.replace("1 0 0", "1 nan 0") + "3 0 1 2", "vertex 1 has"),
        ("type.ply", HEAD.replace("float y", "wide y") + FACES + ROWS, "the type wide"),
        ("head.ply", "ply\n", "not a PLY file"),
        ("plane.obj", "v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "vertex 0 has"),
        ("words.obj", "v 0 0 0\nv 1 0 0\nv a b c\nf 1 2 3\n", "vertex 2 has"),
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a vertex that is none"),
        ("points.obj", "v 0 0 0\n", "without a face"),
        ("a.stl", "solid a", "not a .dmesh file"),
    ],
)
def test_files_that_are_no_meshes_give_a_message(
    browser: Browser, tmp_path: Path, name: str, text: str, words: str
) -> None:
    browser.open(empty_page(tmp_path))
    dropped(browser, name, text.encode())
    message = browser.wait("return document.querySelector('#message .fault')?.textContent")
    assert message.startswith(f"{name}: ")
    assert words in message
    assert browser.run("return deltameshViewer.panels.length") == 0


def test_an_original_of_another_structure_is_compared_by_nearest_points(
    browser: Browser, compared: Path, tmp_path: Path
) -> None:
    browser.open(compared)
    cut = scene()
    file = tmp_path / "other.obj"
    V = cut.vertices + np.array([0.0, 0.0, 0.25])
    deltamesh.write_mesh(file, deltamesh.from_arrays(V, cut.triangles[::-1]))
    dropped(browser, "other.obj", file.read_bytes())
    browser.wait("return deltameshViewer.panels.length === 3")
    script = """
    const [original, , other] = deltameshViewer.panels;
    const field = other.field('distance', original);
    return [Math.min(...field), Math.max(...field)];
    """
    low, high = browser.run(script)
    assert 0.05 < low <= high < 0.25


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x89DMS\r\n\x1a\nnothing",
        (GOLDEN / "cartesian-quads.dmesh").read_bytes()[:-3],
        (GOLDEN / "refined-default.dmesh").read_bytes().replace(b"CONN", b"CONM"),
    ],
    ids=["empty", "noise", "cut", "renamed"],
)
def test_damaged_files_give_a_message(browser: Browser, tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "damaged.html"
    path.write_text(page_of([PageFile("a.dmesh", data, "", len(data))], "damaged"))
    browser.open(path)
    with pytest.raises(deltamesh.FormatError) as caught:
        deltamesh.decode(data)
    assert browser.run(browsers.MESSAGES) == f"a.dmesh: {caught.value}"
    assert browser.run("return document.querySelector('#flat').textContent") == "Flat"


@pytest.mark.parametrize("page", range(PAGES))
def test_all_golden_files_open(browser: Browser, tmp_path: Path, page: int) -> None:
    """Their digests are right, or there would be messages; so are the sums of their positions."""
    paths = sorted(GOLDEN.glob("*.dmesh"))[page::PAGES]
    files = [PageFile(p.name, p.read_bytes(), "", p.stat().st_size) for p in paths]
    path = tmp_path / "golden.html"
    path.write_text(page_of(files, "golden"), encoding="utf-8")
    browser.open(path)
    assert browser.run(browsers.MESSAGES) == ""
    sums = (
        "return deltameshViewer.panels.map(({mesh}) => mesh.positions.reduce((a, b) => a + b, 0))"
    )
    found = browser.run(sums)
    for p, total in zip(paths, found, strict=True):
        mesh = deltamesh.decode(p.read_bytes())
        allowed = 3 * tolerances_of(p.read_bytes(), mesh).sum()
        assert abs(total - mesh.vertices.sum()) <= allowed, p.name


def test_a_notebook_shows_a_page_in_a_frame(browser: Browser, tmp_path: Path) -> None:
    cell = deltamesh.view(scene(), title="in a cell")._repr_html_()
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><body data-state=ready>{cell}", encoding="utf-8")
    browser.open(path)
    browser.of_session("POST", "/frame", id=0)
    browser.wait("return document.body.dataset.state === 'ready'")
    assert browser.run(browsers.MESSAGES) == ""
    assert "in a cell" in browser.run("return document.querySelector('#names').textContent")
    assert len(colours(browser)) > 20
    browser.of_session("POST", "/frame", id=None)


def test_dark_and_light_grounds_differ(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    grounds = set()
    for _ in range(3):
        grounds.add(colours(browser)[0][0])
        browser.press("t")
    assert len(grounds) == 2


def test_without_webgl_there_is_a_message_and_numbers(compared: Path, tmp_path: Path) -> None:
    if browsers.chromium() is None:
        pytest.skip("no chromium with chromedriver")
    with browsers.started(tmp_path / "p", "--disable-3d-apis") as one:
        one.open(compared)
        assert "no WebGL2" in one.run(browsers.MESSAGES)
        assert "Hausdorff" in one.run("return document.querySelector('#numbers').textContent")


def test_two_fingers_zoom_and_move(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    x, y = place_on_canvas(browser, 0.25, 0.5)

    def finger(number: int, dx: int) -> dict[str, object]:
        actions = [
            {"type": "pointerMove", "x": x + dx, "y": y},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerMove", "x": x + 2 * dx, "y": y + 20, "duration": 50},
            {"type": "pointerUp", "button": 0},
        ]
        touch = {"type": "pointer", "id": f"finger {number}", "actions": actions}
        return {**touch, "parameters": {"pointerType": "touch"}}

    browser.of_session("POST", "/actions", actions=[finger(1, -40), finger(2, 40)])
    distance, target, back = browser.run(
        "const { distance, target, back } = deltameshViewer.camera; return [distance, target, back]"
    )
    assert distance == pytest.approx(1.05, rel=0.1)
    assert np.linalg.norm(target) > 0.01
    browser.press("r")
    assert browser.run("return deltameshViewer.camera.back") == back


def test_screens_of_high_density_get_all_their_pixels(compared: Path, tmp_path: Path) -> None:
    if browsers.chromium() is None:
        pytest.skip("no chromium with chromedriver")
    flags = (*browsers.DRAWING, "--force-device-scale-factor=2", "--window-size=520,900")
    with browsers.started(tmp_path / "p", *flags) as one:
        one.open(compared)
        one.wait("return document.querySelector('canvas').width > 300")
        sizes = "const c = document.querySelector('canvas'); return [c.width, c.clientWidth]"
        width, shown = one.run(sizes)
        assert width == 2 * shown
        # Narrow: the numbers are below the picture.
        below = "document.querySelector('aside').getBoundingClientRect().top"
        assert one.run(f"return {below}") >= one.run(
            "return document.querySelector('canvas').getBoundingClientRect().bottom"
        )
        assert one.run("return document.documentElement.scrollWidth <= innerWidth")
        one.press("1")
        x, y = place_on_canvas(one, 0.5, 0.5)
        one.pointer({"type": "pointerMove", "x": x, "y": y})
        assert "vertex" in one.wait("return document.querySelector('#pointer').textContent")


def test_poses_are_chosen_from_a_list(browser: Browser, tmp_path: Path) -> None:
    data = (GOLDEN / "refined-poses.dmesh").read_bytes()
    page = tmp_path / "poses.html"
    page.write_text(page_of([PageFile("a.dmesh", data, "", len(data))], "poses"), encoding="utf-8")
    browser.open(page)
    rest = colours(browser)
    names = browser.run("return [...document.querySelector('#pose').options].map((o) => o.value)")
    assert names == ["", *(one.name for one in entries_of(deltamesh.info(data)))]
    for name in (*names[1:], ""):
        browser.press("p")
        browser.wait(f"return deltameshViewer.panels[0].pose === {json.dumps(name)}")
        mesh = deltamesh.decode(data, pose=name or None)
        total = browser.run(
            "return deltameshViewer.panels[0].mesh.positions.reduce((a, b) => a + b)"
        )
        assert total == pytest.approx(mesh.vertices.sum(), rel=1e-6, abs=1e-4)
        assert (colours(browser) == rest) == (name == "")
    assert browser.run(browsers.MESSAGES) == ""


def test_frames_are_chosen_by_a_slider_and_played(browser: Browser, tmp_path: Path) -> None:
    data = (GOLDEN / "refined-sequence.dmesh").read_bytes()
    page = tmp_path / "frames.html"
    page.write_text(page_of([PageFile("a.dmesh", data, "", len(data))], "frames"), encoding="utf-8")
    browser.open(page)
    slide = "const s = document.querySelector('#frame'); s.value = 3; "
    at = "return deltameshViewer.panels[0].frame === "
    first = colours(browser)
    steps = [lambda: browser.press("."), lambda: browser.press(".")]
    steps += [lambda: browser.run(slide + "s.dispatchEvent(new Event('change'))")]
    steps += [lambda: browser.press("."), lambda: browser.press(",")]
    for step, frame in zip(steps, (1, 2, 3, 0, 3), strict=True):
        step()
        browser.wait(at + str(frame))
        total = browser.run(
            "return deltameshViewer.panels[0].mesh.positions.reduce((a, b) => a + b)"
        )
        wanted = deltamesh.decode(data, frame=frame).vertices.sum()
        assert total == pytest.approx(wanted, rel=1e-6, abs=1e-4)
        assert (colours(browser) == first) == (frame == 0)
    shown = "return document.querySelector('[for=frame]').textContent"
    assert browser.run(shown) == "3 of 3"
    assert browser.run("return document.querySelector('#frame').labels[0].textContent.trim()")
    browser.run(
        "globalThis.seen = new Set(); const { panels: [p] } = deltameshViewer; "
        "const change = p.change; "
        "p.change = function (...all) { seen.add(all[2]); return change.apply(this, all); }"
    )
    browser.press("v")
    browser.wait("return seen.size === 4")
    pressed = "return document.querySelector('#play').getAttribute('aria-pressed')"
    assert browser.run(pressed) == "true"
    browser.press("v")
    assert browser.run(pressed) == "false"
    assert browser.run(browsers.MESSAGES) == ""
    assert browser.log() == []


def test_one_mesh_has_no_slider(browser: Browser, compared: Path) -> None:
    browser.open(compared)
    assert browser.run("return document.querySelector('#play').parentElement.hidden")
    for key in (".", ",", "v"):
        browser.press(key)
    assert browser.run("return [deltameshViewer.frame, deltameshViewer.playing]") == [0, None]
