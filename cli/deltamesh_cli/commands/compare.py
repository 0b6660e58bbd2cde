"""`deltamesh compare`: the differences between two meshes in every metric."""

from __future__ import annotations

from typing import Any

import click

from deltamesh_cli import files, options
from deltamesh_cli.comparing import compare_meshes, comparison_object, comparison_text
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import attempt, process_all_and_exit
from deltamesh_cli.meshes import load_mesh
from deltamesh_cli.output import display_name, print_json
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.signals import interruptible
from deltamesh_cli.value_types import FILE

_METRICS = """\
Metrics, in the unit of A and as a fraction of its bounding box diagonal:
  RMS, max         distances between corresponding vertices
  Hausdorff        symmetric distance between the surfaces, by samples
  visual           0.15 Mq + 0.85 Sq of the papers: position and smoothness
and in degrees:
  face normals     mean deviation, weighted by area
  dihedral angles  mean change over the interior edges
Each attribute of A has its largest difference; normals, the largest angle.
Parts (objects, groups, materials) are alike if the same faces have the same
names."""
_EXAMPLES = """\
deltamesh compare bunny.ply bunny.ply.dmesh
deltamesh compare scan.glb scan.obj     shows the effect of a conversion
deltamesh compare --json a.obj b.obj | jq .errors.hausdorff
"""


@click.command(epilog=epilog(_EXAMPLES, _METRICS))
@click.argument("first", type=FILE, metavar="A")
@click.argument("second", type=FILE, metavar="B")
@options.input_format
@options.solver
@options.threads
@options.limits
@options.as_json
@options.verbosity
@options.debug
def command(
    first: str,
    second: str,
    input_format: str | None,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Measure how far mesh B is from mesh A.

    Each is a mesh file or a .dmesh file, and may be compressed with gzip or zstandard. Attributes
    and parts are compared face by face as well. Parts are reported even if only B has them,
    attributes only if A has them.

    The order of vertices and faces does not matter, nor do repeated positions and isolated
    vertices: each position and each face counts once. If the vertices still do not correspond
    because the connectivity differs, only the distance between the surfaces is measured.
    """
    if first == second == files.STDIO:
        raise click.UsageError("A and B cannot both be standard input.")

    def compare(name: str) -> None:
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            a = load_mesh(name, input_format, progress, **parameters)
            b = load_mesh(second, input_format, progress, **parameters)
            with attempt(second, f"cannot compare with {display_name(name)}"):
                comparison = interruptible(lambda: compare_meshes(a, b, progress))
        if as_json:
            print_json(comparison_object(name, second, comparison))
        elif not quiet:
            click.echo(comparison_text(name, second, comparison))

    process_all_and_exit([first], compare, as_json=as_json)
