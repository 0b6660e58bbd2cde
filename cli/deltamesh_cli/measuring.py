"""Measurements for `deltamesh bench`: naming meshes, measuring them, and comparing rates."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Final

from deltamesh._progress import Progress
from deltamesh.bench import PEER_NAMES
from deltamesh_cli import files
from deltamesh_cli.failures import attempt
from deltamesh_cli.inputs import Input
from deltamesh_cli.meshes import parse_mesh
from deltamesh_cli.output import message
from deltamesh_cli.signals import interruptible

if TYPE_CHECKING:
    from deltamesh._mesh import TriangleMesh
    from deltamesh.bench import Change, Codec, Coded, Measurement, Row

PEER_BITS: Final = (10, 11, 12)


def names_in_tables(inputs: Iterable[Input]) -> dict[str, Input]:
    """Return the mesh files by the names that they have in a table.

    A file has its last part as its name, a file in a folder its path below that folder. If these
    are not unique, all files have their paths as names. So a table does not depend on the place of
    the folder.
    """
    inputs = list(inputs)
    unique = len({one.name for one in inputs}) == len(inputs)
    return {one.name if unique else one.path.replace(os.sep, "/"): one for one in inputs}


def read_triangles(path: str, progress: Progress, *, bare: bool) -> TriangleMesh:
    """Read a mesh file as triangles; a bare mesh is welded and has no isolated vertices.

    Raises
    ------
    Failure
        If it cannot be read, or is not a mesh.
    """
    mesh = parse_mesh(path, files.read_input(path), None, progress)
    with attempt(path, "cannot read"):
        from deltamesh._compare.welding import welded, without_isolated
        from deltamesh._mesh import LARGEST, triangulated
        from deltamesh_formats.polymesh.validation import checked

        triangles = triangulated(checked(mesh, LARGEST))
        return without_isolated(welded(triangles)) if bare else triangles


def measure_mesh(
    name: str, path: str, mesh: TriangleMesh, codec: Codec, progress: Progress
) -> tuple[Measurement, Coded]:
    """Measure one codec on one mesh; return what it has made of it, too.

    Raises
    ------
    Failure
        If the codec fails.
    """
    from deltamesh import bench

    with attempt(path, f"cannot measure {codec.label}"):
        progress("loading")
        interruptible(lambda: _warm_up(codec.label.split()[0]))
        progress(codec.label)
        return interruptible(lambda: bench.measured(name, mesh, codec))


@cache
def _warm_up(method: str) -> None:
    from deltamesh import bench

    if method not in PEER_NAMES:
        bench.warm_up(bench.codec_of(method))


def peer_labels(names: Iterable[str], bits: Sequence[int]) -> list[str]:
    """Return the labels of other codecs at each number of bits."""
    from deltamesh.bench import labels

    return [label for name in names for label in labels(name, bits)]


def has_peer(labels: Iterable[str]) -> bool:
    """Return whether one of these labels is that of another codec."""
    return any(label.partition(" ")[0] in PEER_NAMES for label in labels)


def skip_missing_peers(labels: Iterable[str]) -> set[str]:
    """Return the labels whose packages are not installed, and report them on standard error."""
    from deltamesh.bench import missing

    absent = {label: missing(label) for label in dict.fromkeys(labels)}
    for label, packages in absent.items():
        if packages:
            text = f"skipped: {label}: not installed: {', '.join(packages)}"
            message(f"deltamesh: {text} (pip install 'deltamesh[bench]')")
    return {label for label, packages in absent.items() if packages}


def codecs_of(
    labels: Iterable[str], skipped: Collection[str], *, solver: str, threads: int | None
) -> list[Codec]:
    """Return the codecs of all labels that are not skipped.

    Raises
    ------
    Failure
        If no codec has such a label.
    """
    from deltamesh import bench

    codecs = []
    for label in labels:
        if label not in skipped:
            with attempt(label, "unknown codec"):
                codecs.append(bench.codec_of(label, solver=solver, threads=threads))
    return codecs


def read_rates(path: str) -> list[Row]:
    """Return the rows of a file that `write_rates` has written.

    Raises
    ------
    Failure
        If the file cannot be read or is not a table of rates.
    """
    from deltamesh.bench import from_text

    data = files.read_input(path)
    with attempt(path, "cannot compare with it"):
        return from_text(data.decode(errors="replace"))


def write_rates(path: str, measurements: Iterable[Measurement], *, force: bool) -> None:
    """Write a table of rates; with `force` an existing file is overwritten.

    Raises
    ------
    Failure
        If the file cannot be written.
    """
    from deltamesh.bench import as_text, row_of

    text = as_text(map(row_of, measurements))
    files.write_output(path, text.encode(), force=force)


def labels_in(rows: Iterable[Row], name: str) -> list[str]:
    """Return the codecs that a table has for a mesh, or all of its codecs if it lacks the mesh."""
    pairs = [(row["mesh"], row["codec"]) for row in rows]
    own = [codec for mesh, codec in pairs if mesh == name]
    return list(dict.fromkeys(own or [codec for _, codec in pairs]))


def changes(
    old: Iterable[Row], new: Iterable[Measurement], tolerance: float, error_tolerance: float
) -> list[Change]:
    """Return the differences between rows and measurements that exceed their tolerances."""
    from deltamesh import bench

    rows = map(bench.row_of, new)
    return bench.changes(old, rows, tolerance=tolerance, error_tolerance=error_tolerance)
