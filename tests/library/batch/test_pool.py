"""Worker processes: whatever becomes of one, one file is concerned."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

import children
import pytest
import works
from places import SUPPORT
from works import task

from deltamesh.batch import WorkerError, run_here, run_in_processes

posix = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")


def test_all_in_order_in_this_process() -> None:
    begun: list[str] = []
    tasks = [task("a"), task("raise"), task("b")]
    outcomes = run_here(tasks, works.obey, begin=lambda ts: begun.extend(t.source for t in ts))
    first = next(outcomes)
    assert begun == ["a"], "a task begins when its turn has come"
    done = [first, *outcomes]
    assert [one for one, _ in done] == tasks
    assert isinstance(done[1][1], WorkerError)
    assert str(done[1][1]) == "LookupError: nothing there"
    assert done[2][1]["pid"] == os.getpid()


@posix
def test_every_fate_at_once(tmp_path: Path) -> None:
    names = ["die-a", "hang-b", "nap-c", "raise-d", "nap-e", "once-f", "nap-g"]
    tasks = [works.Task(name, str(tmp_path / name), 1) for name in names]
    begun: list[str] = []
    start = time.monotonic()
    run = run_in_processes(
        tasks, works.obey, jobs=3, timeout=2, begin=lambda ts: begun.extend(t.source for t in ts)
    )
    done = {one.source: outcome for one, outcome in run}
    assert time.monotonic() - start < 55
    assert sorted(done) == sorted(names)
    assert isinstance(done["hang-b"], TimeoutError)
    assert str(done["hang-b"]) == "it took more than 2 seconds"
    assert isinstance(done["die-a"], WorkerError)
    assert str(done["die-a"]) == "its process died (SIGKILL), twice"
    assert str(done["raise-d"]) == "LookupError: nothing there"
    for name in ("nap-c", "nap-e", "once-f", "nap-g"):
        assert done[name]["source"] == name
    assert begun.count("die-a") == begun.count("once-f") == 2
    assert begun.count("nap-c") == 1


def test_a_worker_has_one_thread_and_is_used_again() -> None:
    done = dict(run_in_processes([task(str(i)) for i in range(12)], works.tell, jobs=2))
    assert len(done) == 12
    assert {record["threads"] for record in done.values()} == {"1"}
    assert not any(record["numpy"] for record in done.values()), "threads are set before that"
    workers = {record["pid"] for record in done.values()}
    assert len(workers) <= 2
    assert os.getpid() not in workers


def test_large_tasks_do_not_run_beside_each_other() -> None:
    needs = [1, 6, 6, 1, 1, 20, 1]
    tasks = [task(str(i), need) for i, need in enumerate(needs)]
    run = run_in_processes(tasks, works.log_interval, jobs=3, memory=10)
    done = {int(one.source): record for one, record in run}

    def together(i: int, j: int) -> bool:
        return done[i]["begin"] < done[j]["end"] and done[j]["begin"] < done[i]["end"]

    assert not together(1, 2)
    assert not any(together(5, other) for other in done if other != 5)


@posix
def test_processes_that_cannot_begin_end_the_run() -> None:
    run = run_in_processes([task("a")], works.tell, jobs=1, prepare=works.refuse)
    with pytest.raises(WorkerError, match=r"could not begin: its process died \(exit code 7\)"):
        list(run)


@posix
def test_an_idle_worker_that_is_killed_is_replaced() -> None:
    tasks = [task("nap-0"), task("nap-1"), *(task(f"x-{i}", need=6) for i in range(4))]
    run = run_in_processes(tasks, works.obey, jobs=2, memory=10)
    pids = {next(run)[1]["pid"], next(run)[1]["pid"]}
    # From here on only one task runs at once, so one of the two is idle.
    for pid in pids:
        os.kill(pid, signal.SIGKILL)
    assert len(list(run)) == 4


@posix
def test_closing_kills_what_runs(tmp_path: Path) -> None:
    beats = tmp_path / "beats"
    run = run_in_processes([works.Task("beat", str(beats), 1), task("a")], works.obey, jobs=2)
    next(run)  # what comes second is done first
    children.wait_for(lambda: beats.exists() and beats.stat().st_size > 0)
    run.close()
    assert stopped(beats)


# What somebody's script may look like.
SCRIPT = """
import sys
from functools import partial
import works
from deltamesh.batch import run_in_processes
if __name__ == "__main__":
    list(run_in_processes([works.Task("a", sys.argv[1], 1)], works.beat, jobs=1))
"""


@posix
def test_workers_end_when_their_parent_is_killed(tmp_path: Path) -> None:
    script, beats = tmp_path / "script.py", tmp_path / "beats"
    script.write_text(SCRIPT)
    paths = os.pathsep.join([str(SUPPORT), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, str(script), str(beats)]
    with children.started(command, env={**os.environ, "PYTHONPATH": paths}) as child:
        children.wait_for(lambda: beats.exists() and beats.stat().st_size > 0)
        child.process.kill()
        assert stopped(beats)


def stopped(beats: Path) -> bool:
    """Tell whether a file stops growing, within seconds."""
    for _ in range(20):
        size = beats.stat().st_size
        time.sleep(0.3)
        if beats.stat().st_size == size:
            return True
    return False
