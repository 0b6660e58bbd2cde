"""`deltamesh bench`: file sizes and errors of meshes, and a check that they have not grown."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import fields
from itertools import product
from typing import TYPE_CHECKING, Any, Final

import click
from click.core import ParameterSource

from deltamesh._methods import BOUNDS, RATES
from deltamesh._options import ATTRIBUTE_BOUNDS, Options
from deltamesh.bench import PEER_NAMES
from deltamesh_cli import files, measuring, options, rate_tables
from deltamesh_cli.encode_options import encode_options
from deltamesh_cli.epilogs import epilog
from deltamesh_cli.failures import DONE, process_all
from deltamesh_cli.inputs import MESH, Choice, chosen_files
from deltamesh_cli.lengths import refuse_units, settle_shares
from deltamesh_cli.progress import displayed_progress
from deltamesh_cli.value_types import FILE, comma_separated, fraction
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh.bench import Measurement, Row

# The encode options that may be lists here, and those that have another meaning here or none.
_LISTS: Final = ("method", *RATES, *BOUNDS)
_NOT_SHARED: Final = (
    *("solver", "threads", "source_format", "drop_isolated", "importance"),
    *ATTRIBUTE_BOUNDS,
)

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
deltamesh bench scans -r --normal-error 1 --peers draco,meshopt,zstd
deltamesh bench scans -r --csv > all.csv
deltamesh bench scans -r --save rates.csv
deltamesh bench scans -r --check rates.csv --tolerance 0.5%
"""


def _bench_options() -> list[click.Parameter]:
    """Return the options that say how to encode, some of them as lists."""
    names = {field.name for field in fields(Options)}.difference(_NOT_SHARED)
    shared = options.parameters_of(encode_options)
    return [
        _as_list(one) if name in _LISTS else one for name, one in shared.items() if name in names
    ]


def _as_list(option: click.Option) -> click.Option:
    kind = option.type
    metavar = "|".join(kind.choices) if isinstance(kind, click.Choice) else option.metavar
    default = f"  [default: {option.default}]" if isinstance(option.default, str) else ""
    return click.Option(
        [*option.opts, str(option.name)],
        type=comma_separated(kind),
        multiple=True,
        metavar=f"{metavar},...",
        help=f"{option.help}{default}",
    )


@click.command(params=_bench_options(), epilog=epilog(_EXAMPLES, _COLUMNS))
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
@click.option("-f", "--force", is_flag=True, help="Overwrite the file of --save.")
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
@options.as_json
@options.verbosity
@options.debug
@options.name_formats
def command(
    sources: tuple[str, ...],
    choice: Choice,
    drop_isolated: bool,
    peers: tuple[str, ...] | None,
    peer_bits: tuple[int, ...],
    save: str | None,
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
    to encode are those of deltamesh encode. The method, the rates and the bounds may be lists or be
    repeated, and every method is measured with every rate and bound. A file that fails is reported,
    and the others are measured.

    --save stores the measurements as rows of a table, and --check compares new measurements with
    such a table. The exit code is 4 if sizes or errors have grown by more than the tolerances, if a
    mesh has changed, or if rows are missing. Without options that say how to encode, --check
    repeats the measurements of the table. Rows of other meshes count as missing if a FOLDER is
    given, and are ignored if only FILEs are given.
    """
    if as_csv and as_json:
        raise click.UsageError("--csv and --json exclude each other.")
    labels = [*_labels(dict(parameters)), *measuring.peer_labels(peers or (), peer_bits)]
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
            process(
                codecs,
                lambda codec: measurements.append(
                    measuring.measure_mesh(name, path, mesh, codec, progress)
                ),
                kind="codecs",
            )
        if as_json:
            rate_tables.print_objects(measurements[before:])
        elif not (quiet or as_csv):
            rate_tables.print_table(path, measurements[before:])

    if check:
        process([check], lambda path: saved_rows.extend(measuring.read_rates(path)))
    if save:
        process([save], lambda path: files.check_output(files.STDIO, path, force=force, text=True))
    if not any(codes):
        skipped = measuring.skip_missing_peers(
            label for name in inputs for label in labels_for(name)
        )
        process(inputs, measure)
        if as_csv:
            rate_tables.print_csv(measurements)
        if save:
            process([save], lambda path: measuring.write_rates(path, measurements, force=force))
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


def _labels(parameters: dict[str, Any]) -> list[str]:
    """Return the label of each method with each rate."""
    from deltamesh.bench import label

    lists = {name: _flat(parameters.pop(name, ())) for name in _LISTS}
    methods = [{"method": method} for method in lists.pop("method")] or [{}]
    rates = [{name: value} for name, values in lists.items() for value in values] or [{}]
    common = options.specified(parameters)
    try:
        for rate in rates:
            settle_shares(rate)
            refuse_units(rate)
        return [
            label(Options(**method, **rate, **common)) for method, rate in product(methods, rates)
        ]
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _flat(lists: tuple[tuple[Any, ...], ...]) -> list[Any]:
    """Return the values of an option that takes lists and may be repeated."""
    return [value for values in lists for value in values]


def _on_command_line(names: Iterable[str]) -> bool:
    """Return whether one of these parameters is on the command line."""
    source = click.get_current_context().get_parameter_source
    return any(source(name) is ParameterSource.COMMANDLINE for name in names)
