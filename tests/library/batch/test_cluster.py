"""A real scheduler and workers of Dask, some of which are killed."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from typing import Any

import children
import meshes
import pytest
import works
from works import task

from deltamesh.batch import WorkerError
from deltamesh_formats.meshfiles.files import mesh_bytes
from deltamesh_formats.polymesh.mesh import from_triangles

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


def test_groups_of_tasks_are_spread(cluster: Any) -> None:
    from deltamesh.batch._cluster import run_on_dask

    begun: list[str] = []
    tasks = [task(f"nap-{i}") for i in range(12)]
    done = dict(
        run_on_dask(
            cluster.client,
            tasks,
            works.obey,
            count=3,
            begin=lambda ts: begun.extend(t.source for t in ts),
        )
    )
    assert set(done) == set(tasks)
    assert begun == [t.source for t in tasks]
    workers: dict[int, int] = {}
    for one, record in done.items():
        assert Path(record["source"]) == Path.cwd() / one.source, "workers get absolute names"
        workers[record["pid"]] = workers.get(record["pid"], 0) + 1
    assert set(workers) == set(cluster.workers().values())
    assert all(count % 3 == 0 for count in workers.values())


def test_a_file_that_kills_workers_is_given_up_and_not_its_neighbours(cluster: Any) -> None:
    from deltamesh.batch._cluster import run_on_dask

    tasks = [task("x-1"), task("die-2"), task("x-3"), task("raise-4"), task("x-5")]
    done = {
        one.source: outcome
        for one, outcome in run_on_dask(cluster.client, tasks, works.obey, count=3)
    }
    assert sorted(done) == sorted(t.source for t in tasks)
    assert isinstance(done["die-2"], WorkerError)
    assert str(done["die-2"]) == "the workers that tried it died"
    assert str(done["raise-4"]) == "LookupError: nothing there"
    for name in ("x-1", "x-3", "x-5"):
        assert done[name]["source"].endswith(name)


@pytest.mark.slow
def test_the_command_survives_the_death_of_a_worker(cluster: Any, tmp_path: Path) -> None:
    V, F = meshes.icosphere(4)
    names = [f"scans/{i:02}.ply" for i in range(20)]
    (tmp_path / "scans").mkdir()
    for i, name in enumerate(names):
        (tmp_path / name).write_bytes(mesh_bytes(from_triangles(V * (1 + i / 10), F), "ply"))
    line = "batch -r scans --output-dir-flat out --manifest run.jsonl --scheduler"
    command = [sys.executable, "-m", "deltamesh_cli", *line.split(), cluster.address]
    manifest = tmp_path / "run.jsonl"

    def records() -> list[dict[str, Any]]:
        lines = manifest.read_bytes().split(b"\n")[:-1] if manifest.exists() else []
        return [json.loads(one) for one in lines]

    with children.started(command, cwd=tmp_path) as child:

        def one_is_done() -> bool:
            assert child.process.poll() is None, child.written["stderr"]
            return any(record["status"] == "done" for record in records())

        children.wait_for(one_is_done)
        victim = next(iter(cluster.workers().values()))
        os.kill(victim, signal.SIGKILL)
        done_by_it = child.finish()
    assert done_by_it.returncode == 0, done_by_it.stderr
    done = [record for record in records() if record["status"] == "done"]
    assert sorted(record["source"] for record in done) == names, "all, and none twice"
    line = "batch -q -r scans --output-dir-flat serial"
    children.run([sys.executable, "-m", "deltamesh_cli", *line.split()], cwd=tmp_path, check=True)
    for name in names:
        made = Path(name).name + ".dmesh"
        assert (tmp_path / "out" / made).read_bytes() == (tmp_path / "serial" / made).read_bytes()
    assert not list(tmp_path.rglob(".deltamesh-*"))


def test_no_scheduler_is_a_failure(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    (tmp_path / "a.ply").write_bytes(mesh_bytes(from_triangles(*meshes.tetrahedron()), "ply"))
    command = [sys.executable, "-m", "deltamesh_cli", "batch", "a.ply", "--scheduler"]
    environment = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "1s"}
    done = children.run([*command, "tcp://127.0.0.1:9"], cwd=tmp_path, env=environment)
    assert done.returncode == 1
    assert b"deltamesh: tcp://127.0.0.1:9: cannot go on: " in done.stderr
    assert b"Traceback" not in done.stderr
    assert b"bug" not in done.stderr
