"""`deltamesh info`: what a `.dmesh` file says about itself, without decoding it."""

from __future__ import annotations

import click

from deltamesh_cli import files, options, summary
from deltamesh_cli.failures import attempt, each
from deltamesh_cli.meshes import container_of
from deltamesh_cli.output import print_json

_EXAMPLES = """\
deltamesh info bunny.ply.dmesh
deltamesh info --json *.dmesh | jq .bits_per_vertex
deltamesh info --json scan.dmesh | jq '.attributes[] | {name, bytes}'
deltamesh info --json scene.dmesh | jq '.parts[] | {kind, names}'
"""


@click.command(epilog=options.epilog(_EXAMPLES))
@click.argument("sources", type=options.FILE, metavar="FILE...", nargs=-1, required=True)
@options.as_json
@options.debug
def command(sources: tuple[str, ...], as_json: bool) -> None:
    """Show what .dmesh files hold, without decoding.

    That is parameters, sizes, attributes, names of parts, metadata, what of the source was not
    kept, and errors. The errors are those that the encoder measured: RMS and largest distance of
    the vertices, as fractions of the bounding box diagonal, mean deviation of the face normals and
    of the dihedral angles, in degrees. Of each attribute, it is the largest error of any number; of
    unit normals, the largest angle. Of long lists of names the first are shown; --json, which
    prints one object a file, has them all, and lengths in the unit of the mesh too.

    The checksums of all sections are verified, but nothing is decoded: that is deltamesh test. A
    file that cannot be read is reported, and the others are shown.
    """

    def info(source: str) -> None:
        container = container_of(source, files.read_input(source), "cannot read")
        with attempt(source, "cannot read"):
            found = (summary.as_object if as_json else summary.as_text)(source, container)
        if isinstance(found, str):
            click.echo(found)
        else:
            print_json(found)

    each(sources, info, as_json=as_json)
