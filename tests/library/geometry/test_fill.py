"""Memory of the solver on meshes that are no surfaces: it is foreseen, refused, and avoided."""

from __future__ import annotations

import sys
from pathlib import Path

import children
import meshes
import numpy as np
import pytest
from commandline import cli
from graphs import FREE_SOLVERS, laplacian_of

import deltamesh
from deltamesh import _limits
from deltamesh._geometry import fill
from deltamesh._kernels.mesh import elimination
from deltamesh._limits import memory_needed
from deltamesh._methods import LEAST_SQUARES
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import LimitError, MeshError

RNG = np.random.default_rng(99)


def distinct(F):
    F = np.sort(F, axis=1)
    F = F[(F[:, 0] < F[:, 1]) & (F[:, 1] < F[:, 2])]
    return np.random.default_rng(0).random((F.max() + 1, 3)), F


def triples(n, per_vertex):
    return distinct(RNG.integers(0, n, (per_vertex * n, 3)))


def block(k):
    """A cube of k^3 points whose small cubes have a triangle on each of three sides."""
    at = np.arange(k**3).reshape(k, k, k)
    a, x, y, z = (
        p.ravel() for p in (at[1:, 1:, 1:], at[:-1, 1:, 1:], at[1:, :-1, 1:], at[1:, 1:, :-1])
    )
    return distinct(
        np.concatenate([np.stack(f, axis=1) for f in ((a, x, y), (a, y, z), (a, z, x))])
    )


def bridged_torus(rows, columns, bridges):
    """A torus with triangles between random vertices."""
    V, F = meshes.torus(rows, columns)
    more = RNG.integers(0, len(V), (bridges, 3))
    return V, np.concatenate((F, distinct(more)[1]))


WILD = {
    "triples": triples(2000, 2),
    "dense triples": triples(1000, 8),
    "block": block(22),
    "bridged torus": bridged_torus(60, 50, 2000),
}
# For the core, which takes less memory; others would take long.
WILD_FOR_CORE = {"triples": triples(3500, 2), "dense triples": triples(2500, 8)}
# Even for twice what is declared.
WILDEST = {
    "triples": triples(15_000, 2),
    "dense triples": triples(8000, 8),
    "bridged torus": bridged_torus(150, 100, 15_000),
}
TAME = {
    "sphere": meshes.icosphere(5),
    "torus": meshes.torus(120, 60),
    "one triangle": (np.eye(3), np.array([[0, 1, 2]])),
    "many pieces": (
        np.random.default_rng(1).random((9000, 3)),
        np.arange(9000).reshape(-1, 3),
    ),
}


def of_neighbours(F):
    """Where the normal equations of a Laplacian have entries."""
    L = laplacian_of(F, F.max() + 1)
    return fill.pattern(L.T @ L)


def test_the_memory_of_a_factor_is_that_of_its_entries() -> None:
    places = of_neighbours(meshes.torus(30, 20)[1])
    order = elimination.minimum_degree(*places)
    entries = elimination.factor_entries(*places, order, fill.MOST)
    fill.check_fill(*places, order, fill.FACTOR_ENTRY, fill.FACTOR_ENTRY * entries)
    with pytest.raises(LimitError, match="more than the limit"):
        fill.check_fill(*places, order, fill.FACTOR_ENTRY, fill.FACTOR_ENTRY * (entries - 1))
    assert fill.entries_within(80.0) == 10
    assert (fill.entries_within(-1.0), fill.entries_within(np.inf)) == (0, fill.MOST)


def test_only_what_is_broad_is_refused_before_an_order_is_looked_for() -> None:
    """A random graph is; a surface of as many vertices is not, whatever the memory."""
    fill.check_breadth(*of_neighbours(meshes.icosphere(4)[1]), fill.FACTOR_ENTRY, 1.0)
    wild = of_neighbours(triples(2000, 2)[1])
    fill.check_breadth(*wild, fill.FACTOR_ENTRY, np.inf)
    with pytest.raises(LimitError, match="not those of a surface"):
        fill.check_breadth(*wild, fill.FACTOR_ENTRY, 1.0)


