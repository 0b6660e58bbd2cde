"""Writer of `cli/README.md`, the reference of all commands, from their help pages.

    python cli/make_reference.py [--check]

With `--check` nothing is written, and the exit code is 1 if the file is out of date.
"""

from __future__ import annotations

import sys
from pathlib import Path

import click

from deltamesh_cli.program import COMMANDS, cli

REFERENCE = Path(__file__).parent / "README.md"

WIDTH = 78  # the width that click uses on a terminal of 80 columns

_HEAD = """\
# deltamesh: command reference

`python cli/make_reference.py` writes this page from the help pages of the commands. To change it,
edit the help in `deltamesh_cli`.
"""


def _page(command: click.Command, context: click.Context) -> str:
    return f"\n## {context.command_path}\n\n```text\n{command.get_help(context)}\n```\n"


def reference() -> str:
    """Return the text of the reference page."""
    top = click.Context(cli, info_name="deltamesh", terminal_width=WIDTH, **cli.context_settings)
    pages = [_page(cli, top)]
    for name in COMMANDS:
        command = cli.get_command(top, name)
        if command is None:
            raise LookupError(f"no command {name}")
        pages.append(_page(command, click.Context(command, parent=top, info_name=name)))
    return _HEAD + "".join(pages)


def main() -> None:
    """Write the page, or with `--check` compare it with the file."""
    text = reference()
    if "--check" not in sys.argv[1:]:
        REFERENCE.write_text(text, encoding="utf-8", newline="\n")
    elif REFERENCE.read_text(encoding="utf-8") != text:
        sys.exit("cli/README.md is out of date: run python cli/make_reference.py")


if __name__ == "__main__":
    main()
