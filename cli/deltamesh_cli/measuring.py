"""What `deltamesh bench` is made of: finding meshes, measuring them, and telling what came out."""

from __future__ import annotations

import errno
import math
import os
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, Final

import click

from deltamesh.batch import Selection, find
from deltamesh_cli import files
from deltamesh_cli.failures import DONE, MISSED, attempt
from deltamesh_cli.meshes import parsed
from deltamesh_cli.output import print_json, shown, table
from deltamesh_cli.progress import Stage
from deltamesh_cli.signals import interruptible
from deltamesh_formats.meshfiles.formats import EXTENSIONS

if TYPE_CHECKING:
    from deltamesh._mesh import TriangleMesh
    from deltamesh.bench import Change, Codec, Measurement, Row

PEERS: Final = ("draco", "meshopt", "zstd")
PEER_BITS: Final = (10, 11, 12)

# What a table shows: heading and column of a row.
_SHOWN: Final = {
    "codec": "codec",
    "bytes": "bytes",
    "bits/vertex": "bpv",
    "RMS": "rms",
    "max": "max",
    "Hausdorff": "hausdorff",
    "visual": "visual",
    "normals": "normal_deg",
    "dihedral": "dihedral_deg",
    "enc s": "encode_seconds",
    "dec s": "decode_seconds",
}


def mesh_files(sources: Iterable[str], recursive: bool) -> dict[str, str]:
    """Return the paths of mesh files by their names in a table.

    A file is named by its last part, one of a folder by its path below the folder; where that is
    not unique, all are named by their paths. So a table is the same wherever the folder is. A
    folder without mesh files stands for itself, and reading it fails.
    """
    found = [
        (os.path.relpath(path, source) if os.path.isdir(source) else os.path.basename(path), path)
        for source in sources
        for path in _below(source, recursive) or [source]
    ]
    paths = {path for _, path in found}
    unique = len({name for name, _ in found}) == len(paths)
    return {(name if unique else path).replace(os.sep, "/"): path for name, path in found}


def _below(source: str, recursive: bool) -> list[str]:
    """Return the mesh files of a folder, sorted; none of a file."""
    if not os.path.isdir(source):
        return []
    chosen = Selection(tuple(EXTENSIONS), recursive=recursive, shallow=not recursive)
    with attempt(source, "cannot list"):
        return find([source], chosen)


def read(path: str, stage: Stage, *, bare: bool) -> TriangleMesh:
    """Read a mesh file; a bare mesh is welded and has no isolated vertices.

    Raises
    ------
    Failure
        It cannot be read, is not a mesh, or a folder without any.
    """
    with attempt(path, "cannot read", "-r looks into its folders"):
        if os.path.isdir(path):
            raise FileNotFoundError(errno.ENOENT, "there is no mesh file in this folder")
    found = parsed(path, files.read_input(path), None, stage)
    with attempt(path, "cannot read"):
        from deltamesh._compare.welding import welded, without_isolated
        from deltamesh._mesh import LARGEST, triangulated
        from deltamesh_formats.polymesh.validation import checked

        mesh = triangulated(checked(found, LARGEST))
        return without_isolated(welded(mesh)) if bare else mesh


def measured(name: str, path: str, mesh: TriangleMesh, codec: Codec, stage: Stage) -> Measurement:
    """Measure a mesh under a codec.

    Raises
    ------
    Failure
    """
    from deltamesh import bench

    with attempt(path, f"cannot measure {codec.label}"):
        stage("loading")
        interruptible(lambda: _warm_up(codec.label.split()[0]))
        stage(codec.label)
        return interruptible(lambda: bench.measure(name, mesh, codec))


@cache
def _warm_up(method: str) -> None:
    from deltamesh import bench

    if method not in PEERS:
        bench.warm_up(bench.codec_of(method))


def peer_labels(names: Iterable[str], bits: Sequence[int]) -> list[str]:
    """Return the labels of other codecs at each number of bits."""
    from deltamesh.bench import labels

    return [label for name in names for label in labels(name, bits)]


def any_peer(labels: Iterable[str]) -> bool:
    """Tell whether one of these is another codec than ours."""
    return any(label.partition(" ")[0] in PEERS for label in labels)


