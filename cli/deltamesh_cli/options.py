"""Options that several commands share, each as a decorator."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import click

from deltamesh._options import SOLVERS
from deltamesh_cli.failures import RunSettings
from deltamesh_cli.value_types import FILE, size, whole
from deltamesh_formats.meshfiles.formats import FORMATS, MAX_DIGITS, READABLE, titles

Command = Callable[..., Any]
Decorator = Callable[[Command], Command]

_READ: Final = click.Choice(list(READABLE), case_sensitive=False)
_WRITTEN: Final = click.Choice(list(FORMATS), case_sensitive=False)


def name_formats(command: Command) -> Command:
    """Replace "{formats}" and "{written}" in the help text of a command by mesh formats."""
    text = (command.__doc__ or "").replace("{formats}", titles(READABLE.values()))
    command.__doc__ = text.replace("{written}", titles(FORMATS.values()))
    return command


def combined(*decorators: Decorator) -> Decorator:
    """Return one decorator that adds the options of several, in their order."""

    def add(command: Command) -> Command:
        for decorator in reversed(decorators):
            command = decorator(command)
        return command

    return add


def parameters_of(decorator: Decorator) -> dict[str, click.Option]:
    """Return the options that a decorator adds, by their parameter names."""

    def nothing(**parameters: Any) -> None: ...

    added = click.command()(decorator(nothing)).params
    return {str(one.name): one for one in added if isinstance(one, click.Option)}


def _remember_debug(ctx: click.Context, param: click.Parameter, value: bool) -> None:
    ctx.ensure_object(RunSettings).debug |= value


debug: Final = click.option(
    "--debug",
    is_flag=True,
    expose_value=False,
    callback=_remember_debug,
    envvar="DELTAMESH_DEBUG",
    help="Show the traceback of a failure; the environment variable DELTAMESH_DEBUG does the same.",
)

verbosity: Final = combined(
    click.option("-q", "--quiet", is_flag=True, help="Print nothing but errors."),
    click.option(
        "-v",
        "--verbose",
        is_flag=True,
        help="Print each stage and its seconds on standard error.",
    ),
    click.option(
        "--progress/--no-progress",
        "show_progress",
        default=None,
        help="Show progress on standard error.  [default: on a terminal]",
    ),
)

as_json: Final = click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print JSON on standard output, one object per line.",
)


def output(default: str, *, positional: bool = True) -> Decorator:
    """Add the argument OUT, `--output` and `--force`; `default` describes OUT without them.

    A command whose arguments end in OUT in some cases only takes it from them itself.
    """
    argument = click.argument("target", type=FILE, metavar="[OUT]", required=False)
    return combined(
        *([argument] if positional else []),
        click.option(
            "-o",
            "--output",
            type=FILE,
            metavar="OUT",
            help=f"The file to write.  [default: {default}]",
        ),
        click.option(
            "-f",
            "--force",
            is_flag=True,
            help="Overwrite OUT if it exists; allow bytes on a terminal.",
        ),
    )


input_format: Final = click.option(
    "--input-format",
    type=_READ,
    help="Format of the mesh file to read.  [default: by its extension]",
)

output_format: Final = click.option(
    "--output-format",
    type=_WRITTEN,
    help="Format of OUT.  [default: by its extension, otherwise the format that was encoded]",
)

digits: Final = click.option(
    "--digits",
    type=whole(0, MAX_DIGITS),
    metavar="N",
    help="Write positions with N decimal places into an obj or off file.  [default: a hundredth of"
    " the error of the file, or finer; all of a lossless file]",
)

solver: Final = click.option(
    "--solver",
    type=click.Choice(SOLVERS),
    default="auto",
    show_default=True,
    help="Solver of the least-squares system; auto is core for small meshes, pardiso needs the"
    " extra `mkl`.",
)

threads: Final = click.option(
    "-T",
    "--threads",
    type=whole(1),
    metavar="N",
    help="Number of threads that solve for positions, which does not change the output."
    "  [default: one per core]",
)

max_vertices: Final = click.option(
    "--max-vertices",
    type=whole(0),
    metavar="N",
    help="Refuse a file that has more vertices.",
)

memory: Final = click.option(
    "--memory",
    type=size,
    metavar="SIZE",
    help="Refuse a file that needs more memory to decode, such as 512M or 8G.",
)

limits: Final = combined(max_vertices, memory)

partial: Final = click.option(
    "--partial",
    is_flag=True,
    help="Take a file that is cut, and what has come of it.",
)

# All options that say how a file is decoded, and into which format.
decode_options: Final = combined(output_format, digits, solver, threads, limits)


def flag_of(name: str) -> str:
    """Return an option of the library as it is on the command line: --max-error for max_error."""
    return f"--{name.replace('_', '-')}"


def specified(parameters: dict[str, Any]) -> dict[str, Any]:
    """Return the options that the user gave; the library has defaults for the others."""
    return {name: value for name, value in parameters.items() if value is not None}
