"""Writer of man pages, deltamesh(1) and one for each command, from their help pages (click-man).

    python cli/make_man.py FOLDER

click-man writes the text of a page, without its end: examples and exit codes come from the epilog.
"""

from __future__ import annotations

import datetime
import inspect
import os
import re
import sys
import time
from pathlib import Path

import click
from click_man.man import ManPage

from deltamesh._version import __version__
from deltamesh_cli.program import COMMANDS, cli

TOP = click.Context(cli, info_name="deltamesh", **cli.context_settings)


def contexts() -> list[click.Context]:
    """Return the contexts of the program and of its commands."""
    found = [TOP]
    for name in COMMANDS:
        command = cli.get_command(TOP, name)
        if command is None:
            raise LookupError(f"no command {name}")
        found.append(click.Context(command, parent=TOP, info_name=name))
    return found


def page(context: click.Context) -> str:
    """Return the man page of a command, in the language of troff."""
    command, made = context.command, ManPage(context.command_path)
    made.version, made.date = __version__, _date()
    first, _, rest = inspect.cleandoc(command.help or "").partition("\n")
    made.short_help = first.rstrip(".")
    made.description = _escaped(f"{first}\n{rest}".replace("\b\n", ""))
    made.synopsis = " ".join(command.collect_usage_pieces(context))
    records = (one.get_help_record(context) for one in command.get_params(context))
    made.options = [(name, _escaped(text)) for name, text in filter(None, records)]
    if isinstance(command, click.Group):
        made.commands = [(name, _escaped(text)) for name, text in COMMANDS.items()]
    return str(made) + "".join(map(_section, (command.epilog or "").split("\b\n")))


def _section(block: str) -> str:
    """Return a block of the end of a help page, line by line, below its own heading."""
    lines = block.strip().splitlines()
    if not lines:
        return ""
    heading = re.fullmatch(r"(Examples|Exit codes):", lines[0])
    title, body = (heading[1].upper(), lines[1:]) if heading else ("NOTES", lines)
    return "\n".join([f".SH {title}", ".nf", *map(_escaped, body), ".fi", ""])


def _escaped(text: str) -> str:
    """Return a text in which no line begins with a request of troff, and no backslash is one."""
    plain = text.replace("\\", r"\e").replace("-", r"\-")
    return re.sub(r"^(?=[.'])", r"\\&", plain, flags=re.MULTILINE)


def _date() -> str:
    """Return the date of SOURCE_DATE_EPOCH, for builds that repeat, or today's."""
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    return datetime.datetime.fromtimestamp(seconds, datetime.UTC).date().isoformat()


def main() -> None:
    """Write the pages into the folder that is named."""
    if len(sys.argv) != 2:
        sys.exit("usage: python cli/make_man.py FOLDER")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for context in contexts():
        name = context.command_path.replace(" ", "-")
        (folder / f"{name}.1").write_text(page(context), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
