"""The group of commands, and the ends of its help pages."""

from __future__ import annotations

import subprocess
import sys

import click
import pytest

from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import EXIT_CODES
from deltamesh_cli.program import COMMANDS, cli


@pytest.mark.parametrize("name", COMMANDS)
def test_the_summary_of_a_command_begins_its_help(name: str) -> None:
    found = cli.get_command(click.Context(cli), name)
    assert found is not None
    assert found.get_short_help_str(limit=200) == COMMANDS[name]


def test_the_commands_are_listed_in_their_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"], prog_name="deltamesh", standalone_mode=False) == 0
    lines = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines() if line]
    listed = [tuple(words) for words in lines if words[0] in COMMANDS]
    assert listed == list(COMMANDS.items())


def test_help_imports_no_command_and_no_options_of_the_encoder() -> None:
    code = (
        "import sys; from deltamesh_cli.program import run; run(['--help']); "
        "heavy = 'deltamesh_cli.commands', 'deltamesh._'; "
        "sys.exit(any(name.startswith(heavy) for name in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_the_end_of_a_help_page() -> None:
    end = epilog("deltamesh encode a.ply\n", "Bytes are counted.")
    assert end == (
        "\b\nBytes are counted.\n\n\b\nExamples:\n  deltamesh encode a.ply\n\n\b\n" + EXIT_CODES
    )
