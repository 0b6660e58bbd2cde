"""What is imported when: the codec and its machinery only by the commands that need them."""

from __future__ import annotations

import sys
from pathlib import Path

import children
import pytest

HEAVY = ("scipy", "trimesh", "rslab", "rich", "pypardiso", "distributed")


def modules_after(code: str) -> set[str]:
    """Return the top-level packages that a fresh interpreter has imported after `code`."""
    code += "\nimport sys; print('\\n', *{name.partition('.')[0] for name in sys.modules})"
    done = children.run([sys.executable, "-c", code], text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    "package",
    ["deltamesh_formats", "deltamesh", "deltamesh_cli", "deltamesh.batch", "deltamesh.bench"],
)
def test_importing_a_package_is_cheap(package: str) -> None:
    assert not modules_after(f"import {package}") & {*HEAVY, "numpy"}


@pytest.mark.parametrize("line", ["--help", "--version", "encode --help", "info nothing.dmesh"])
def test_help_and_info_import_click_only(line: str) -> None:
    code = f"from deltamesh_cli.program import run\nrun({line.split()!r})"
    assert not modules_after(code) & {*HEAVY, "numpy"}


def test_info_of_a_file_imports_no_codec(tmp_path: Path) -> None:
    from deltamesh_formats.container.building import build_container
    from deltamesh_formats.container.container import Parameters
    from deltamesh_formats.container.writer import write_container

    parameters = Parameters("cartesian", True, None, 8, 0.5, (0.0, 0.0, 0.0), 0.0, 0, 0, 0)
    payloads = {"CONN": b"\x01", "CART": b"\x02"}
    path = tmp_path / "small.dmesh"
    container = build_container(3, 1, parameters, payloads, None, bytes(8))
    path.write_bytes(write_container(container))
    code = f"from deltamesh_cli.program import run\nassert run(['info', {str(path)!r}]) == 0"
    assert not modules_after(code) & {*HEAVY, "numpy"}


def test_the_formats_do_not_need_the_codec() -> None:
    code = "import deltamesh_formats.container.reader, deltamesh_formats.container.writer"
    assert not modules_after(code) & {*HEAVY, "numpy", "deltamesh", "deltamesh_cli"}
    assert not modules_after("import deltamesh_formats.meshfiles.files") & {
        "deltamesh",
        "deltamesh_cli",
    }


@pytest.mark.parametrize("line", ["--help", "completion zsh", "info nothing.dmesh", "encode"])
def test_the_package_runs_as_the_command(line: str) -> None:
    said = []
    for module in ("deltamesh", "deltamesh_cli"):
        command = [sys.executable, "-m", module, *line.split()]
        done = children.run(command, text=True)
        said.append((done.returncode, done.stdout, done.stderr))
    assert said[0] == said[1]
    assert said[0][1:] != ("", "")


@pytest.mark.parametrize("line", ["--help", "info nothing.dmesh"])
def test_help_and_info_answer_at_once(line: str) -> None:
    assert children.seconds_of([sys.executable, "-m", "deltamesh_cli", *line.split()]) < 0.3
