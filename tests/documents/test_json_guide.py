"""docs/json.md names every key that `--json` prints, and no other."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from places import ROOT

import deltamesh
from deltamesh_cli.program import run

PAGE = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
ROWS = {
    title: dict(re.findall(r"^\| (`.*?) \| (.*) \|$", text, re.MULTILINE))
    for title, text in re.findall(r"^## deltamesh (\w+)\n(.*?)(?=^## |\Z)", PAGE, re.S | re.M)
}


def words(text: str) -> set[str]:
    return set(re.findall(r"`(\w+)`", text))


def keys(value: object) -> set[str]:
    """The keys of an object, or of all objects of a list."""
    found = value if isinstance(value, list) else [value]
    return {key for one in found if isinstance(one, dict) for key in one}


@pytest.fixture
def printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, object]]:
    vertices = np.array([[0, 0, 0], [4, 0, 0], [0, 3, 0], [9, 9, 1.0]])
    mesh = deltamesh.from_arrays(vertices, [[0, 1, 2], [1, 3, 2]], vertex={"heat": vertices[:, 0]})
    parts = (deltamesh.Parts("group", ("left", "right"), np.array([0, 1])),)
    whole = deltamesh.PolyMesh(mesh.vertices, mesh.corners, mesh.offsets, mesh.attributes, parts)
    path = str(tmp_path / "a.dmesh")
    deltamesh.save(path, whole, method="highpass")
    told, posed = {}, str(tmp_path / "b.dmesh")
    edit = [posed, "--name", "out", "--move", "vertices:1", "shift=1,0,0"]
    assert run(["edit", "--json", path, *edit]) == 0
    told["edit"], path = json.loads(capsys.readouterr().out), posed
    for name, more in (("info", []), ("compare", [path])):
        assert run([name, "--json", path, *more]) == 0
        told[name] = json.loads(capsys.readouterr().out)
    return told


@pytest.mark.parametrize("name", ["info", "edit", "compare"])
def test_every_key_is_explained(name: str, printed: dict[str, dict[str, object]]) -> None:
    named = set().union(*(words(row) for row in ROWS[name]))
    assert named == printed[name].keys()


def test_what_is_in_them_is_explained(printed: dict[str, dict[str, object]]) -> None:
    for name, rows in ROWS.items():
        before = "".join(ROWS["info"].values()) if name == "compare" else ""
        for row, meaning in rows.items():
            inner = set().union(*(keys(printed[name][key]) for key in words(row)))
            assert inner <= words(before + meaning), row
