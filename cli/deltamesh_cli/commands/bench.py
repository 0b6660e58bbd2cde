"""`deltamesh bench`: file sizes and errors of meshes, and a check that they have not grown."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, Final

import click
from click.core import ParameterSource

from deltamesh.bench import PEER_NAMES
from deltamesh_cli import files, measuring, options, rate_tables
from deltamesh_cli.bench_options import bench_options, labels_of
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import DONE, process_all
from deltamesh_cli.inputs import MESH, Choice, chosen_files
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.reports.measurements import BenchReport
from deltamesh_cli.reports.writing import check_report, write_report
from deltamesh_cli.value_types import FILE, comma_separated, fraction

if TYPE_CHECKING:
    from deltamesh.bench import Codec, Measurement, Row

_COLUMNS: Final = """\
Columns:
  bytes, bits/vertex    of the whole file (without a source format)
  RMS, max              distances of vertices    | fractions of the
  Hausdorff             distance of surfaces     | diagonal of the
  visual                position and smoothness  | bounding box
  normals, dihedral     mean deviations in degrees
  enc s, dec s          seconds to encode and to decode"""
_EXAMPLES: Final = """\
deltamesh bench bunny.ply
deltamesh bench bunny.ply --method highpass,cartesian --step 0.001,0.002
deltamesh bench bunny.ply -b 0 --anchors 9,99 --anchor-method greedy,random
deltamesh bench scans -r --normal-error 1 --peers draco,meshopt,zstd
deltamesh bench scans -r --csv > all.csv
deltamesh bench scans -r --peers draco --html all.html
deltamesh bench scans -r --save rates.csv
deltamesh bench scans -r --check rates.csv --tolerance 0.5%
"""


@click.command(params=bench_options(), epilog=epilog(_EXAMPLES, _COLUMNS))
@click.argument("sources", type=FILE, metavar="[FILE|FOLDER]...", nargs=-1)
@chosen_files
@click.option(
    "--drop-isolated",
    is_flag=True,
    help="Leave out vertices that belong to no face, as --peers always does.",
)
@click.option(
    "--peers",
    type=comma_separated(click.Choice(PEER_NAMES)),
    metavar="PEER,...",
    help=f"Measure other codecs as well: {', '.join(PEER_NAMES)}. Codecs that are not installed"
    " (extra `bench`) are skipped.",
)
@click.option(
    "--peer-bits",
    type=comma_separated(click.IntRange(1, 16)),
    default=",".join(map(str, measuring.PEER_BITS)),
    show_default=True,
    metavar="B,...",
    help="Bits per coordinate of draco and meshopt.",
)
@click.option(
    "--save",
    type=FILE,
    metavar="CSV",
    help="Write sizes and errors into a file for --check.",
)
@click.option(
    "--html",
    "page",
    type=FILE,
    metavar="PAGE",
    help="Write a page with curves, a table, and the meshes beside each other at equal bytes.",
)
@click.option("-f", "--force", is_flag=True, help="Overwrite the files of --save and --html.")
@click.option(
    "--check",
    type=FILE,
    metavar="CSV",
    help="Compare with a file of --save; if anything is worse, report it and exit with code 4.",
)
@click.option(
    "--tolerance",
    type=fraction,
    default="0.5%",
    show_default=True,
    metavar="FRACTION",
    help="Growth in size that --check allows.",
)
@click.option(
    "--error-tolerance",
    type=fraction,
    default="1%",
    show_default=True,
    metavar="FRACTION",
    help="Growth of an error that --check allows, because machines round differently.",
)
@options.solver
@options.threads
@click.option("--csv", "as_csv", is_flag=True, help="Print CSV on standard output.")
@options.reporting
@options.name_formats
def command(
    sources: tuple[str, ...],
    choice: Choice,
    drop_isolated: bool,
    peers: tuple[str, ...] | None,
    peer_bits: tuple[int, ...],
    save: str | None,
    page: str | None,
    force: bool,
    check: str | None,
    tolerance: float,
    error_tolerance: float,
    solver: str,
    threads: int | None,
    as_csv: bool,
    as_json: bool,
    quiet: bool,
    verbose: bool,
    show_progress: bool | None,
    **parameters: Any,
) -> None:
    """Measure file sizes, errors and times of meshes.

    Each mesh is encoded, decoded and compared, all in memory. A FILE is {formats}, and may be
    compressed, as scan.ply.zst; a FOLDER stands for the mesh files in it. The options that say how
    to encode are those of deltamesh encode. The method, the anchors and their choice, the rates and
    the bounds may be lists or be repeated; every method is measured with every number and choice of
    anchors and with every rate and bound. A file that fails is reported, and the others are
    measured.

    --html writes one page that fetches nothing: curves of errors over sizes, a table that can be
    sorted and filtered, and as many of the files as fit, to look at from one place: the original,
    ours, and of each peer the one of about as many bytes.

    --save stores the measurements as rows of a table, and --check compares new measurements with
    such a table. The exit code is 4 if sizes or errors have grown by more than the tolerances, if a
    mesh has changed, or if rows are missing. Without options that say how to encode, --check
    repeats the measurements of the table. Rows of other meshes count as missing if a FOLDER is
    given, and are ignored if only FILEs are given.
    """
    if as_csv and as_json:
        raise click.UsageError("--csv and --json exclude each other.")
    labels = [*labels_of(dict(parameters)), *measuring.peer_labels(peers or (), peer_bits)]
    choice.require(sources)
    inputs = measuring.names_in_tables(choice.inputs(sources, MESH))
    saved_rows: list[Row] = []
    measurements: list[Measurement] = []
    codes = [DONE]

    def process(
        items: Collection[Any], action: Callable[[Any], object], kind: str = "files"
    ) -> None:
        codes.append(process_all(items, action, as_json=as_json, kind=kind))

    def labels_for(name: str) -> list[str]:
        repeat = not (peers or _on_command_line(parameters))
        return (measuring.labels_in(saved_rows, name) if repeat else []) or labels

    def measure(name: str) -> None:
        before, path = len(measurements), inputs[name].checked()
        codecs = measuring.codecs_of(labels_for(name), skipped, solver=solver, threads=threads)
        bare = drop_isolated or measuring.has_peer(labels_for(name))
        with displayed_progress(show_progress, verbose=verbose, quiet=quiet) as progress:
            mesh = measuring.read_triangles(path, progress, bare=bare)

            def add(codec: Codec) -> None:
                measurement, coded = measuring.measure_mesh(name, path, mesh, codec, progress)
                measurements.append(measurement)
                if report is not None:
                    report.add(measurement, coded)

            with nullcontext() if report is None else report.mesh(name, path):
                process(codecs, add, kind="codecs")
        if as_json:
            rate_tables.print_objects(measurements[before:])
        elif not (quiet or as_csv):
            rate_tables.print_table(path, measurements[before:])

    if check:
        process([check], lambda path: saved_rows.extend(measuring.read_rates(path)))
    report = BenchReport(len(inputs)) if page else None
    if save:
        process([save], lambda path: files.check_output(files.STDIO, path, force=force, text=True))
    if page:
        process([page], lambda path: check_report(path, force=force))
    if not any(codes):
        skipped = measuring.skip_missing_peers(
            label for name in inputs for label in labels_for(name)
        )
        process(inputs, measure)
        if as_csv:
            rate_tables.print_csv(measurements)
        if save:
            process([save], lambda path: measuring.write_rates(path, measurements, force=force))
        if page and report is not None:
            process([page], lambda path: write_report(path, report.page, force=force))
        if check:
            has_folder = any(one.in_folder for one in inputs.values())
            rows = [row for row in saved_rows if has_folder or row["mesh"] in inputs]
            changed = measuring.changes(rows, measurements, tolerance, error_tolerance)
            codes.append(
                rate_tables.report_changes(
                    check, changed, len(measurements), as_json=as_json, quiet=quiet or as_csv
                )
            )
    click.get_current_context().exit(max(codes))


def _on_command_line(names: Iterable[str]) -> bool:
    """Return whether one of these parameters is on the command line."""
    source = click.get_current_context().get_parameter_source
    return any(source(name) is ParameterSource.COMMANDLINE for name in names)
