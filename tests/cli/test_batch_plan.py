"""Plans of a batch: places of outputs, lists of files, and what is settled without work."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from commandline import posix

from deltamesh._version import __version__
from deltamesh.batch import DONE, FAILED, SKIPPED, Task
from deltamesh_cli.batch.plan import (
    Destinations,
    plan_files,
    settled_record,
)
from deltamesh_cli.batch.work import Job
from deltamesh_cli.inputs import Choice
from deltamesh_formats.errors import OptionError

ENCODE, DECODE = Job(False, None, {}), Job(True, None, {})
BESIDE = Destinations()


def plan(job: Job, *names: str, destinations: Destinations = BESIDE) -> list[object]:
    return plan_files(job, destinations, names, Choice(recursive=True))


def test_outputs_go_beside_their_inputs_or_into_a_folder() -> None:
    name = os.path.join("scans", "a.ply")
    assert Destinations().path_for(name) == name
    assert Destinations(flat="out").path_for(name) == os.path.join("out", "a.ply")
    assert Destinations(mirror="out").path_for(name) == os.path.join("out", "scans", "a.ply")
    assert [
        Destinations(flat="a").folder,
        Destinations(mirror="b").folder,
        Destinations().folder,
    ] == ["a", "b", None]


def test_folders_give_meshes_to_encode_and_files_to_decode(folder: Path) -> None:
    for job, source in ((ENCODE, "torus.ply"), (DECODE, "torus.dmesh")):
        (task,) = plan(job, ".")
        assert isinstance(task, Task)
        assert task.source == source


def test_the_folder_of_outputs_is_not_searched(folder: Path) -> None:
    (folder / "out").mkdir()
    (folder / "out" / "torus.ply").write_bytes(b"ply")
    assert len(plan(ENCODE, ".")) == 2
    assert len(plan(ENCODE, ".", destinations=Destinations(flat="out"))) == 1


def test_tasks_are_sorted_and_know_their_outputs(folder: Path) -> None:
    (folder / "b.ply").write_bytes(b"ply")
    tasks = plan(ENCODE, "torus.ply", "b.ply", "./torus.ply")
    assert [(t.source, t.target, t.size) for t in tasks if isinstance(t, Task)] == [
        ("b.ply", "b.ply.dmesh", 3),
        ("torus.ply", "torus.ply.dmesh", (folder / "torus.ply").stat().st_size),
    ]
    (task,) = plan(DECODE, "torus.dmesh")
    assert isinstance(task, Task)
    assert task.target == "torus.ply"  # as the file says
    assert task.need > 0


def test_what_cannot_be_a_task_is_a_failure(folder: Path) -> None:
    (folder / "plain.txt").write_bytes(b"?")
    for job, name, why in (
        (ENCODE, "nothing.ply", "no such file"),
        (DECODE, "plain.txt", "does not end in .dmesh"),
    ):
        (record,) = plan(job, name)
        assert isinstance(record, dict)
        assert record["status"] == FAILED
        assert record["exit_code"] == 1
        assert why in record["message"]


@posix
def test_a_pipe_is_no_task(folder: Path) -> None:
    os.mkfifo("pipe.ply")
    (record,) = plan(ENCODE, "pipe.ply")
    assert isinstance(record, dict)
    assert "a pipe or a device" in record["message"]


def test_two_files_with_one_output_are_refused(folder: Path) -> None:
    (folder / "below").mkdir()
    (folder / "below" / "torus.ply").write_bytes(b"ply")
    names = "torus.ply", os.path.join("below", "torus.ply")
    with pytest.raises(OptionError, match="would both be written"):
        plan(ENCODE, *names, destinations=Destinations(flat="out"))
    assert len(plan(ENCODE, *names, destinations=Destinations(mirror="out"))) == 2


def test_outputs_that_exist_are_settled(folder: Path) -> None:
    task = Task("torus.ply", "torus.dmesh", 9)

    def found(task: Task, force: bool = False, skip: bool = False) -> object:
        record = settled_record(ENCODE, task, None, force=force, skip_existing=skip)
        return None if record is None else record["status"]

    assert found(task) == FAILED
    assert found(task, force=True) is None
    assert found(task, skip=True) == SKIPPED
    assert found(Task("torus.ply", "new.dmesh", 9)) is None


def test_a_record_of_the_same_work_settles_it_and_others_do_not(folder: Path) -> None:
    from deltamesh.batch import file_state

    task = Task("torus.ply", "torus.dmesh", 9)
    before = {
        "status": DONE,
        "source": task.source,
        "target": task.target,
        **file_state("torus.ply", "source"),
        **file_state("torus.dmesh", "target"),
        "options": ENCODE.options(),
        "version": __version__,
    }
    assert settled_record(ENCODE, task, before, force=False, skip_existing=False) is before
    other = Job(False, None, {"bits": 9})
    assert (
        settled_record(other, task, before, force=False, skip_existing=False) is None
    )  # ours: redone
    (folder / "torus.ply").write_bytes(b"changed")
    assert settled_record(ENCODE, task, before, force=False, skip_existing=False) is None


def test_the_buffers_of_a_gltf_count(folder: Path) -> None:
    from deltamesh.batch import file_state, memory_for_mesh_file, still_done

    buffer = {"uri": "data/a%20b.bin", "byteLength": 9_000_000}
    outside = {"uri": "../secret.bin", "byteLength": 9}
    (folder / "data").mkdir()
    (folder / "data" / "a b.bin").write_bytes(bytes(9_000_000))
    text = json.dumps({"buffers": [buffer, outside, {"uri": "gone.bin"}]})
    (folder / "a.gltf").write_text(text)
    (task,) = plan(ENCODE, "a.gltf")
    assert isinstance(task, Task)
    assert task.size == len(text) + 9_000_000
    assert task.need == memory_for_mesh_file(task.size, "gltf")
    state = {**file_state("a.gltf", "source"), **file_state("torus.dmesh", "target")}
    assert state["source_bytes"] == task.size
    record = {"status": DONE, "source": "a.gltf", "target": "torus.dmesh", "options": {}, **state}
    assert still_done({**record, "version": "1"}, {}, "1")
    (folder / "data" / "a b.bin").write_bytes(b"x" * 9_000_000)
    assert not still_done({**record, "version": "1"}, {}, "1")
    (folder / "a.gltf").write_text("[]")  # its reader will say so
    (task,) = plan(ENCODE, "a.gltf")
    assert isinstance(task, Task)
    assert task.size == 2
