"""Sums over the records of a batch, and engines that make the records."""

from __future__ import annotations

import json
from collections.abc import Generator
from pathlib import Path

import pytest

from deltamesh.batch import DONE, FAILED, SKIPPED, Task
from deltamesh_cli.batch.engines import here
from deltamesh_cli.batch.report import BEFORE, Totals, displayed_files, report_record, times
from deltamesh_cli.batch.run import ExistingFiles, Verbosity, run_batch
from deltamesh_cli.batch.work import Job


def record(status: str = DONE, **more: object) -> dict[str, object]:
    found = {"status": status, "source": "a.ply", "target": "a.dmesh", "source_bytes": 100}
    return {**found, **({"target_bytes": 25, "seconds": 0.5} if status == DONE else {}), **more}


def totals() -> Totals:
    found = Totals()
    found.add(record(errors={"max_relative": 0.25, "normal_deviation_degrees": None}), False)
    found.add(record(source="b.ply", errors={"max_relative": 0.5}), False)
    found.add(record(errors=None), True)
    found.add(record(FAILED, exit_code=3), False)
    found.add(record(FAILED, exit_code=1), False)
    found.add(record(SKIPPED), False)
    return found


def test_totals_are_sums_by_what_became_of_files() -> None:
    shown = totals().as_object()
    assert shown["files"] == {DONE: 2, BEFORE: 1, SKIPPED: 1, FAILED: 2}
    assert (shown["source_bytes"], shown["target_bytes"]) == (300, 75)
    assert shown["exit_codes"] == {"1": 1, "3": 1}
    assert shown["exit_code"] == totals().exit_code == 3
    assert shown["worst"] == {"max_relative": {"value": 0.5, "file": "b.ply"}}
    assert json.loads(json.dumps(shown)) == shown


def test_totals_of_nothing_are_a_success() -> None:
    assert Totals().exit_code == 0
    assert DONE in Totals().as_text()
    assert FAILED not in Totals().as_text()


def test_the_table_has_a_line_for_each_outcome_and_the_worst_errors() -> None:
    lines = totals().as_text().splitlines()
    done, before = (line for line in lines if line.split()[:1] == [DONE])
    assert done.split()[1:5] == ["2", "200", "50", "25.00"]
    assert before.split()[:5] == [*BEFORE.split(), "1", "100", "25"]
    assert any("0.5" in line and "b.ply" in line for line in lines)


def test_failures_are_told_to_people_and_records_to_programs(
    capsys: pytest.CaptureFixture[str],
) -> None:
    report_record(record(FAILED, message="a.ply: cannot encode"), as_json=True)
    shown = capsys.readouterr()
    assert shown.err == "deltamesh: a.ply: cannot encode\n"
    assert json.loads(shown.out)["status"] == FAILED
    report_record(record(), as_json=False)
    assert capsys.readouterr() == ("", "")


def test_notes_of_what_is_done_are_told_unless_it_is_quiet(
    capsys: pytest.CaptureFixture[str],
) -> None:
    report_record(record(notes=["a.dmesh: large"]), as_json=False)
    assert capsys.readouterr() == ("", "note: a.dmesh: large\n")
    report_record(record(notes=["a.dmesh: large"]), as_json=False, quiet=True)
    assert capsys.readouterr() == ("", "")


def test_files_that_lose_something_are_counted() -> None:
    assert "not kept" not in totals().as_text()
    found = totals()
    found.add(record(not_kept=["textures", "skins"]), False)
    found.add(record(source="b.glb", not_kept=["lights"]), False)
    last = found.as_text().splitlines()[-1]
    assert last == "not kept is something of 2 files, such as textures of a.ply"


def test_what_grows_is_told_in_times() -> None:
    found = Totals()
    found.add(record(source_bytes=100, target_bytes=6684), False)
    assert "66.8 times" in found.as_text()
    assert "%" not in found.as_text()


def test_times_are_in_words() -> None:
    assert times(19.2, 5.4) == "19 s elapsed, 5 s left"
    assert times(200, None) == "3 min 20 s elapsed"
    assert times(0, 7500) == "0 s elapsed, 2 h 5 min left"


@pytest.mark.parametrize(
    ("existing", "command"),
    [
        (ExistingFiles(), "the same command with --skip-existing"),
        (ExistingFiles(skip_existing=True), "the same command"),
        (ExistingFiles(manifest="run.jsonl"), "the same command with --resume"),
        (ExistingFiles(manifest="run.jsonl", resume=True), "the same command"),
    ],
)
def test_an_interrupted_run_says_how_to_complete_it(
    folder: Path,
    existing: ExistingFiles,
    command: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def engine(job: Job, tasks: list[Task], begin: object) -> Generator[object]:
        yield tasks[0], record(source=tasks[0].source, target=tasks[0].target)
        raise KeyboardInterrupt

    planned = [Task(f"{name}.ply", f"{name}.ply.dmesh", 9) for name in "abc"]
    with pytest.raises(KeyboardInterrupt):
        run_batch(planned, Job(False, None, {}), engine, existing, Verbosity())
    shown = capsys.readouterr()
    assert shown.err == f"deltamesh: 1 of 3 files are done: {command} does the others\n"
    assert shown.out.splitlines()[1].split()[:2] == [DONE, "1"]


def test_verbose_counts_the_files(capsys: pytest.CaptureFixture[str]) -> None:
    with displayed_files(None, [100, 100], verbose=True, quiet=False) as tell:
        tell(record(), 100)
        tell(record(SKIPPED), 100)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("deltamesh: [1/2] a.ply -> a.dmesh: 100 -> 25 bytes")
    assert lines[1].startswith("deltamesh: [2/2] a.ply -> a.dmesh: ")
    with displayed_files(None, [100], verbose=False, quiet=True) as tell:
        tell(record(), 100)
    assert capsys.readouterr().err == ""


def test_work_in_this_process_gives_each_task_its_record(folder: Path) -> None:
    job = Job(False, None, {"method": "cartesian", "bits": 8})
    tasks = [Task("torus.ply", "new.dmesh", 9), Task("nothing.ply", "never.dmesh", 0)]
    begun: list[Task] = []
    outcomes = list(here(job, tasks, begun.extend))
    assert [task for task, _ in outcomes] == begun == tasks
    first, second = (found for _, found in outcomes)
    assert isinstance(first, dict)
    assert isinstance(second, dict)
    assert (first["status"], second["status"]) == (DONE, FAILED)
    assert (folder / "new.dmesh").stat().st_size == first["target_bytes"]
    assert not (folder / "never.dmesh").exists()
