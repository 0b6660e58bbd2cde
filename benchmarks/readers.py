"""Mesh files of folders in the readers of deltamesh, trimesh and meshio, side by side.

A file is read alike if it has as many triangles (a polygon of n corners counts as n - 2) and its
corners are at the same positions. Each reader works in a process of its own, which is killed when a
file takes too long.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Final

import click
import corpus
import numpy as np
from numpy.typing import NDArray

from deltamesh_cli.output import table
from deltamesh_formats.meshfiles.formats import EXTENSIONS, format_of_extension
from deltamesh_formats.printing import printable

_EXAMPLES = """\
python benchmarks/readers.py models
python benchmarks/readers.py --seconds 20 --all models/*.glb"""

# As a fraction of the diagonal: positions of float32 in a text have six to nine digits.
_TOLERANCE: Final = 1e-5
_REFUSED, _NO_SURFACE, _SLOW = "refused", "no surface", "too slow"


@dataclass(frozen=True)
class Outcome:
    """What became of a file in a reader.

    Attributes
    ----------
    refusal : str
        The kind of refusal, "" for a file that was read.
    message : str
        Of the exception.
    vertices, triangles : int
    points : float64 (n, 3)
        The distinct positions of corners of faces.
    """

    refusal: str = ""
    message: str = ""
    vertices: int = 0
    triangles: int = 0
    points: NDArray[np.float64] | None = None

    def __str__(self) -> str:
        if self.refusal:
            return f"{self.refusal}: {self.message}" if self.message else self.refusal
        return f"{self.vertices} vertices, {self.triangles} triangles"


def by_deltamesh(path: str) -> Outcome:
    """Read a file with deltamesh."""
    import deltamesh

    try:
        mesh = deltamesh.read_mesh(path)
    except deltamesh.NoSurfaceError as error:
        return Outcome(_NO_SURFACE, str(error).removeprefix(f"{path}: "))
    triangles = len(mesh.corners) - 2 * len(mesh.sizes)
    return _outcome(mesh.vertices, mesh.corners, triangles)


def by_trimesh(path: str) -> Outcome:
    """Read a file with trimesh, without its merging of vertices."""
    import trimesh

    scene = trimesh.load_scene(path, process=False)
    meshes = [one for one in scene.dump() if isinstance(one, trimesh.Trimesh)]
    if not any(len(one.faces) for one in meshes):
        return Outcome(_NO_SURFACE)
    counts = np.cumsum([0, *(len(one.vertices) for one in meshes)])
    corners = [np.asarray(one.faces).ravel() + at for one, at in zip(meshes, counts, strict=False)]
    vertices = np.concatenate([np.asarray(one.vertices) for one in meshes])
    faces = np.concatenate(corners)
    return _outcome(vertices, faces, len(faces) // 3)


def by_meshio(path: str) -> Outcome:
    """Read a file with meshio; cells of volumes and lines are no faces."""
    import meshio

    mesh = meshio.read(path)
    faces = [
        face
        for block in mesh.cells
        if block.type in ("triangle", "quad", "polygon")
        for face in block.data
    ]
    if not faces:
        return Outcome(_NO_SURFACE)
    corners = np.concatenate([np.asarray(face) for face in faces])
    return _outcome(np.asarray(mesh.points), corners, len(corners) - 2 * len(faces))


READERS: Final[dict[str, Callable[[str], Outcome]]] = {
    "deltamesh": by_deltamesh,
    "trimesh": by_trimesh,
    "meshio": by_meshio,
}


def _outcome(vertices: NDArray[Any], corners: NDArray[Any], triangles: int) -> Outcome:
    points = np.asarray(vertices, dtype=np.float64)[corners.astype(np.int64), :3]
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    distinct = np.unique(points, axis=0)
    return Outcome("", "", len(vertices), int(triangles), distinct)


def _work(reader: str, pipe: Connection) -> None:
    """Read the files that come through a pipe, and send back what became of them."""
    warnings.simplefilter("ignore")
    nowhere = Path(os.devnull).open("w")  # noqa: SIM115
    sys.stdout = sys.stderr = nowhere  # meshio prints
    while path := pipe.recv():
        try:
            outcome = READERS[reader](path)
        except (Exception, SystemExit) as error:  # meshio ends the program for a format
            first = (str(error).removeprefix(f"{path}: ").splitlines() or [""])[0]
            outcome = Outcome(_REFUSED, f"{type(error).__name__}: {first[:160]}")
        pipe.send(outcome)


class Worker:
    """Process of a reader, which is started anew after a file that took too long or killed it."""

    def __init__(self, reader: str, seconds: float) -> None:
        self._reader, self._seconds = reader, seconds
        self._process: Any = None

    def read(self, path: str) -> Outcome:
        """Return what becomes of a file."""
        if self._process is None:
            context = multiprocessing.get_context("spawn")
            self._pipe, other = context.Pipe()
            self._process = context.Process(target=_work, args=(self._reader, other), daemon=True)
            self._process.start()
            other.close()
        try:
            self._pipe.send(path)
            if self._pipe.poll(self._seconds):
                found: Outcome = self._pipe.recv()
                return found
        except (EOFError, OSError):
            self.end()
            return Outcome(_REFUSED, "the process died")
        self.end()
        return Outcome(_SLOW)

    def end(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
            self._process = None


def difference(ours: Outcome, other: Outcome) -> str:
    """Return how a file that both have read differs, "" if it is alike."""
    from scipy.spatial import KDTree

    assert ours.points is not None
    assert other.points is not None
    if ours.triangles != other.triangles:
        return f"{ours.triangles} and {other.triangles} triangles"
    size = float(np.linalg.norm(np.ptp(ours.points, axis=0)))
    if not (np.isfinite(ours.points).all() and np.isfinite(other.points).all()):
        return "positions that are not finite"
    there, _ = KDTree(ours.points).query(other.points)
    back, _ = KDTree(other.points).query(ours.points)
    farthest = max(float(there.max(initial=0)), float(back.max(initial=0)))
    if farthest > _TOLERANCE * size:
        return f"positions, by up to {farthest / size if size else np.inf:.2g} of the diagonal"
    return ""


def files_in(places: tuple[Path, ...]) -> Iterator[Path]:
    """Yield files, and the mesh files in folders."""
    for place in places:
        if not place.is_dir():
            yield place
            continue
        for path in sorted(place.rglob("*")):
            if path.suffix[1:].lower() in EXTENSIONS and path.is_file():
                yield path


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("places", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--seconds", default=60.0, help="Time limit for a file in a reader.")
@click.option("--all", "show_all", is_flag=True, help="List also the files that are read alike.")
def command(places: tuple[Path, ...], seconds: float, show_all: bool) -> None:
    """Read the mesh files in PLACES, files and folders, with three readers.

    Prints a table, and the files that are refused by deltamesh or read differently by another
    reader.
    """
    counts: dict[str, Counter[str]] = {}
    workers = {name: Worker(name, seconds) for name in READERS}
    try:
        for path in files_in(places):
            outcomes = {name: worker.read(str(path)) for name, worker in workers.items()}
            words = dict(_compared(outcomes))
            known = format_of_extension(path.suffix)
            count = counts.setdefault("?" if known is None else known.title, Counter())
            count["files"] += 1
            count.update(f"{name} {word.partition(':')[0]}" for name, word in words.items())
            if show_all or outcomes["deltamesh"].refusal or "different" in str(words):
                click.echo(printable(f"{path}: deltamesh {outcomes['deltamesh']}"))
                for name in ("trimesh", "meshio"):
                    click.echo(printable(f"    {name} {outcomes[name]} ({words[name]})"))
    finally:
        for worker in workers.values():
            with suppress(OSError):
                worker.end()
    click.echo()
    click.echo(table(list(_rows(counts))))


def _compared(outcomes: dict[str, Outcome]) -> Iterator[tuple[str, str]]:
    """Yield a word for the outcome of each reader: refused, read, alike, or different from ours."""
    ours = outcomes["deltamesh"]
    for name, other in outcomes.items():
        if other.refusal:
            yield name, other.refusal
        elif name == "deltamesh" or ours.refusal:
            yield name, "read"
        else:
            differs = difference(ours, other)
            yield name, f"different: {differs}" if differs else "alike"


def _rows(counts: dict[str, Counter[str]]) -> Iterator[tuple[str, ...]]:
    words = {
        "deltamesh": ("read", _NO_SURFACE, _REFUSED, _SLOW),
        "trimesh": ("alike", "different", "read", _NO_SURFACE, _REFUSED, _SLOW),
        "meshio": ("alike", "different", "read", _NO_SURFACE, _REFUSED, _SLOW),
    }
    columns = ["files", *(f"{name} {word}" for name, some in words.items() for word in some)]
    totals = sum(counts.values(), Counter[str]())
    columns = [one for one in columns if totals[one]]
    yield ("format", *columns)
    for title, count in sorted(counts.items()):
        yield (title, *(str(count[one]) for one in columns))
    yield ("all", *(str(totals[one]) for one in columns))


if __name__ == "__main__":
    command()