@pytest.fixture
def careless(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the encoder write files whose decoders need any memory."""
    monkeypatch.setattr(_limits, "MOST_DECLARED", 1000)


def wild_file(name: str, solver: str) -> bytes:
    mesh = (WILD_FOR_CORE if solver == "core" else WILD).get(name, WILD[name])
    return deltamesh.encode(
        *mesh, method="highpass", bits=4, anchors=1, drop_isolated=True, solver="core"
    )


@pytest.mark.parametrize("solver", FREE_SOLVERS)
@pytest.mark.parametrize("name", WILD)
def test_a_decoder_keeps_to_what_is_declared(name: str, solver: str, careless: None) -> None:
    data = wild_file(name, solver)
    needed = memory_needed(read_container(data))
    with pytest.raises(LimitError, match="solving for the positions takes more than the limit"):
        deltamesh.decode(data, memory=needed, solver=solver)
    mesh = deltamesh.decode(data, memory=needed + (2 << 30), solver=solver)
    assert mesh.vertices.shape[1] == 3


@pytest.mark.parametrize("solver", FREE_SOLVERS)
@pytest.mark.parametrize("name", TAME)
@pytest.mark.parametrize("method", ["refined", "highpass"])
def test_surfaces_take_no_more_than_is_declared(name: str, method: str, solver: str) -> None:
    data = deltamesh.encode(*TAME[name], method=method, solver=solver)
    assert read_container(data).parameters.method == method
    deltamesh.decode(data, memory=memory_needed(read_container(data)), solver=solver)


@pytest.mark.parametrize("name", WILDEST)
@pytest.mark.parametrize("method", ["refined", "highpass"])
def test_an_encoder_refuses_what_decoders_would(name: str, method: str) -> None:
    options = {"method": method, "solution": "least-squares", "drop_isolated": True}
    with pytest.raises(MeshError, match=r"limit of \d+ MiB; try method cartesian"):
        deltamesh.encode(*WILDEST[name], **options)


@pytest.mark.parametrize("name", WILDEST)
def test_interpolated_anchors_need_no_more_memory_on_any_graph(name: str) -> None:
    data = deltamesh.encode(*WILDEST[name], method="refined", step=0.1, drop_isolated=True)
    assert read_container(data).parameters.interpolated
    deltamesh.decode(data, memory=memory_needed(read_container(data)))


@pytest.mark.parametrize("name", WILDEST)
@pytest.mark.parametrize("options", [{}, {"bits": 9, "coarse": 4}], ids=str)
def test_auto_is_cartesian_then(name: str, options: dict[str, float]) -> None:
    data = deltamesh.encode(*WILDEST[name], drop_isolated=True, **options)
    assert read_container(data).parameters.method == "cartesian"
    deltamesh.decode(data, memory=memory_needed(read_container(data)))


def test_without_bits_nothing_but_anchors_is_there_to_fall_back_on() -> None:
    with pytest.raises(MeshError, match="try method cartesian"):
        deltamesh.encode(*WILDEST["triples"], bits=0, drop_isolated=True)


def test_the_command_line(
    tmp_path: Path, careless: None, capsys: pytest.CaptureFixture[str]
) -> None:
    file, target = tmp_path / "wild.dmesh", tmp_path / "wild.ply"
    file.write_bytes(wild_file("triples", "core"))
    memory = memory_needed(read_container(file.read_bytes()))
    assert cli(f"decode --memory {memory}", str(file), str(target)) == 3
    assert "--max-vertices and --memory raise the limits" in capsys.readouterr().err
    assert not target.exists()


def test_refusing_is_cheap() -> None:
    """A process with little memory beyond what is declared refuses, in a few seconds."""
    pytest.importorskip("resource")
    n = 20_000
    code = f"""
import resource, time
import numpy as np
from deltamesh._geometry import solve
from deltamesh_formats.errors import LimitError
import scipy.sparse as sparse
F = np.random.default_rng(1).integers(0, {n}, ({2 * n}, 3))
i, j = np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]).T
A = sparse.csr_array((np.ones(len(i)), (i, j)), shape=({n}, {n}))
A = (A + A.T).tocsr()
A.setdiag(0)
A.eliminate_zeros()
graph = A.indptr.astype(np.int32), A.indices.astype(np.int32)
def refused(memory):
    try:
        solve.LeastSquares(graph, np.arange({n}), SOLVER, 1, memory)
    except LimitError:
        return True
assert refused(1 << 20)  # all is compiled and imported
before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
assert refused({LEAST_SQUARES.per_vertex * n})
assert refused({2 * LEAST_SQUARES.per_vertex * n})
assert refused({1 << 30})
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert after - before < 400 << 10, (before, after)
assert time.process_time() - start < 20, time.process_time() - start
"""
    for solver in FREE_SOLVERS:
        command = [sys.executable, "-c", f"SOLVER = {solver!r}\n{code}"]
        done = children.run(command, text=True)
        assert done.returncode == 0, done.stderr
