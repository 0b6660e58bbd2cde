"""`deltamesh test`: a check that `.dmesh` files are intact."""

from __future__ import annotations

from typing import Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.inputs import DMESH, Choice, chosen_files, on_checked
from deltamesh_cli.output import display_name, print_json
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE

_EXAMPLES = """\
deltamesh test bunny.ply.dmesh
deltamesh test -q -r archive && echo all intact
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("sources", type=FILE, metavar="[FILE|FOLDER]...", nargs=-1)
@chosen_files
@options.decoding
@options.reporting
def command(
    sources: tuple[str, ...],
    choice: Choice,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Check that .dmesh files are intact.

    A FOLDER stands for the .dmesh files in it. Each file, which may be compressed with gzip or
    zstandard, is decoded completely, including its attributes, names and order, and nothing is
    written. The checksums of every section and of the
    decoded integers have to match, and decoding has to yield a mesh. A damaged file does not keep
    the others from being checked; the exit code is the worst one.
    """
    choice.require(sources)

    def test(source: str) -> None:
        data = files.read_input(source, parameters)
        with (
            displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress,
            attempt(source, "damaged or refused"),
        ):
            import deltamesh

            keywords = options.specified(parameters)
            container = interruptible(lambda: deltamesh.verify(data, progress=progress, **keywords))
        if as_json:
            counts = {"vertices": container.vertices, "faces": container.triangles}
            print_json({"file": source, "ok": True, "bytes": container.size, **counts})
        elif not quiet:
            click.echo(f"{display_name(source)}: OK")

    process_all_and_exit(choice.inputs(sources, DMESH), on_checked(test), as_json=as_json)
