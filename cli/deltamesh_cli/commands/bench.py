"""`deltamesh bench`: bytes and errors of one's own meshes, and whether they have grown."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import fields
from itertools import product
from typing import TYPE_CHECKING, Any, Final

import click
from click.core import ParameterSource

from deltamesh._methods import BOUNDS, RATES
from deltamesh._options import Options
from deltamesh_cli import files, measuring, options
from deltamesh_cli.commands.encode import command as encode
from deltamesh_cli.failures import DONE, tried
from deltamesh_cli.progress import progress
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh.bench import Measurement, Row

# Of the options that say how to encode: those that may be lists, and those that are not encode's.
_LISTS: Final = ("method", *RATES, *BOUNDS)
_OWN: Final = ("solver", "threads", "source_format", "drop_isolated")

_COLUMNS: Final = """\
Columns:
  bytes, bits/vertex    of the whole file (which names no source format)
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


@click.command(epilog=options.epilog(_EXAMPLES, _COLUMNS))
@click.argument("sources", type=options.FILE, metavar="FILE|FOLDER...", nargs=-1, required=True)
@click.option("-r", "--recursive", is_flag=True, help="Take the folders within folders, too.")
@click.option(
    "--drop-isolated",
    is_flag=True,
    help="Leave out the vertices that belong to no face, as --peers always does.",
)
@click.option(
    "--peers",
    type=options.several(click.Choice(measuring.PEERS)),
    metavar="PEER,...",
    help=f"Measure other codecs as well: {', '.join(measuring.PEERS)}. What is not installed (extra"
    " `bench`) is skipped.",
)
@click.option(
    "--peer-bits",
    type=options.several(click.IntRange(1, 16)),
    default=",".join(map(str, measuring.PEER_BITS)),
    show_default=True,
    metavar="B,...",
    help="Bits per coordinate of draco and meshopt.",
)
@click.option(
    "--save",
    type=options.FILE,
    metavar="CSV",
    help="Write bytes and errors, for --check, into a file.",
)
@click.option("-f", "--force", is_flag=True, help="Overwrite the file of --save.")
@click.option(
    "--check",
    type=options.FILE,
    metavar="CSV",
    help="Compare with a file of --save: exit with 4, and tell what is worse.",
)
@click.option(
    "--tolerance",
    type=options.share,
    default="0.5%",
    show_default=True,
    metavar="SHARE",
    help="By how much --check lets bytes grow.",
)
@click.option(
    "--error-tolerance",
    type=options.share,
    default="1%",
    show_default=True,
    metavar="SHARE",
    help="By how much --check lets an error grow; machines round differently.",
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
    recursive: bool,
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
    **encoding: Any,
) -> None:
    """Measure what becomes of mesh files: bytes, errors, seconds.

    Each is encoded, decoded and compared, all in memory. Files are {formats}; a folder stands for
    those in it. The options of encoding are those of deltamesh encode; method and rates may be
    lists, or be repeated: all are tried with all. A file that fails is reported, and the rest is
    measured.

    --save keeps the rows, and --check compares with them: bytes or errors that have grown by more
    than the tolerances, another mesh, and missing rows make the exit code 4. Without options of
    encoding, --check repeats what the rows say. Rows of other meshes count as missing where a
    folder is given, and do not matter where files are.
    """
    if as_csv and as_json:
        raise click.UsageError("--csv and --json exclude each other.")
    labels = [*_labels(dict(encoding)), *measuring.peer_labels(peers or (), peer_bits)]
    found = measuring.mesh_files(sources, recursive)
    old: list[Row] = []
    new: list[Measurement] = []
    codes = [DONE]

    def over(items: Iterable[Any], action: Callable[[Any], object]) -> None:
        codes.append(tried(items, action, as_json=as_json))

    def wanted(name: str) -> list[str]:
        repeated = [] if peers or _given(encoding) else measuring.labels_of(name, old)
        return repeated or labels

    def measure(name: str) -> None:
        before, path = len(new), found[name]
        codecs = measuring.codecs(wanted(name), skipped, solver=solver, threads=threads)
        bare = drop_isolated or measuring.any_peer(wanted(name))
        with progress(show_progress, verbose=verbose, quiet=quiet) as stage:
            mesh = measuring.read(path, stage, bare=bare)
            over(codecs, lambda one: new.append(measuring.measured(name, path, mesh, one, stage)))
        if as_json:
            measuring.print_objects(new[before:])
        elif not (quiet or as_csv):
            measuring.print_table(path, new[before:])

    if check:
        over([check], lambda path: old.extend(measuring.saved(path)))
    if save:
        over([save], lambda path: files.check_output(files.STDIO, path, force=force, text=True))
    if not any(codes):
        skipped = measuring.skipped(label for name in found for label in wanted(name))
        over(found, measure)
        if as_csv:
            measuring.print_csv(new)
        if save:
            over([save], lambda path: measuring.save(path, new, force=force))
        if check:
            folders = any(map(os.path.isdir, sources))
            kept = [row for row in old if folders or row["mesh"] in found]
            changed = measuring.changes(kept, new, tolerance, error_tolerance)
            silent = quiet or as_csv
            codes.append(measuring.tell(check, changed, len(new), as_json=as_json, quiet=silent))
    click.get_current_context().exit(max(codes))


def _labels(given: dict[str, Any]) -> list[str]:
    """Return the label of each method with each rate."""
    from deltamesh.bench import label

    lists = {name: _flat(given.pop(name, ())) for name in _LISTS}
    methods = [{"method": method} for method in lists.pop("method")] or [{}]
    rates = [{name: value} for name, values in lists.items() for value in values] or [{}]
    common = options.given(given)
    try:
        return [
            label(Options(**method, **rate, **common)) for method, rate in product(methods, rates)
        ]
    except OptionError as error:
        raise click.UsageError(f"{error}.") from error


def _flat(value: Any) -> list[Any]:
    """Return the values of an option that may be a list and be repeated; or is a flag."""
    if isinstance(value, tuple):
        return [one for part in value for one in part]
    return [value] if value else []


def _given(names: Iterable[str]) -> bool:
    """Tell whether one of these parameters is on the command line."""
    source = click.get_current_context().get_parameter_source
    return any(source(name) is ParameterSource.COMMANDLINE for name in names)


def _encoding_options() -> list[click.Parameter]:
    """Return the options of encode that say how to encode, some of them as lists."""
    names = {field.name for field in fields(Options)}.difference(_OWN)
    found = [one for one in encode.params if isinstance(one, click.Option) and one.name in names]
    return [_as_list(one) if one.name in _LISTS and not one.is_flag else one for one in found]


def _as_list(option: click.Option) -> click.Option:
    kind = option.type
    metavar = "|".join(kind.choices) if isinstance(kind, click.Choice) else option.metavar
    default = f"  [default: {option.default}]" if isinstance(option.default, str) else ""
    return click.Option(
        [*option.opts, str(option.name)],
        type=options.several(kind),
        multiple=True,
        metavar=f"{metavar},...",
        help=f"{option.help}{default}",
    )


command.params[1:1] = _encoding_options()
