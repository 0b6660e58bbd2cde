"""The TAB key: what a real bash gets, and how soon."""

from __future__ import annotations

import os
import shlex
import shutil
import stat
from pathlib import Path

import children
import pytest
from commandline import PROGRAM, cli

from deltamesh_cli.program import COMMANDS
from deltamesh_formats.meshfiles.formats import FORMATS

BASH = shutil.which("bash")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_script_for_each_shell(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli(f"completion {shell}") == 0
    said = capsys.readouterr()
    assert f"_DELTAMESH_COMPLETE={shell}_complete" in said.out
    assert not said.err


def test_other_shells_are_unknown() -> None:
    assert cli("completion tcsh") == 2


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder to be in, with a program `deltamesh` of these sources beside it."""
    program = tmp_path / "bin" / "deltamesh"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {shlex.join(PROGRAM)} "$@"\n')
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    there = tmp_path / "there"
    (there / "a folder").mkdir(parents=True)
    (there / "scan.ply").touch()
    return there


def completions(folder: Path, line: str) -> list[str]:
    """What bash offers for the last word of a line, by its own machinery."""
    words = line.split(" ")
    # What the TAB key runs; `compopt`, of which it is told that files are wanted, says so.
    script = f"""
    eval "$(deltamesh completion bash)"
    COMP_WORDS=({shlex.join(words[:-1])} {shlex.quote(words[-1])})
    COMP_CWORD={len(words) - 1}
    compopt() {{ echo "$2"; }}
    _deltamesh_completion deltamesh
    printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    path = os.pathsep.join([str(folder.parent / "bin"), os.environ["PATH"]])
    done = children.run(
        [BASH, "--norc", "-c", script],
        cwd=folder,
        env={**os.environ, "PATH": path},
        text=True,
        check=True,
    )
    assert not done.stderr
    return [word for word in done.stdout.splitlines() if word]


needs_bash = pytest.mark.skipif(BASH is None or os.name != "posix", reason="there is no bash")


@needs_bash
@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("deltamesh ", list(COMMANDS)),
        ("deltamesh enc", ["encode"]),
        ("deltamesh encode --meth", ["--method"]),
        (
            "deltamesh encode --method ",
            ["auto", "refined", "highpass", "cartesian", "lossless"],
        ),
        ("deltamesh encode --method h", ["highpass"]),
        ("deltamesh decode --output-format ", [*FORMATS]),
        ("deltamesh completion ", ["bash", "zsh", "fish"]),
        # Left to bash, which knows the files and the folders.
        ("deltamesh encode s", ["default"]),
        ("deltamesh encode scan.ply -o s", ["default"]),
        ("deltamesh info ", ["default"]),
        ("deltamesh batch --output-dir-flat ", ["dirnames"]),
    ],
)
def test_what_bash_offers(folder: Path, line: str, found: list[str]) -> None:
    assert completions(folder, line) == found


@pytest.mark.parametrize("words", ["deltamesh ", "deltamesh encode --"])
def test_it_is_at_once(words: str) -> None:
    environment = {
        **os.environ,
        "_DELTAMESH_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
    }

    assert "plain," in children.run(PROGRAM, env=environment, text=True).stdout
    assert children.seconds_of(PROGRAM, env=environment) < 0.3
