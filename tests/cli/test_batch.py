"""`deltamesh batch`: many files, interrupted and resumed."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import children
import meshes
import pytest
from commandline import PROGRAM, cli, damaged, posix
from killed import dead_process, left_of
from screens import shown

from deltamesh.batch import Task
from deltamesh.batch._manifest import begun_record, line, open_manifest
from deltamesh_cli import files
from deltamesh_cli.batch import run as batch_run
from deltamesh_cli.batch.work import Job, work
from deltamesh_cli.commands import batch
from deltamesh_formats.meshfiles.files import mesh_bytes, read_mesh
from deltamesh_formats.polymesh.mesh import from_triangles

SCANS = {
    "scans/a.ply": meshes.icosphere(1),
    "scans/sub/b.obj": meshes.torus(9, 7),
    "scans/sub/deep/c.STL": meshes.icosphere(2),
    "scans/d.off": meshes.grid(7, 9),
}
NAMES = sorted(SCANS)


def mesh_file(name: str, mesh: meshes.Arrays) -> None:
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(mesh_bytes(from_triangles(*mesh), files.extension(name)))


@pytest.fixture
def scans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The current folder, with four meshes in `scans`; no temporary file may stay in it."""
    monkeypatch.chdir(tmp_path)
    for name, mesh in SCANS.items():
        mesh_file(name, mesh)
    yield tmp_path
    assert not list(tmp_path.rglob(".deltamesh-*"))


def records(name: str = "run.jsonl", status: str = "done") -> list[dict[str, Any]]:
    lines = Path(name).read_text().splitlines()
    return [record for record in map(json.loads, lines) if record["status"] == status]


def sources(name: str = "run.jsonl", status: str = "done") -> list[str]:
    return [record["source"] for record in records(name, status)]


def contents(folder: str) -> dict[str, bytes]:
    """Every file of a folder, by its name in it."""
    top = Path(folder)
    return {str(p.relative_to(top)): p.read_bytes() for p in sorted(top.rglob("*")) if p.is_file()}


def encoded(name: str, *options: str) -> bytes:
    """What `deltamesh encode` makes of a file."""
    path = Path(name)
    return encoded_once(path.read_bytes(), path.suffix, options)


@cache
def encoded_once(data: bytes, suffix: str, options: tuple[str, ...]) -> bytes:
    with TemporaryDirectory() as folder:
        source, target = Path(folder, f"mesh{suffix}"), Path(folder, "mesh.dmesh")
        source.write_bytes(data)
        assert cli("encode -q", str(source), str(target), *options) == 0
        return target.read_bytes()


def test_bytes_are_those_of_encode_beside_the_inputs(scans: Path) -> None:
    assert cli("batch -q -r scans --bits 6") == 0
    for name in NAMES:
        assert Path(f"{name}.dmesh").read_bytes() == encoded(name, "--bits", "6")


def test_a_mirror_and_back(scans: Path) -> None:
    assert cli("batch -q -r scans --output-dir-mirror packed") == 0
    assert sorted(contents("packed")) == [f"{name}.dmesh" for name in NAMES]
    assert cli("batch -q -d -r packed/scans --output-dir-mirror back") == 0
    assert sorted(contents("back/packed")) == NAMES
    for name in NAMES:
        assert cli("decode -q -f", f"packed/{name}.dmesh", f"one{Path(name).suffix}") == 0
        made = Path(f"one{Path(name).suffix}").read_bytes()
        assert Path("back/packed", name).read_bytes() == made


def test_a_flat_folder_and_another_format(scans: Path) -> None:
    assert cli("batch -q scans/*.* scans/sub/b.obj --output-dir-flat out/deep") == 0
    assert sorted(contents("out/deep")) == ["a.ply.dmesh", "b.obj.dmesh", "d.off.dmesh"]
    assert cli("batch -q -d -r out --output-dir-flat back --output-format stl") == 0
    assert sorted(contents("back")) == ["a.stl", "b.stl", "d.stl"]


