"""The command group, and the one place where the process begins and ends."""

from __future__ import annotations

import gc
import importlib
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Final

import click

from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import DONE, FAILED, SIGNALLED, USAGE, RunSettings, report_unexpected
from deltamesh_cli.output import display_name
from deltamesh_cli.signals import Stopped

# In the order in which a user needs them, with the first sentence of the help of each: `--help`
# imports none of them.
COMMANDS: Final = {
    "encode": "Compress a mesh file into a .dmesh file.",
    "decode": "Decode a .dmesh file into a mesh file.",
    "edit": "Add a pose to a .dmesh file, or remove poses.",
    "batch": "Encode or decode many files.",
    "info": "Describe .dmesh files without decoding them.",
    "test": "Check that .dmesh files are intact.",
    "compare": "Measure how far mesh B is from mesh A.",
    "view": "Show a mesh in the browser, beside its original.",
    "render": "Write a picture of a mesh, a PNG, without a browser.",
    "bench": "Measure file sizes, errors and times of meshes.",
    "completion": "Print a script that completes command lines.",
}

_INTERRUPTED: Final = SIGNALLED + 2  # SIGINT


class LazyGroup(click.Group):
    """A group that imports the module of a command when the command is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order in which a user needs them."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of a name: `command` in the module of that name."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(
            f"deltamesh_cli.commands.{cmd_name}"
        ).command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands with their summaries."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


_EXAMPLES = """\
deltamesh encode bunny.ply              writes bunny.ply.dmesh
deltamesh decode bunny.ply.dmesh -f     writes bunny.ply again
deltamesh info bunny.ply.dmesh          sizes, parameters, errors
deltamesh compare bunny.ply bunny.ply.dmesh
"""


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=epilog(_EXAMPLES),
)
@click.version_option(
    None, "-V", "--version", package_name="deltamesh", message="%(prog)s %(version)s"
)
def cli() -> None:
    """Compress meshes and keep all of their data.

    Connectivity is lossless, polygons remain polygons, and attributes, names of parts and comments
    are restored. Geometry is quantized as differential coordinates, so that the error is smooth:
    the surface has none of the noise that quantized x, y, z coordinates leave.
    """


def run(arguments: Sequence[str] | None = None) -> int:
    """Run one command line, report whatever goes wrong, and return the exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        The arguments without the name of the program; those of the process by default.
    """
    settings = RunSettings()
    try:
        code = cli.main(arguments, prog_name="deltamesh", standalone_mode=False, obj=settings)
        _flush()
    except click.ClickException as error:
        error.show()
        _hint_at_names(sys.argv[1:] if arguments is None else arguments)
        return USAGE
    except (click.Abort, KeyboardInterrupt):
        click.echo("deltamesh: interrupted", err=True)
        return _INTERRUPTED
    except Stopped as stopped:
        click.echo("deltamesh: terminated", err=True)
        return SIGNALLED + stopped.number
    except BrokenPipeError:
        return FAILED  # the reader of our output has seen enough, so there is nothing to report
    except Exception as error:
        report_unexpected(error, settings)
        return FAILED
    return code if isinstance(code, int) else DONE


def _hint_at_names(arguments: Sequence[str]) -> None:
    """Say how to give names that begin with "-", if there is one among refused arguments."""
    from deltamesh_cli.files import extension, without_suffix  # not for every command line
    from deltamesh_formats.meshfiles.formats import EXTENSIONS

    end = arguments.index("--") if "--" in arguments else len(arguments)
    for one in arguments[:end]:
        named = extension(one) in EXTENSIONS or without_suffix(one) is not None
        if one[:1] == "-" and "=" not in one and one != "-" and (named or os.path.lexists(one)):
            name = display_name(one)
            click.echo(
                f"Hint: if {name} is a file, put -- before it: deltamesh ... -- {name}", err=True
            )
            return


def _flush() -> None:
    """Flush standard output, so that a closed pipe is noticed here rather than at exit."""
    if sys.stdout is not None:
        sys.stdout.flush()


def run_and_exit() -> None:
    """Run the command line of this process and end the process."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # a file name may have characters that the terminal cannot encode
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # warnings are for programmers; -W shows them
    code = run()
    if code == DONE:
        gc.freeze()  # Python would search all objects for garbage, for 20 ms, before it ends
        sys.exit(DONE)
    # Not sys.exit: an abandoned thread may be in the middle of a solve (deltamesh_cli.signals),
    # and flushing to a broken pipe once more would print an error.
    os._exit(code)
