"""What the documents say is what the program does."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import children
import click
import pytest
from documents import script
from places import ROOT

from deltamesh_cli.failures import EXIT_CODES
from deltamesh_cli.program import COMMANDS, cli

README = (ROOT / "README.md").read_text(encoding="utf-8")


TOP = click.Context(cli, info_name="deltamesh", **cli.context_settings)


def command(name: str) -> click.Command:
    found = cli.get_command(TOP, name)
    assert found is not None
    return found


def examples() -> list[str]:
    """Return each command line that README.md or a help page shows."""
    shown = re.findall(r"^```sh\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)
    shown += [command(name).epilog or "" for name in COMMANDS]
    lines = "\n".join([*shown, cli.epilog or ""]).splitlines()
    calls = (re.search(r"\bdeltamesh [a-z]+ .*", line) for line in lines)
    return [re.split(r"  | [|<>&#] | &&", call[0])[0] for call in calls if call]


@pytest.mark.parametrize("example", examples())
def test_the_examples_are_command_lines(example: str) -> None:
    _, name, *arguments = shlex.split(example)
    command(name).make_context(name, arguments, parent=TOP)


def test_there_are_examples_of_every_command() -> None:
    assert {example.split()[1] for example in examples()} == set(COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_and_option_has_help(name: str) -> None:
    found = command(name)
    assert found.help
    assert "Examples:" in (found.epilog or "")
    assert EXIT_CODES in (found.epilog or "")
    for parameter in found.params:
        if isinstance(parameter, click.Option):
            assert parameter.help, parameter.name
            assert parameter.help.rstrip().endswith((".", "]")), parameter.name


@pytest.mark.parametrize("name", COMMANDS)
def test_help_fits_a_terminal_and_has_two_names(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pages = []
    for flag in ("-h", "--help"):
        assert cli.main([name, flag], prog_name="deltamesh", standalone_mode=False) == 0
        pages.append(capsys.readouterr().out)
    assert pages[0] == pages[1]
    assert max(map(len, pages[0].splitlines())) <= 80


def test_the_readme_lists_the_exit_codes() -> None:
    codes = re.findall(r"^  (\d+) +(.*)$", EXIT_CODES, re.MULTILINE)
    assert len(codes) == 6
    for code, meaning in codes:
        assert f"| {code} | {meaning} |" in README


def test_the_reference_is_current() -> None:
    reference = script("cli/make_reference.py")
    assert reference.REFERENCE.read_text(encoding="utf-8") == reference.reference()


def test_the_blocks_that_ci_runs_are_in_the_readme() -> None:
    block = script(".ci/readme_block.py").block
    first, tests = block("first-file"), block("tests")
    assert first.split(" &&")[0] == "python -m pip install ."
    assert "deltamesh encode benchmarks/meshes/torus.ply" in first
    assert "deltamesh decode" in first
    assert tests == 'python -m pip install ".[test]" &&\npython -m pytest\n'
    assert block("slow-tests") == "python -m pytest --slow -m slow\n"
    for name in re.findall(r"for block in (.*); do", (ROOT / ".ci" / "run").read_text())[0].split():
        assert block(name)
    with pytest.raises(LookupError):
        block("nothing")


def test_the_python_of_the_readme_runs() -> None:
    code = script(".ci/readme_block.py").block("python")
    done = children.run([sys.executable, "-c", code], cwd=ROOT, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("(2592, 3) (5184, 3)\n")


def test_links_of_the_readme_lead_somewhere() -> None:
    links = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert links
    for link in links:
        assert (ROOT / link.partition("#")[0]).exists(), link


def test_every_dependency_has_its_reason_in_the_readme() -> None:
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    table = README.partition("## Dependencies")[2].partition("## Layout")[0]
    names = [re.split(r"[<>=\[]", one)[0] for one in project["dependencies"]]
    assert re.findall(r"^\| (\w+) \|", table, re.MULTILINE)[1:] == names
    for extra in project["optional-dependencies"]:
        assert f"`{extra}` (" in table


def test_the_mesh_of_the_repository_is_what_its_script_makes(tmp_path: Path) -> None:
    meshes = script("benchmarks/make_meshes.py")
    made = meshes.ply().encode("ascii")
    assert (meshes.FOLDER / meshes.NAME).read_bytes() == made
    assert len(made) < 250_000
    children.run([sys.executable, ROOT / "benchmarks/make_meshes.py", tmp_path], check=True)
    assert (tmp_path / meshes.NAME).read_bytes() == made
