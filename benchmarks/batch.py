"""`deltamesh batch` on a folder: serially, by processes, by Dask, and killed in the middle."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import click
import corpus

from deltamesh_cli.output import table

_EXAMPLES = """\
python benchmarks/make_folder.py /tmp/many && python benchmarks/batch.py /tmp/many
python benchmarks/batch.py /tmp/many --jobs 8 --method cartesian"""

_HEADING = ("run", "files", "seconds", "CPU s", "files/s", "MB/s", "speed", "peak MiB", "bytes")

# How often processes are looked at, in seconds.
_PERIOD = 0.1


class Run(NamedTuple):
    """What a run took: seconds, seconds of all cores, and the most memory of all its processes."""

    seconds: float
    cpu: float
    peak: int


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--jobs", default=2, show_default=True, help="Processes, and workers of Dask.")
@click.option("--method", default="highpass", show_default=True, help="As of deltamesh encode.")
def command(folder: Path, jobs: int, method: str) -> None:
    """Encode the meshes of FOLDER in each way, compare the bytes, and print a table.

    The last two rows are one run: killed by SIGKILL when half of the files are done, and resumed.
    Speed is files per second over those of the serial run. Memory is counted without what
    processes share (PSS), every tenth of a second; Linux only.
    """
    with tempfile.TemporaryDirectory() as temporary:
        top = Path(temporary)
        rows = Rows(folder, top, method)
        rows.add("serial")
        rows.add(f"-j {jobs}", "-j", jobs)
        rows.add(f"--dask-local {jobs}", "--dask-local", jobs)
        half = rows.total // 2
        arguments = ("-j", jobs, "--resume")
        rows.add("killed", *arguments, name="killed", until=lambda: rows.done("killed") >= half)
        before = rows.done("killed")
        rows.add("resumed", *arguments, name="killed", before=before)
        click.echo(table([_HEADING, *rows.rows]))
        click.echo(f"\n{rows.summary('killed', before)}")


class Rows:
    """The rows of the table, as they are measured."""

    def __init__(self, folder: Path, top: Path, method: str) -> None:
        self.folder, self.top, self.method = folder, top, method
        files = [path for path in folder.rglob("*") if path.is_file()]
        self.total, self.size = len(files), sum(path.stat().st_size for path in files)
        self.rows: list[tuple[str, ...]] = []
        self.expected = ""
        self.speed = 0.0

    def records(self, name: str) -> list[dict[str, object]]:
        """Return the records of files that are done; the last line may be half written."""
        path = self.top / f"{name}.jsonl"
        lines = path.read_bytes().split(b"\n")[:-1] if path.exists() else []
        return [record for record in map(json.loads, lines) if record["status"] == "done"]

    def done(self, name: str) -> int:
        """Return how many files are done."""
        return len(self.records(name))

    def add(
        self,
        title: str,
        *arguments: object,
        name: str = "",
        before: int = 0,
        until: Callable[[], bool] | None = None,
    ) -> None:
        """Measure a run, from `before` files on; kill it when `until` says so."""
        name = name or f"run{len(self.rows)}"
        output = self.top / name
        line = [sys.executable, "-m", "deltamesh_cli", "batch", "-q", "-r", str(self.folder)]
        line += ["--output-dir-mirror", str(output), "--manifest", f"{output}.jsonl"]
        used = measured([*line, "--method", self.method, *map(str, arguments)], until)
        count = self.done(name) - before
        digest = _digest(output) if until is None else ""
        self.expected = self.expected or digest
        speed = count / used.seconds
        self.speed = self.speed or speed
        self.rows.append(
            (
                title,
                str(count),
                f"{used.seconds:.1f}",
                "-" if until else f"{used.cpu:.1f}",
                f"{speed:.2f}",
                f"{self.size / 1e6 * count / self.total / used.seconds:.2f}",
                f"{speed / self.speed:.2f}",
                f"{used.peak / 2**20:.0f}",
                "-" if until else "equal" if digest == self.expected else "DIFFERENT",
            )
        )

    def summary(self, name: str, before: int) -> str:
        """Return whether anything was lost or done twice."""
        sources = [record["source"] for record in self.records(name)]
        left = len(list((self.top / name).rglob(".deltamesh-*")))
        return (
            f"killed at {before} of {self.total} files; after the resumption {len(sources)} on"
            f" record, {len(sources) - len(set(sources))} of them twice, {left} temporary files"
        )


def _digest(folder: Path) -> str:
    """Return a digest of the names and bytes of all files in a folder."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            digest.update(f"{path.relative_to(folder)}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def measured(line: list[str], until: Callable[[], bool] | None) -> Run:
    """Run a command line and measure it; kill it as soon as `until` holds.

    Raises
    ------
    click.ClickException
        If it fails.
    """
    start, peak = time.perf_counter(), 0
    process = subprocess.Popen(line)
    cpu = _children_cpu()
    while process.poll() is None:
        peak = max(peak, sum(map(_pss, _tree(process.pid))))
        if until is not None and until():
            process.send_signal(signal.SIGKILL)
            process.wait()
            break
        time.sleep(_PERIOD)
    seconds = time.perf_counter() - start
    if until is None and process.returncode:
        raise click.ClickException(f"{' '.join(line)}: exit code {process.returncode}")
    return Run(seconds, _children_cpu() - cpu, peak)


def _children_cpu() -> float:
    used = os.times()
    return used.children_user + used.children_system


def _tree(pid: int) -> list[int]:
    """Return a process and all that it has started, as far as they are still there."""
    children: list[str] = []
    with suppress(OSError):  # each thread has its own
        for thread in Path(f"/proc/{pid}/task").iterdir():
            children += (thread / "children").read_text().split()
    return [pid, *(one for child in children for one in _tree(int(child)))]


def _pss(pid: int) -> int:
    """Return the memory of a process, what it shares divided by how many share it, in bytes."""
    try:
        text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0
    return 1024 * sum(int(row.split()[1]) for row in text.splitlines() if row.startswith("Pss:"))


if __name__ == "__main__":
    command()
