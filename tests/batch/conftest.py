"""A Dask cluster: a scheduler and workers, processes of their own on the loopback address."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

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
    paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, **_ENVIRONMENT, "PYTHONPATH": paths}
    common = ["--no-dashboard", "--scheduler-file", str(file)]
    dask = [sys.executable, "-m", "distributed.cli"]
    commands = [["dask_scheduler", "--host", "127.0.0.1", "--port", "0", *common]]
    commands += [["dask_worker", "--nthreads", "1", "--death-timeout", "240", *common]] * 2
    processes = []
    try:
        for module, *arguments in commands:
            command = [*dask[:-1], f"{dask[-1]}.{module}", *arguments]
            log = open(folder / "log", "ab")  # noqa: SIM115
            with log:
                processes.append(
                    subprocess.Popen(command, env=environment, cwd=folder, stdout=log, stderr=log)
                )
        deadline = time.monotonic() + 240
        while not file.exists() or not file.read_text().endswith("}"):
            assert time.monotonic() < deadline, (folder / "log").read_text()
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        with distributed.Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=240)
            yield Cluster(address, client)
    finally:
        # Killed, since a nanny takes seconds to say goodbye; a worker ends with its nanny.
        for process in processes:
            process.kill()
            process.wait()