def test_a_name_that_tells_no_format_becomes_what_was_encoded(scans: Path) -> None:
    assert cli("encode -q scans/d.off packed.dmesh") == 0
    assert cli("batch -q -d packed.dmesh") == 0
    assert read_mesh("packed.off").format == "off"


def test_names_that_collide_are_refused_before_anything_is_done(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy("scans/a.ply", "scans/sub/a.ply")
    assert cli("batch -r scans --output-dir-flat out --manifest run.jsonl") == 2
    told = capsys.readouterr().err
    assert "'scans/a.ply' and 'scans/sub/a.ply' would both be written" in " ".join(told.split())
    assert not Path("out").exists()
    assert not Path("run.jsonl").exists()


def test_one_failure_does_not_stop_the_others(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    V, F = meshes.tetrahedron()
    mesh_file("scans/bad.ply", (1e200 * V, F))
    Path("scans/empty.obj").touch()
    assert cli("batch -r scans missing.ply --manifest run.jsonl") == 1
    told = capsys.readouterr()
    assert "deltamesh: missing.ply: cannot read: no such file" in told.err
    assert "deltamesh: scans/bad.ply: cannot encode: " in told.err
    assert told.out.splitlines()[0].split()[:3] == ["files", "bytes", "in"]
    assert ["failed", "3"] in [row.split()[:2] for row in told.out.splitlines()]
    assert sorted(sources()) == NAMES
    failed = {record["source"]: record for record in records(status="failed")}
    assert sorted(failed) == ["missing.ply", "scans/bad.ply", "scans/empty.obj"]
    assert failed["scans/bad.ply"]["error"]["kind"] == "MeshError"
    assert failed["scans/bad.ply"]["exit_code"] == 1
    assert failed["missing.ply"]["error"]["kind"] == "FileNotFoundError"


def test_the_exit_code_is_that_of_the_worst_file(scans: Path) -> None:
    assert cli("batch -q -r scans --normal-error 1e-9") == 4
    Path("whole.ply.dmesh").write_bytes(encoded("scans/a.ply"))
    Path("bad.ply.dmesh").write_bytes(damaged(encoded("scans/a.ply")))
    assert cli("batch -q -d whole.ply.dmesh bad.ply.dmesh missing.dmesh") == 3
    assert Path("whole.ply").exists()
    assert not Path("bad.ply").exists()


def test_a_decoder_is_held_to_its_memory(scans: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("encode -q scans/a.ply a.dmesh") == 0
    assert cli("batch -d a.dmesh --memory 1M") == 3
    assert "--memory raise the limits" in capsys.readouterr().err


def test_existing_outputs_are_left_unless_asked(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("scans/a.ply.dmesh").write_bytes(b"precious")
    assert cli("batch -q -r scans --exclude sub --manifest 1.jsonl") == 1
    assert "scans/a.ply.dmesh: cannot write: it exists already (-f" in capsys.readouterr().err
    assert sources("1.jsonl") == ["scans/d.off"]
    assert cli("batch -q -r scans --skip-existing --manifest 2.jsonl") == 0
    assert sources("2.jsonl", "skipped") == ["scans/a.ply", "scans/d.off"]
    assert Path("scans/a.ply.dmesh").read_bytes() == b"precious"
    assert cli("batch -q -r scans -f --manifest 2.jsonl") == 0
    assert sorted(sources("2.jsonl")) == NAMES, "begun anew"
    assert Path("scans/a.ply.dmesh").read_bytes() == encoded("scans/a.ply")


def test_points_and_lines_are_skipped_and_said(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points = "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"
    Path("scans/points.off").write_text(points)
    Path("scans/lines.obj").write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
    assert cli("batch -r scans --manifest run.jsonl") == 0
    shown = capsys.readouterr()
    cloud = "3 vertices but no faces: a point cloud, which LAZ, Draco and pcodec compress"
    assert f"deltamesh: scans/points.off: skipped: it holds {cloud}\n" in shown.err
    assert "deltamesh: scans/lines.obj: skipped: it holds 2 vertices but no faces" in shown.err
    assert [line.split()[1] for line in shown.out.splitlines() if "skipped" in line] == ["2"]
    assert sources("run.jsonl", "skipped") == ["scans/lines.obj", "scans/points.off"]
    (skipped, _) = records("run.jsonl", "skipped")
    assert "exit_code" not in skipped
    assert sources("run.jsonl") == NAMES
    # What is skipped is looked at again: it may be another file now.
    Path("scans/points.off").write_bytes(Path("scans/d.off").read_bytes())
    assert cli("batch -r scans --manifest run.jsonl --resume --json") == 0
    summary = json.loads(capsys.readouterr().out.splitlines()[-1])["summary"]
    assert summary["files"] == {"done": 1, "done before": 4, "skipped": 1, "failed": 0}
    # Alone, it is a failure as any other.
    Path("points.off").write_text(points)
    assert cli("encode points.off") == 1
    assert cloud in capsys.readouterr().err


def test_a_dry_run_writes_nothing(scans: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("scans/a.ply.dmesh").touch()
    before = contents(".")
    line = "batch -n -r scans --skip-existing --manifest run.jsonl"
    assert cli(f"{line} --output-dir-mirror out") == 0
    assert capsys.readouterr().out.splitlines()[0] == "scans/a.ply -> out/scans/a.ply.dmesh"
    assert cli(line) == 0
    assert capsys.readouterr().out.splitlines()[0] == "scans/a.ply -> scans/a.ply.dmesh: skipped"
    assert cli("batch -n -r scans missing.ply --json") == 1
    told = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    status = {record["source"]: record["status"] for record in told}
    assert status == {
        **dict.fromkeys(NAMES, "planned"), "scans/a.ply": "failed", "missing.ply": "failed"
    }  # fmt: skip
    assert contents(".") == before


def test_a_list_of_files(scans: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("list").write_text("scans/a.ply\r\n\nscans/d.off\nscans/a.ply\n./scans/d.off\n")
    assert cli("batch -q --filelist list --manifest run.jsonl") == 0
    assert sources() == ["scans/a.ply", "scans/d.off"]


@posix
def test_a_list_from_standard_input_with_any_name(scans: Path) -> None:
    names = ["scans/new\nline.ply", "scans/ünï 网格.ply", os.fsdecode(b"scans/\xff.ply"), "*.ply"]
    for name in names:
        mesh_file(name, meshes.tetrahedron())
    done = children.run(
        [*PROGRAM, "batch", "-0", "--filelist", "-", "--manifest", "run.jsonl", "--json"],
        given=b"\0".join(map(os.fsencode, names)) + b"\0",
    )
    assert done.returncode == 0, done.stderr
    assert sources() == sorted(names)
    assert all(Path(f"{name}.dmesh").is_file() for name in names)
    *each, last = [json.loads(line) for line in done.stdout.splitlines()]
    assert [record["source"] for record in each] == sorted(names)
    assert last["summary"]["files"]["done"] == 4
    assert cli("batch -q -r scans . --manifest run.jsonl --resume") == 0
    assert sorted(sources()) == sorted([*names, *NAMES]), "nothing was done twice"


def test_nothing_to_do_is_no_failure(scans: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("empty").mkdir()
    assert cli("batch -r empty") == 0
    assert "there is nothing to do" in capsys.readouterr().err


def test_output_in_the_tree_of_the_input_is_not_input(scans: Path) -> None:
    assert cli("batch -q -r scans --output-dir-mirror scans/packed") == 0
    assert cli("batch -q -d -r scans --output-dir-mirror scans/back") == 0
    before = contents("scans")
    assert cli("batch -q -r scans --output-dir-mirror scans/packed --skip-existing") == 0
    assert cli("batch -q -r . --output-dir-mirror scans --exclude packed --exclude back") == 0
    made = contents("scans")
    assert {name: made[name] for name in before} == before
    assert all(name.startswith("packed/scans/back") for name in made.keys() - before.keys())


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("batch", "No file, folder or --filelist is given"),
        ("batch -r scans --resume", "--resume needs --manifest"),
        ("batch -r scans -f --skip-existing", "--force and --skip-existing exclude each other"),
        ("batch -r scans --output-dir-flat a --output-dir-mirror b", "exclude each other"),
        ("batch -r scans -j 2 --dask-local 2", "--jobs and --dask-local exclude each other"),
        ("batch -r scans --timeout 9 --scheduler x", "--timeout and --scheduler exclude"),
        ("batch -r scans --bits 6 --step 1", "--bits and --step exclude each other"),
        ("batch -r scans --method refined --coarse 2 --bits 0", "bits must lie in 1..30"),
        ("batch -r scans --method cartesian --seed 1", "--seed means nothing with"),
        ("batch -d -r scans --bits 6", "--bits means nothing with -d"),
        ("batch -r scans --max-vertices 6", "--max-vertices means nothing without -d"),
        ("batch -r scans --rank 1", "--rank and --world-size go together"),
        ("batch -r scans --rank 4 --world-size 4", "rank must lie in 0..3, not 4"),
        ("batch -r scans --rank 1 --world-size 4 --slurm array", "exclude each other"),
        ("batch ../x.ply --output-dir-mirror out", "has no place in a mirror"),
    ],
)
def test_usage(scans: Path, capsys: pytest.CaptureFixture[str], line: str, told: str) -> None:
    assert cli(line) == 2
    assert told in " ".join(capsys.readouterr().err.split())
    assert not list(Path().rglob("*.dmesh"))


def test_every_option_of_encode_and_decode_is_there() -> None:
    from deltamesh_cli.commands import batch, decode, encode

    # A batch makes a file of each mesh, and decodes whole files, at rest and in frame 0: the names
    # of poses, and the numbers of frames, are those of one file.
    of_one_file = {"source", "names", "target", "output", "force_name", "partial", "pose"}
    of_one_file |= {"sequence", "fps", "key_every", "frame", "all_frames"}
    ours = {parameter.name: parameter for parameter in batch.command.params}
    for other in (encode, decode):
        for parameter in other.command.params:
            if parameter.name not in of_one_file:
                assert parameter.name in ours


def test_shares_are_all(scans: Path) -> None:
    for rank in range(3):
        line = f"batch -q -r scans --rank {rank} --world-size 3 --manifest {rank}.jsonl"
        assert cli(line) == 0
    assert sources("0.jsonl") == [NAMES[0], NAMES[3]]
    assert sources("1.jsonl") == [NAMES[1]]
    assert sources("2.jsonl") == [NAMES[2]]


def test_shares_by_slurm_are_taken_only_when_asked(
    scans: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def array(identifier: int, first: int, last: int, step: int, count: int) -> None:
        values = {"ID": identifier, "MIN": first, "MAX": last, "STEP": step, "COUNT": count}
        for name, value in values.items():
            monkeypatch.setenv(f"SLURM_ARRAY_TASK_{name}", str(value))

    def share(*options: str) -> list[str]:
        capsys.readouterr()
        assert cli("batch -n -r scans", *options) == 0
        return [line.split(" ->")[0] for line in capsys.readouterr().out.splitlines()]

    array(5, 3, 7, 2, 3)  # --array=3-7:2, its second task
    assert share() == NAMES
    assert share("--slurm", "array") == [NAMES[1]]
    array(7, 3, 7, 2, 3)
    assert share("--slurm", "array") == [NAMES[2]]
    array(4, 1, 4, 1, 3)  # --array=1,2,4
    assert cli("batch -n -r scans --slurm array") == 2
    assert "has gaps" in capsys.readouterr().err
    assert cli("batch -n -r scans --slurm step") == 2
    assert "SLURM_PROCID is not set" in capsys.readouterr().err
    monkeypatch.setenv("SLURM_PROCID", "3")
    monkeypatch.setenv("SLURM_NTASKS", "4")
    assert share("--slurm", "step") == [NAMES[3]]


def test_a_record_tells_everything(scans: Path) -> None:
    import hashlib

    assert cli("batch -q scans/a.ply --bits 7 --threads 1 --manifest run.jsonl") == 0
    (record,) = records()
    for prefix in ("source", "target"):
        data = Path(record[prefix]).read_bytes()
        assert record[f"{prefix}_bytes"] == len(data)
        assert record[f"{prefix}_sha256"] == hashlib.sha256(data).hexdigest()
    assert (record["vertices"], record["faces"]) == (42, 80)
    assert 0 < record["errors"]["rms"] <= record["errors"]["max"]
    assert record["seconds"] > 0
    assert record["options"] == {
        "decode": False, "method": "auto", "bits": 7, "solver": "auto"
    }  # fmt: skip


def test_resuming_does_what_is_left_and_nothing_else(scans: Path) -> None:
    line = "batch -q -r scans --output-dir-mirror out --manifest run.jsonl --resume"
    V, F = meshes.tetrahedron()
    mesh_file("scans/z.ply", (1e200 * V, F))
    assert cli(line) == 1
    assert sorted(sources()) == NAMES
    mesh_file("scans/z.ply", meshes.tetrahedron())  # mended
    os.unlink(f"out/{NAMES[1]}.dmesh")  # lost
    mesh_file(NAMES[2], meshes.icosphere(1))  # changed
    os.utime(NAMES[0])  # touched
    assert cli(line) == 0
    assert sources()[len(NAMES) :] == [NAMES[1], NAMES[2], "scans/z.ply"]
    assert cli(line) == 0
    assert len(sources()) == len(NAMES) + 3
    assert cli(line, "--bits", "5") == 0
    assert len(sources()) == 2 * (len(NAMES) + 1) + 2, "with other options all is to be done"
    assert cli(line, "--bits", "5", "--threads", "2") == 0
    assert len(sources()) == 2 * (len(NAMES) + 1) + 2, "unless the output does not depend on them"
    assert Path(f"out/{NAMES[0]}.dmesh").read_bytes() == encoded(NAMES[0], "--bits", "5")


def test_resuming_keeps_what_somebody_else_has_written(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = "batch -r scans --manifest run.jsonl --resume"
    assert cli(line) == 0
    Path(f"{NAMES[0]}.dmesh").write_bytes(b"precious")
    assert cli(line) == 1
    assert f"{NAMES[0]}.dmesh: cannot write: it exists already" in capsys.readouterr().err
    assert Path(f"{NAMES[0]}.dmesh").read_bytes() == b"precious"


def test_what_was_begun_is_ours(scans: Path) -> None:
    target = Path(f"{NAMES[0]}.dmesh")
    target.write_bytes(b"written, but not yet on record")
    left_of(target, dead_process())
    Path("run.jsonl").write_bytes(line(begun_record(NAMES[0], str(target))))
    assert cli("batch -q -r scans --manifest run.jsonl --resume") == 0
    assert target.read_bytes() == encoded(NAMES[0])


def test_nothing_is_left_of_a_worker_that_died_before_another_did_its_work(
    scans: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half_written(job: Job, tasks: list[Task], begin: Any) -> Any:
        for one in tasks:
            left_of(one.target, dead_process())
            yield one, work(job, one)

    monkeypatch.setattr(batch, "here", half_written)
    assert cli("batch -q scans/a.ply scans/d.off") == 0
    assert Path("scans/a.ply.dmesh").exists()


@pytest.mark.parametrize("engine", ["", "-j 2"])
def test_an_output_that_appears_during_the_run_is_kept(
    scans: Path, engine: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    target, other = Path("scans/a.ply.dmesh"), Path("scans/d.off.dmesh")

    def appear(todo: list[Task]) -> None:
        target.write_bytes(b"precious")
        other.write_bytes(same)

    same = encoded("scans/d.off")
    monkeypatch.setattr(batch_run, "_make_folders", appear)  # which comes after all is settled
    line = f"batch -q scans/a.ply scans/d.off {engine}"
    assert cli(line) == 1
    assert capsys.readouterr().err == (
        "deltamesh: scans/a.ply.dmesh: cannot write: it exists already (-f overwrites it)\n"
    )
    assert (target.read_bytes(), other.read_bytes()) == (b"precious", same)
    for path in (target, other):
        path.unlink()
    assert cli(line, "-f") == 0
    assert target.read_bytes() == encoded("scans/a.ply")


def test_a_manifest_in_use_or_of_another_kind_is_refused(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def told(*options: str) -> str:
        assert cli("batch -r scans --manifest", *options) == 1
        return capsys.readouterr().err

    with open_manifest("run.jsonl", resume=False):
        assert "it exists already" not in told("run.jsonl", "--resume")
    assert "file exists (--resume goes on with it" in told("run.jsonl")
    assert "line 1 is not a record" in told("scans/a.ply", "--resume")
    assert "cannot create the folder: file exists" in told("scans/a.ply/run.jsonl")
    assert not list(Path().rglob("*.dmesh"))


def test_verbose_tells_each_file(scans: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli("batch -v -r scans") == 0
    lines = capsys.readouterr().err.splitlines()
    assert [one.split("]")[0] for one in lines] == [f"deltamesh: [{i}/4" for i in (1, 2, 3, 4)]


@posix
def test_a_bar_is_drawn_on_a_terminal(scans: Path) -> None:
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "100"}
    Path("scans/bad.ply").write_bytes(b"?")
    command = [*PROGRAM, "batch", "-r", "scans", "missing.ply"]
    done = children.run(command, terminal="stderr", env=environment)
    assert done.returncode == 1
    missing, bad, bar, *rest = shown(done.stderr)
    assert missing == "deltamesh: missing.ply: cannot read: no such file or directory"
    assert bad.startswith("deltamesh: scans/bad.ply: cannot read: it does not begin with 'ply'")
    assert re.fullmatch(r"\S+ 5/5 files 100% \d+ s elapsed", bar)
    assert not any(rest)


@posix
def test_a_bar_says_what_is_left(scans: Path) -> None:
    many()
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "100"}
    done = children.run([*PROGRAM, "batch", "scans"], terminal="stderr", env=environment)
    assert done.returncode == 0
    assert re.search(rb"\d+ s elapsed, \d+ s left", done.stderr)


@posix
def test_objects_on_a_terminal_are_not_drawn_over(scans: Path) -> None:
    command = [*PROGRAM, "batch", "--json", "scans"]
    code = "import os, subprocess, sys; sys.exit(subprocess.call(sys.argv[1:], stderr=1))"
    done = children.run([sys.executable, "-c", code, *command], terminal="stdout")
    lines = done.stdout.decode().splitlines()
    assert len(lines) == 3
    assert [json.loads(line).get("status") for line in lines] == ["done", "done", None]


def many(count: int = 10) -> list[str]:
    """Make meshes that take a tenth of a second each."""
    names = [f"scans/{i:02}.ply" for i in range(count)]
    shutil.rmtree("scans")
    V, F = meshes.icosphere(4)
    for i, name in enumerate(names):
        mesh_file(name, (V * (1 + i / 10), F))
    return names


def interrupted(line: str, number: int, *, at: int) -> subprocess.CompletedProcess[bytes]:
    """Run a command line in a process group of its own, and signal that when `at` files are done.

    SIGKILL, which a group would not survive, goes to the one process that was started.
    """
    with children.started([*PROGRAM, *line.split()]) as child:
        process = child.process
        children.wait_for(lambda: Path("run.jsonl").exists() and len(finished()) >= at)
        send = process.send_signal if number == signal.SIGKILL else group_signal(process.pid)
        send(number)
        # To the end of its output, which the workers write to too: none of them is left.
        return child.finish()


def group_signal(pid: int) -> Callable[[int], None]:
    return lambda number: os.killpg(pid, number)


def finished() -> list[str]:
    """Which files are on record as done; the last line may be half written."""
    lines = Path("run.jsonl").read_bytes().split(b"\n")[:-1]
    found = [json.loads(one) for one in lines]
    return [record["source"] for record in found if record["status"] == "done"]


@posix
@pytest.mark.parametrize(
    ("number", "code", "told"),
    [
        pytest.param(signal.SIGKILL, -9, "", marks=pytest.mark.slow),
        (signal.SIGINT, 130, "interrupted"),
        pytest.param(signal.SIGTERM, 143, "terminated", marks=pytest.mark.slow),
    ],
)
def test_interrupted_and_resumed(scans: Path, number: int, code: int, told: str) -> None:
    names = many()
    line = "batch -r scans --manifest run.jsonl --output-dir-flat out --resume"
    done = interrupted(f"{line} -j 2", number, at=3)
    first = finished()
    assert 3 <= len(first) < len(names)
    assert done.returncode == code
    lines = [text for text in done.stderr.decode().splitlines() if text]
    if told:
        count = re.match(r"deltamesh: (\d+) of 10 files are done: the same command does", lines[0])
        # The signal may come between the record of a file and its count.
        assert count is not None
        assert len(first) - 1 <= int(count[1]) <= len(first)
        assert lines[1:] == [f"deltamesh: {told}"]
    else:
        assert not lines
    if number == signal.SIGKILL:
        with open("run.jsonl", "ab") as file:
            file.write(b'{"status": "do')  # as if the last line were torn
    else:
        assert not list(scans.rglob(".deltamesh-*"))
    before = {path.name: path.stat().st_mtime_ns for path in Path("out").glob("*.dmesh")}
    assert cli(line, "-q") == 0
    assert sorted(finished()) == names, "all are done, none twice"
    for name in names:
        target = Path("out", f"{Path(name).name}.dmesh")
        assert target.read_bytes() == encoded(name)
        if name in first:
            assert target.stat().st_mtime_ns == before[target.name]


@posix
def test_a_file_that_takes_too_long_is_given_up(
    scans: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh_file("scans/big.ply", meshes.icosphere(6))
    assert cli("batch scans/big.ply --timeout 0.05 --manifest run.jsonl") == 1
    told = capsys.readouterr().err
    assert told == "deltamesh: scans/big.ply: cannot encode: it took more than 0.05 seconds\n"
    assert records(status="failed")[0]["error"]["kind"] == "TimeoutError"
    assert not Path("scans/big.ply.dmesh").exists()


def test_the_work_is_light_to_import() -> None:
    """A worker must set the number of threads before numpy is imported."""
    code = "import deltamesh_cli.batch, sys; print('numpy' in sys.modules, 'rich' in sys.modules)"
    done = children.run([sys.executable, "-c", code], text=True)
    assert done.stdout == "False False\n"


@pytest.mark.parametrize("engine", ["", "-j 2"])
def test_debug_shows_the_traceback_of_each_failure(
    scans: Path, engine: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("bad.ply", "worse.obj"):
        (scans / name).write_bytes(b"no mesh")
    line = f"batch bad.ply worse.obj gone.ply --manifest x {engine}"
    assert cli(f"{line} -f") == 1
    assert "Traceback" not in capsys.readouterr().err
    assert b"raceback" not in (scans / "x").read_bytes()
    assert cli(f"{line} -f --debug") == 1
    told = capsys.readouterr().err
    assert told.count("Traceback (most recent call last)") >= 3
    assert told.index("MeshError") < told.index("deltamesh: bad.ply: ")
