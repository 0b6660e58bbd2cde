"""Options that several commands share, each a decorator, and the types of their values."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable
from typing import Any, Final

import click
from click.shell_completion import CompletionItem

from deltamesh._options import MAX_COARSE, SOLVERS
from deltamesh_cli.failures import EXIT_CODES, Settings
from deltamesh_formats.meshfiles.formats import FORMATS, TITLES

Command = Callable[..., Any]

_MESH_FORMAT: Final = click.Choice(list(FORMATS), case_sensitive=False)

_UNITS: Final = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}
_SIZE: Final = re.compile(r"(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?", re.IGNORECASE)


def size(text: str) -> int:
    """Read a number of bytes: 1000000, 512M, 8G, 1.5GiB; K, M, G, T are powers of 1024."""
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise click.BadParameter(f"{text!r} is not a size, such as 512M or 8G.")
    return int(float(match[1]) * 1024 ** _UNITS[match[2].upper()])


def anchor_count(text: str) -> int | float:
    """Read a number of anchors (int) or their fraction of the vertices (float)."""
    if text.isascii() and text.isdigit() and int(text) > 0:
        return int(text)
    if not 0 < (fraction := _real(text)) < 1:
        raise click.BadParameter(
            f"{text!r} is neither a count, such as 100, nor a fraction below 1, such as 0.001."
        )
    return fraction


def length(text: str) -> float:
    """Read a finite number greater than zero."""
    if not 0 < (value := _real(text)) < math.inf:
        raise click.BadParameter(f"{text!r} is not a positive number.")
    return value


def factor(text: str) -> float:
    """Read a number from 1 to `MAX_COARSE`."""
    if not 1 <= (value := _real(text)) <= MAX_COARSE:
        raise click.BadParameter(f"{text!r} is not a number from 1 to {MAX_COARSE:g}.")
    return value


def _real(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def whole(low: int, high: float = math.inf) -> Callable[[str], int]:
    """Return a reader of whole numbers from `low` to `high`."""

    def read(text: str) -> int:
        if not (text.isascii() and text.isdigit() and low <= int(text) <= high):
            limits = f"from {low}" if high == math.inf else f"from {low} to {high}"
            raise click.BadParameter(f"{text!r} is not a whole number {limits}.")
        return int(text)

    return read


def share(text: str) -> float:
    """Read a share of something: 0.5% or 0.005."""
    number, percent, rest = text.strip().partition("%")
    value = _real(number) / (100 if percent else 1)
    if rest or not 0 <= value < math.inf:
        raise click.BadParameter(f"{text!r} is not a share, such as 0.5% or 0.005.")
    return value


def several(one: Callable[[str], Any]) -> Callable[[str], tuple[Any, ...]]:
    """Return a reader of one or more values with commas between them."""

    def read(text: str) -> tuple[Any, ...]:
        return tuple(one(part.strip()) for part in text.split(","))

    return read


class Place(click.types.StringParamType):
    """A path: any text is one, and a shell completes it by the names that there are.

    Parameters
    ----------
    kind : {"file", "dir"}
    """

    name = "path"

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Leave it to the shell."""
        return [CompletionItem(incomplete, type=self.kind)]


FILE: Final = Place("file")
FOLDER: Final = Place("dir")


def name_formats(command: Command) -> Command:
    """Put the mesh formats into the help text of a command, where it has "{formats}"."""
    command.__doc__ = (command.__doc__ or "").replace("{formats}", TITLES)
    return command


def epilog(examples: str, *more: str) -> str:
    """Return what a help page ends with: examples, explanations, exit codes, line by line."""
    blocks = [*more, f"Examples:\n{textwrap.indent(textwrap.dedent(examples).strip(), '  ')}"]
    return "\n\n".join(f"\b\n{block}" for block in [*blocks, EXIT_CODES])


def _remember_debug(ctx: click.Context, param: click.Parameter, value: bool) -> None:
    ctx.ensure_object(Settings).debug |= value


def debug(command: Command) -> Command:
    """Add `--debug`."""
    return click.option(
        "--debug",
        is_flag=True,
        expose_value=False,
        callback=_remember_debug,
        envvar="DELTAMESH_DEBUG",
        help="Show the traceback of a failure; also by the environment variable DELTAMESH_DEBUG.",
    )(command)


def quiet(command: Command) -> Command:
    """Add `--quiet`."""
    return click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors.")(command)


def verbosity(command: Command) -> Command:
    """Add `--quiet`, `--verbose` and `--progress`."""
    command = click.option(
        "--progress/--no-progress",
        "show_progress",
        default=None,
        help="Show what is going on, on standard error.  [default: on a terminal]",
    )(command)
    command = click.option(
        "-v", "--verbose", is_flag=True, help="Tell each stage and its seconds on standard error."
    )(command)
    return quiet(command)


def as_json(command: Command) -> Command:
    """Add `--json`."""
    return click.option(
        "--json", "as_json", is_flag=True, help="Print JSON on standard output, one object a line."
    )(command)


def output(default: str) -> Callable[[Command], Command]:
    """Add the argument OUT, `--output` and `--force`; `default` tells what OUT is without them."""

    def add(command: Command) -> Command:
        command = click.option(
            "-f", "--force", is_flag=True, help="Overwrite OUT; write bytes to a terminal."
        )(command)
        command = click.option(
            "-o",
            "--output",
            type=FILE,
            metavar="OUT",
            help=f"The file to write.  [default: {default}]",
        )(command)
        return click.argument("target", type=FILE, metavar="[OUT]", required=False)(command)

    return add


def input_format(command: Command) -> Command:
    """Add `--input-format`."""
    return click.option(
        "--input-format",
        type=_MESH_FORMAT,
        help="Format of the mesh that is read.  [default: by the extension]",
    )(command)


def output_format(command: Command) -> Command:
    """Add `--output-format`."""
    return click.option(
        "--output-format",
        type=_MESH_FORMAT,
        help="Format of OUT.  [default: by its extension, or what was encoded]",
    )(command)


def solver(command: Command) -> Command:
    """Add `--solver`."""
    return click.option(
        "--solver",
        type=click.Choice(SOLVERS),
        default="auto",
        show_default=True,
        help="Who solves the least-squares system; pardiso needs the extra `mkl`.",
    )(command)


def threads(command: Command) -> Command:
    """Add `--threads`."""
    return click.option(
        "-T",
        "--threads",
        type=whole(1),
        metavar="N",
        help="Threads of the solver; the output does not depend on it.  [default: one a core]",
    )(command)


def limits(command: Command) -> Command:
    """Add `--max-vertices` and `--memory`, what a decoder may use."""
    command = click.option(
        "--memory",
        type=size,
        metavar="SIZE",
        help="Refuse a file whose decoding would need more, such as 512M or 8G.",
    )(command)
    return click.option(
        "--max-vertices",
        type=whole(0),
        metavar="N",
        help="Refuse a file of more vertices.",
    )(command)


def shown(name: str) -> str:
    """Return an option of the library as it is on the command line: --max-error for max_error."""
    return f"--{name.replace('_', '-')}"


def given(options: dict[str, Any]) -> dict[str, Any]:
    """Return the options that were given, so that the library's defaults hold for the others."""
    return {name: value for name, value in options.items() if value is not None}
