"""Edits of a bar and of scans: the schemes of the papers, and poses as files record them.

The first table bends and twists a bumpy bar, of which one end is held and the other moved, by three
schemes: the deltas as they are; deltas that turn with the surface that this makes (Lipman et al.
2004); and two linear systems (Lipman et al. 2005), by which `deltamesh.edit` goes. The second one
has files of the same bar, of the bunny, whose ears are bent, and of the horse, whose head is
turned: bytes of a pose, and errors against the same edit of the original. Meshes that are not there
are left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import click
import corpus
import numpy as np
from numpy.typing import NDArray

import deltamesh
from deltamesh._geometry import rotations
from deltamesh._geometry.editing import WEIGHT, Held, deformed
from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.mesh import laplacian
from deltamesh._measures.metrics import VertexErrors, diagonal, vertex_errors
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles
from deltamesh_formats.printing import number, table

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_EXAMPLES = """\
python benchmarks/poses.py
python benchmarks/poses.py --only bar
"""
NAMES = ("bar", "bunny", "horse")
SHARES = (0.002, 0.005, 0.01)  # of the vertices, which are anchors
STEP = 1e-3  # of the files, in diagonals


@dataclass(frozen=True)
class Edit:
    """What is done to a mesh.

    Attributes
    ----------
    mesh, name : str
    fixed, moved : bool (n,)
    matrix : float64 (4, 4)
        That of the moved vertices.
    """

    mesh: str
    name: str
    fixed: Bools
    moved: Bools
    matrix: Floats

    def held(self, vertices: Floats) -> Held:
        """Return the vertices that are held, of a mesh."""
        chosen = np.flatnonzero(self.fixed | self.moved)
        moved = self.moved[chosen]
        positions = vertices[chosen].copy()
        positions[moved] = positions[moved] @ self.matrix[:3, :3].T + self.matrix[:3, 3]
        turn = rotations.to_quaternions(self.matrix[None, :3, :3])
        quaternions = np.where(moved[:, None], turn, (1.0, 0, 0, 0))
        return Held(chosen, positions, quaternions, np.ones(len(chosen), dtype=bool))


def bar(around: int = 48, along: int = 110) -> PolyMesh:
    """Return a tube along z, open at both ends, with bumps, which an edit should keep."""
    angle = np.arange(around) / around * 2 * np.pi
    angle, z = np.meshgrid(angle, np.linspace(0, 6, along))
    r = 0.7 + 0.05 * np.cos(6 * angle) * np.sin(5 * z)
    vertices = np.stack((r * np.cos(angle), r * np.sin(angle), z), axis=-1).reshape(-1, 3)
    row, i = np.divmod(np.arange((along - 1) * around), around)
    a, b = row * around + i, row * around + (i + 1) % around
    quads = np.stack((a, b, b + around, a, b + around, a + around), axis=1)
    return from_triangles(vertices, quads.reshape(-1, 3))


def mesh_of(name: str) -> PolyMesh:
    """Return a mesh in the order in which files have it, without isolated vertices."""
    mesh = bar() if name == "bar" else corpus.as_polymesh(corpus.bare(name))
    return deltamesh.decode(deltamesh.encode(mesh, method="lossless", drop_isolated=True))


def turn(axis: Sequence[float], degrees: float, about: Floats, to: Floats | None = None) -> Floats:
    """Return the matrix that turns about a point, which goes somewhere; by default it stays."""
    half = np.radians(degrees) / 2
    unit = np.array(axis) / np.linalg.norm(axis)
    quaternion = np.concatenate(([np.cos(half)], np.sin(half) * unit))
    matrix = np.eye(4)
    matrix[:3, :3] = rotations.of_quaternions(quaternion[None])[0]
    matrix[:3, 3] = (about if to is None else to) - matrix[:3, :3] @ about
    return matrix


def edits(name: str, vertices: Floats) -> list[Edit]:
    """Return what is done to a mesh."""
    low = vertices.min(axis=0)
    x, y, z = ((vertices - low) / np.ptp(vertices, axis=0)).T
    if name == "bar":
        fixed, moved = z < 0.05, z > 0.95
        end = vertices[moved].mean(axis=0)
        bent = turn((0, 1, 0), 120, end, np.array([3.2, 0, 3.4]))
        return [
            Edit(name, "bend 120", fixed, moved, bent),
            Edit(name, "twist 135", fixed, moved, turn((0, 0, 1), 135, end)),
        ]
    if name == "bunny":
        roots = vertices[(y > 0.62) & (y < 0.68) & (x < 0.5)].mean(axis=0)
        return [Edit(name, "ears", y < 0.45, y > 0.86, turn((0, 0, 1), 55, roots))]
    neck = vertices[(y > 0.68) & (y < 0.72) & (z > 0.55)].mean(axis=0)
    matrix = turn((0, 0, 1), 50, neck) @ turn((1, 0, 0), -20, neck)
    return [Edit(name, "head", y < 0.62, (y > 0.8) & (z > 0.7), matrix)]


def by_schemes(mesh: PolyMesh, edit: Edit) -> dict[str, Floats]:
    """Return the vertices that each scheme makes, by its name."""
    V, graph = mesh.vertices, adjacency(mesh.triangles, len(mesh.vertices))
    held = edit.held(V)
    system = LeastSquares(graph, held.vertices, weights=WEIGHT)
    delta = laplacian.apply(*graph, V)
    plain = system.solve(delta, held.positions)
    turns = rotations.fit(graph, V, plain, 3)
    rotated = system.solve(np.einsum("nij,nj->ni", turns, delta), held.positions)
    two, _ = deformed(graph, V, held)
    return {"plain": plain, "rotated": rotated, "two systems": two}


def scheme_rows(mesh: PolyMesh, edit: Edit) -> Iterator[tuple[str, ...]]:
    """Yield what each scheme changes: edges, dihedral angles, deltas; and what handles miss."""
    V, F = mesh.vertices, mesh.triangles
    graph, held = adjacency(F, len(V)), edit.held(V)
    tail, head = np.repeat(np.arange(len(V)), np.diff(graph[0])), graph[1]
    delta, before = laplacian.apply(*graph, V), np.linalg.norm(V[tail] - V[head], axis=1)
    for scheme, W in by_schemes(mesh, edit).items():
        after = np.linalg.norm(W[tail] - W[head], axis=1)
        turns = rotations.fit(graph, V, W)
        details = np.einsum("nji,nj->ni", turns, laplacian.apply(*graph, W)) - delta
        missed = np.linalg.norm(W[held.vertices] - held.positions, axis=1).max()
        yield (
            edit.name,
            scheme,
            f"{100 * np.sqrt(((after / before - 1) ** 2).mean()):.1f} %",
            f"{vertex_errors(V, W, F).dihedral:.2f}",
            f"{100 * np.linalg.norm(details) / np.linalg.norm(delta):.0f} %",
            f"{missed / diagonal(V):.0e}",
        )


@dataclass(frozen=True)
class Recorded:
    """A pose in a file.

    Attributes
    ----------
    edited : Edited
    file : int
        Bytes of the file without it.
    anew : int
        Bytes of the edited mesh in a file of its own, with the same options.
    rest, pose : VertexErrors
        Of the decoded mesh at rest and in the pose, against the original and its edit.
    dihedral : float
        Mean change of the dihedral angles by the edit of the original, in degrees.
    """

    edited: deltamesh.Edited
    file: int
    anew: int
    rest: VertexErrors
    pose: VertexErrors
    dihedral: float


def recorded(mesh: PolyMesh, edit: Edit, share: float) -> Recorded:
    """Return an edit as a file records it that has a share of its vertices as anchors."""
    V, F, size = mesh.vertices, mesh.triangles, diagonal(mesh.vertices)
    anchors = max(round(share * len(V)), 1)
    wanted, _ = deformed(adjacency(F, len(V)), V, edit.held(V))
    options = {"method": "refined", "step": STEP * size, "anchors": anchors}
    data = deltamesh.encode(mesh, **options)
    made = deltamesh.edit(data, [(edit.moved, edit.matrix)], [edit.fixed], name=edit.name)
    return Recorded(
        made,
        len(data),
        len(deltamesh.encode(from_triangles(wanted, F), **options)),
        vertex_errors(V, deltamesh.decode(data).vertices, F),
        vertex_errors(wanted, deltamesh.decode(made.data, pose=edit.name).vertices, F),
        vertex_errors(V, wanted, F).dihedral,
    )


def record_row(mesh: PolyMesh, edit: Edit, share: float) -> tuple[str, ...]:
    """Return bytes and errors of a pose: at rest, and in the pose."""
    found, size = recorded(mesh, edit, share), diagonal(mesh.vertices)
    return (
        f"{edit.mesh}, {edit.name}",
        str(found.edited.anchors),
        str(found.file),
        str(found.edited.size),
        f"{100 * found.edited.size / found.file:.1f} %",
        str(found.anew),
        f"{number(found.rest.rms / size)} {number(found.pose.rms / size)}",
        f"{found.rest.normal_deviation:.2f} {found.pose.normal_deviation:.2f}",
        f"{found.dihedral:.2f} {found.edited.recorded_dihedral:.2f}",
        f"{number(found.edited.recorded_missed)}",
    )


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--only", type=click.Choice(NAMES), multiple=True, help="Edit only these meshes.")
def command(only: tuple[str, ...]) -> None:
    """Bend and twist a bar, and record edits of a bar, the bunny and the horse in files."""
    names = [name for name in only or NAMES if name == "bar" or corpus.path(name).is_file()]
    for name in set(only or NAMES) - {*names}:
        click.echo(f"skipped, not in {corpus.folder()}: {name}", err=True)
    meshes = {name: mesh_of(name) for name in names}
    if "bar" in meshes:
        rows = [("edit", "scheme", "edges", "dihedral", "deltas", "missed")]
        for edit in edits("bar", meshes["bar"].vertices):
            rows += scheme_rows(meshes["bar"], edit)
        click.echo(table(rows) + "\n")
    rows = [
        ("mesh", "anchors", "file", "pose", "share", "anew", "RMS", "normals", "dihedral", "missed")
    ]
    for name, mesh in meshes.items():
        for edit in edits(name, mesh.vertices):
            rows += [record_row(mesh, edit, share) for share in SHARES]
    click.echo(table(rows))


if __name__ == "__main__":
    command()
