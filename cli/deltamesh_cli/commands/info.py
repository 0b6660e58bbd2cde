"""`deltamesh info`: the description of a `.dmesh` file, without decoding it."""

from __future__ import annotations

import click

from deltamesh_cli import files, options
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.inputs import DMESH, Choice, chosen_files, on_checked
from deltamesh_cli.meshes import parse_container
from deltamesh_cli.output import print_json
from deltamesh_cli.summary import container_object, described_container
from deltamesh_cli.value_types import FILE

_EXAMPLES = """\
deltamesh info bunny.ply.dmesh
deltamesh info -r archive --include 'scan*'
deltamesh info --json *.dmesh | jq .bits_per_vertex
deltamesh info --json scan.dmesh | jq '.attributes[] | {name, bytes}'
deltamesh info --json scene.dmesh | jq '.parts[] | {kind, names}'
head -c 20000 scan.dmesh | deltamesh info - --partial
"""


@click.command(epilog=epilog(_EXAMPLES))
@click.argument("sources", type=FILE, metavar="[FILE|FOLDER]...", nargs=-1)
@chosen_files
@options.partial
@options.as_json
@options.debug
def command(sources: tuple[str, ...], choice: Choice, partial: bool, as_json: bool) -> None:
    """Describe .dmesh files without decoding them.

    The description has parameters, sizes, attributes, names of parts, metadata, the content of the
    source that was not kept, and errors. The encoder measured these errors: the RMS distance and
    the largest distance of the vertices as fractions of the diagonal of the bounding box, and the
    mean deviation of the face normals and of the dihedral angles in degrees. The error of an
    attribute is the largest error of any of its numbers or, for unit normals, the largest angle.
    Only the first names of a long list are shown. --json prints one object per file, which has all
    names, and lengths in the unit of the mesh as well.

    The stages are what deltamesh decode --partial makes of the first bytes of a file. With
    --partial, a file may be cut: its whole sections are described, and what it lacks is named.

    A FOLDER stands for the .dmesh files in it. Files may be compressed with gzip or zstandard.
    Sizes are those without this compression. The checksums of all sections are verified, but only
    deltamesh test decodes the files. A file that cannot be read is reported, and the others are
    described.
    """
    choice.require(sources)

    def info(source: str) -> None:
        data = files.read_input(source, partial=partial)
        container = parse_container(source, data, "cannot read", partial=partial)
        with attempt(source, "cannot read"):
            describe = container_object if as_json else described_container
            description = describe(source, container)
        if isinstance(description, str):
            click.echo(description)
        else:
            print_json(description)

    process_all_and_exit(choice.inputs(sources, DMESH), on_checked(info), as_json=as_json)