def skipped(labels: Iterable[str]) -> set[str]:
    """Return the labels whose packages are not installed, and name them on standard error."""
    from deltamesh.bench import missing

    absent = {label: missing(label) for label in dict.fromkeys(labels)}
    for label, packages in absent.items():
        if packages:
            text = f"skipped: {label}: not installed: {', '.join(packages)}"
            click.echo(f"deltamesh: {text} (pip install 'deltamesh[bench]')", err=True)
    return {label for label, packages in absent.items() if packages}


def codecs(
    labels: Iterable[str], without: Collection[str], *, solver: str, threads: int | None
) -> list[Codec]:
    """Return the codecs of labels, but for some.

    Raises
    ------
    Failure
        A label names none.
    """
    from deltamesh import bench

    found = []
    for label in labels:
        if label not in without:
            with attempt(label, "no codec of this name"):
                found.append(bench.codec_of(label, solver=solver, threads=threads))
    return found


def saved(path: str) -> list[Row]:
    """Return the rows of a file that `save` has written.

    Raises
    ------
    Failure
    """
    from deltamesh.bench import from_text

    data = files.read_input(path)
    with attempt(path, "cannot compare with it"):
        return from_text(data.decode(errors="replace"))


def save(path: str, measurements: Iterable[Measurement], *, force: bool) -> None:
    """Write a file of rates; with `force` one that exists is replaced.

    Raises
    ------
    Failure
    """
    from deltamesh.bench import as_text, row_of

    text = as_text(map(row_of, measurements))
    files.write_output(path, text.encode(), force=force)


def labels_of(name: str, rows: Iterable[Row]) -> list[str]:
    """Return the codecs of a mesh in a table; of one that it lacks, those of all the others."""
    pairs = [(row["mesh"], row["codec"]) for row in rows]
    own = [codec for mesh, codec in pairs if mesh == name]
    return list(dict.fromkeys(own or [codec for _, codec in pairs]))


def print_table(path: str, measurements: Sequence[Measurement]) -> None:
    """Print the measurements of one mesh for people."""
    from deltamesh.bench import row_of

    if not measurements:
        return
    first, rows = measurements[0], [row_of(one) for one in measurements]
    click.echo(f"{shown(path)}: {first.vertices} vertices, {first.faces} faces")
    cells = ([row[column] for column in _SHOWN.values()] for row in rows)
    click.echo(f"{table([list(_SHOWN), *cells])}\n")


def print_csv(measurements: Iterable[Measurement]) -> None:
    """Print all rows, with times."""
    from deltamesh.bench import COLUMNS, SECONDS, as_text, row_of

    click.echo(as_text(map(row_of, measurements), (*COLUMNS, *SECONDS)), nl=False)


def print_objects(measurements: Iterable[Measurement]) -> None:
    """Print one JSON object a measurement; lengths are fractions of the diagonal."""
    for one in measurements:
        print_json({**vars(one), "sections": dict(one.sections), "bits_per_vertex": one.bpv})


def changes(
    old: Iterable[Row], new: Iterable[Measurement], tolerance: float, error_tolerance: float
) -> list[Change]:
    """Return what differs by more than it may."""
    from deltamesh import bench

    rows = map(bench.row_of, new)
    return bench.changes(old, rows, tolerance=tolerance, error_tolerance=error_tolerance)


def tell(path: str, changed: Sequence[Change], count: int, *, as_json: bool, quiet: bool) -> int:
    """Tell what changed against a file, and return the exit code."""
    worse = sum(one.worse for one in changed)
    if changed:
        click.echo(f"deltamesh: not as in {shown(path)}:", err=True)
        click.echo(change_table(changed), err=True)
    if as_json:
        for one in changed:
            print_json({"check": path, **vars(one), "worse": one.worse})
    elif not (quiet or changed):
        click.echo(f"{count} rows are as in {shown(path)}")
    return MISSED if worse else DONE


def change_table(changed: Iterable[Change]) -> str:
    """Return what changed as a table."""
    heading = ("mesh", "codec", "column", "before", "now", "", "")
    return table([heading, *_change_rows(changed)])


def _change_rows(changed: Iterable[Change]) -> Iterator[tuple[str, ...]]:
    for one in changed:
        known = one.growth is not None and math.isfinite(one.growth)
        growth = f"{100 * one.growth:+.2f} %" if known and one.growth is not None else ""
        yield (one.mesh, one.codec, one.column, one.before, one.now, growth, one.verdict)
