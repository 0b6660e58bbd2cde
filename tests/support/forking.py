"""Programs that fork after and before they use the codec: `python forking.py NAME`.

Each ends with exit code 0 if every process has decoded what was asked for. They run as programs of
their own: from Python 3.12 on, a fork of a process that has threads is a warning.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import deltamesh


def mesh(kind: str) -> deltamesh.PolyMesh:
    """Return a bumpy torus, an open sheet of quads, or many small tetrahedra."""
    if kind == "tetrahedra":
        at = np.random.default_rng(17).random((60, 1, 3)) * 9
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        all_faces = (4 * np.arange(60)[:, None, None] + faces).reshape(-1, 3)
        return deltamesh.from_arrays((at + corners).reshape(-1, 3), all_faces)
    rows, columns = 60, 40
    i, j = np.mgrid[0:rows, 0:columns].reshape(2, -1)
    u, v = 2 * np.pi * i / rows, 2 * np.pi * j / columns
    if kind == "torus":
        radius = 3 + (1 + 0.05 * np.sin(7 * u + 3 * v)) * np.cos(v)
        V = np.stack((radius * np.cos(u), radius * np.sin(u), np.sin(v)), axis=1)
    else:
        V = np.stack((u, v, 0.2 * np.sin(3 * u) * np.cos(2 * v)), axis=1)
        inside = (i < rows - 1) & (j < columns - 1)
        i, j = i[inside], j[inside]
    a, b = i * columns + j, (i + 1) % rows * columns + j
    c, d = (i + 1) % rows * columns + (j + 1) % columns, i * columns + (j + 1) % columns
    return deltamesh.from_arrays(V, np.stack((a, b, c, d), axis=1))


KINDS = ("torus", "sheet", "tetrahedra")
# Encoded and decoded by scipy, which leaves rslab out of this process.
DATA: dict[str, bytes] = {}
POSITIONS: dict[str, np.ndarray] = {}


def encoded(kind: str, solver: str = "auto") -> bytes:
    return deltamesh.encode(mesh(kind), method="highpass", bits=9, solver=solver)


def prepare() -> None:
    for kind in KINDS:
        DATA[kind] = encoded(kind, "scipy")
        POSITIONS[kind] = decoded(DATA[kind], solver="scipy")
    assert "rslab" not in sys.modules


def decoded(data: bytes, **options: object) -> np.ndarray:
    return deltamesh.decode(data, **options).vertices


def check(**options: object) -> None:
    """Decode all meshes, and compare positions within the tolerance of the documentation."""
    for kind in KINDS:
        expected = POSITIONS[kind]
        extent = np.linalg.norm(np.ptp(expected, axis=0))
        assert np.abs(decoded(DATA[kind], **options) - expected).max() <= 1e-9 * extent, kind


def check_encoding(method: str = "highpass") -> None:
    """Encode, in the same process decode, and compare with the input."""
    for kind in KINDS:
        whole = mesh(kind)
        V = deltamesh.decode(deltamesh.encode(whole, method=method, keep_order=True)).vertices
        extent = np.linalg.norm(np.ptp(whole.vertices, axis=0))
        assert np.sqrt(np.square(V - whole.vertices).sum(1).mean()) < 0.02 * extent, kind


def in_child(work: Callable[[], None], leave: Callable[[int], object] = os._exit) -> None:
    """Run in a forked process, and fail if that fails."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except BaseException as error:
            print(repr(error), file=sys.stderr, flush=True)
            os._exit(1)
        leave(0)
    _, status = os.waitpid(child, 0)
    assert status == 0, status


def in_thread(work: Callable[[], None]) -> None:
    with ThreadPoolExecutor(1) as pool:
        pool.submit(work).result()


def in_threads(work: Callable[[], None]) -> None:
    with ThreadPoolExecutor(4) as pool:
        for done in [pool.submit(work) for _ in range(8)]:
            done.result()


def after_decode() -> None:
    check()
    in_child(check)
    check()


def after_decode_with_one_thread() -> None:
    check(threads=1)
    in_child(lambda: check(threads=1))


def after_decode_with_other_threads() -> None:
    check(threads=2)
    in_child(lambda: check(threads=3))


def after_encode() -> None:
    check_encoding()
    in_child(check_encoding)
    in_child(lambda: check_encoding("auto"))


def after_import() -> None:
    import rslab  # noqa: F401

    in_child(check)
    check()
    in_child(check)


def before_decode() -> None:
    in_child(check)
    check()
    in_child(check)


def after_scipy() -> None:
    check(solver="scipy")
    in_child(check)
    in_child(lambda: check(solver="scipy"))


def after_decode_in_thread() -> None:
    in_thread(check)
    in_child(check)


def in_a_thread() -> None:
    check()
    in_thread(lambda: in_child(check))
    in_thread(check)


def in_a_thread_before_decode() -> None:
    in_thread(lambda: in_child(lambda: in_threads(check)))


def after_threads() -> None:
    in_threads(check)
    in_child(check)
    in_threads(check)


def nested() -> None:
    check()

    def grandchild() -> None:
        check()
        in_child(lambda: in_child(check))

    in_child(grandchild)


def nested_before_decode() -> None:
    def grandchild() -> None:
        check()
        in_child(check)
        check()

    in_child(lambda: in_child(grandchild))


def threads_of_the_child() -> None:
    check()
    in_child(lambda: in_threads(check))


def ordinary_exit() -> None:
    check()
    in_child(check, sys.exit)


def refused_by_name() -> None:
    def refused() -> None:
        with pytest.raises(deltamesh.SolveError, match="forked"):
            check(solver="rslab")

    check(solver="rslab")  # which loads it: a small mesh does not
    in_child(refused)
    in_child(lambda: in_child(refused))
    check(solver="rslab")


def pool_of(method: str) -> None:
    check()
    check_encoding()
    with multiprocessing.get_context(method).Pool(2) as pool:
        for kind, positions in zip(KINDS, pool.map(decoded, map(DATA.get, KINDS)), strict=True):
            extent = np.linalg.norm(np.ptp(positions, axis=0))
            assert np.abs(positions - POSITIONS[kind]).max() <= 1e-9 * extent
        again = pool.map(encoded, KINDS)
        check()
    for kind, data in zip(KINDS, again, strict=True):
        assert np.abs(decoded(data) - POSITIONS[kind]).max() <= 1e-6, kind


def fork_pool() -> None:
    pool_of("fork")


def spawn_pool() -> None:
    pool_of("spawn")


def forkserver_pool() -> None:
    pool_of("forkserver")


PROGRAMS: dict[str, Callable[[], None]] = {
    work.__name__: work
    for work in (
        after_decode,
        after_decode_with_one_thread,
        after_decode_with_other_threads,
        after_encode,
        after_import,
        before_decode,
        after_scipy,
        after_decode_in_thread,
        in_a_thread,
        in_a_thread_before_decode,
        after_threads,
        nested,
        nested_before_decode,
        threads_of_the_child,
        ordinary_exit,
        refused_by_name,
        fork_pool,
        spawn_pool,
        forkserver_pool,
    )
}

if __name__ == "__main__":
    prepare()
    PROGRAMS[sys.argv[1]]()
