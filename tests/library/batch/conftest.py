"""A Dask cluster: a scheduler and workers, processes of their own on the loopback address."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import children
import pytest
from places import SUPPORT

# A worker may die once of a task; the second one that does is the last that is asked to.
_ENVIRONMENT = {
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
    "DASK_DISTRIBUTED__WORKER__MEMORY__TERMINATE": "False",
}


@dataclass(frozen=True)
class Cluster:
    """The address of a scheduler, and a client of our own."""

    address: str
    client: Any

    def workers(self) -> dict[str, int]:
        """The process of each worker, by address."""
        self.client.wait_for_workers(2, timeout=240)
        return dict(self.client.run(os.getpid, on_error="ignore"))


@pytest.fixture(scope="session")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    distributed = pytest.importorskip("distributed")
    folder = tmp_path_factory.mktemp("cluster")
    file = folder / "scheduler.json"
    paths = os.pathsep.join([str(SUPPORT), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, **_ENVIRONMENT, "PYTHONPATH": paths}
    common = ["--no-dashboard", "--scheduler-file", str(file)]
    dask = [sys.executable, "-m", "distributed.cli"]
    scheduler = ["--host", "127.0.0.1", "--port", "0", "--idle-timeout", "15 minutes"]
    commands = [["dask_scheduler", *scheduler, *common]]
    commands += [["dask_worker", "--nthreads", "1", "--death-timeout", "240", *common]] * 2
    # Killed at the end, since a nanny takes seconds to say goodbye.
    with ExitStack() as stack:
        log = stack.enter_context(open(folder / "log", "ab"))
        for module, *arguments in commands:
            command = [*dask[:-1], f"{dask[-1]}.{module}", *arguments]
            streams = {"stdout": log, "stderr": log}
            whole_session = children.started(
                command, seconds=3600, env=environment, cwd=folder, **streams
            )
            stack.enter_context(whole_session)

        def is_there() -> bool:
            return file.exists() and file.read_text().endswith("}")

        children.wait_for(is_there)
        address = json.loads(file.read_text())["address"]
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=240)
            yield Cluster(address, client)
