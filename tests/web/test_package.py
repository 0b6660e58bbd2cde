"""The package for the npm registry: what is in it, its types, and its loader for three.js."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from pathlib import Path

import children
import pytest
from places import GOLDEN, ROOT

WEB = ROOT / "src" / "web"
HERE = Path(__file__).parent


def test_it_is_of_this_version_and_licence() -> None:
    own = json.loads((WEB / "package.json").read_text(encoding="utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for key in ("name", "version", "license"):
        assert own[key] == project[key]


def test_its_types_name_what_it_exports(node: str, package: Path) -> None:
    code = (
        f"console.log(Object.keys(await import({json.dumps(str(package / 'index.mjs'))})).join())"
    )
    done = children.run([node, "--input-type=module", "-e", code], text=True, check=True)
    text = (package / "index.d.ts").read_text(encoding="utf-8")
    declared = re.findall(r"^export (?:class|function) (\w+)", text, re.MULTILINE)
    assert sorted(declared) == sorted(done.stdout.strip().split(","))


def test_npm_packs_what_it_needs(package: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("no npm")
    command = [npm, "pack", "--dry-run", "--json", "--offline"]
    done = children.run(command, text=True, check=True, cwd=package)
    (listed,) = json.loads(done.stdout)
    names = {file["path"] for file in listed["files"]}
    expected = {path.relative_to(WEB).as_posix() for path in WEB.glob("decoder/*.mjs")}
    expected |= {"package.json", "README.md", "LICENSE", "index.mjs", "index.d.ts", "core.wasm"}
    assert names == expected | {"three/DMESHLoader.mjs"}
    assert listed["size"] < 150_000


@pytest.mark.parametrize(
    "name", ["highpass-textured", "refined-parts", "cartesian-quads-attributes"]
)
def test_three_js_loads_a_mesh(node: str, package: Path, tmp_path: Path, name: str) -> None:
    """With a stand-in that has what the loader takes from three.js."""
    path = GOLDEN / f"{name}.dmesh"
    module = tmp_path / "node_modules" / "three"
    module.mkdir(parents=True)
    shutil.copy(HERE / "three_stand_in.mjs", module / "index.mjs")
    facts = {"name": "three", "type": "module", "exports": "./index.mjs"}
    (module / "package.json").write_text(json.dumps(facts))
    shutil.copytree(package, tmp_path / "deltamesh")
    shutil.copy(HERE / "load_by_three.mjs", tmp_path)
    done = children.run([node, str(tmp_path / "load_by_three.mjs"), str(path)], text=True)
    assert done.stderr == ""
    assert done.stdout == "alike\n"
