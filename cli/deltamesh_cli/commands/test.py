"""`deltamesh test`: whether `.dmesh` files are whole."""

from __future__ import annotations

from typing import Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.output import print_json, shown
from deltamesh_cli.progress import progress
from deltamesh_cli.signals import interruptible

_EXAMPLES = """\
deltamesh test bunny.ply.dmesh
deltamesh test -q archive/*.dmesh && echo all whole
"""


@click.command(epilog=options.epilog(_EXAMPLES))
@click.argument("sources", type=options.FILE, metavar="FILE...", nargs=-1, required=True)
@options.solver
@options.threads
@options.limits
@options.as_json
@options.verbosity
@options.debug
def command(
    sources: tuple[str, ...],
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Tell whether .dmesh files are whole.

    Each is decoded completely, and nothing is written. The checksum of every section and that of
    the decoded integers must agree, and the mesh must come out. All files are tested, whatever
    becomes of each; the exit code is the worst. Attributes, names and the order are decoded and
    checked as all else is.
    """

    def test(source: str) -> None:
        data = files.read_input(source)
        with (
            progress(show_progress, verbose=verbose, quiet=quiet) as stage,
            attempt(source, "damaged or refused"),
        ):
            import deltamesh

            given = options.given(parameters)
            container = interruptible(lambda: deltamesh.verify(data, progress=stage, **given))
        if as_json:
            counts = {"vertices": container.vertices, "faces": container.triangles}
            print_json({"file": source, "ok": True, "bytes": container.size, **counts})
        elif not quiet:
            click.echo(f"{shown(source)}: OK")

    each(sources, test, as_json=as_json)
