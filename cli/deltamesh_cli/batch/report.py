"""What `deltamesh batch` tells: each failure, progress, and a table at the end."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final, TypeAlias

import click

from deltamesh.batch import DONE, FAILED, SKIPPED, Record
from deltamesh_cli.failures import DONE as SUCCESS
from deltamesh_cli.output import number, print_json, shown, table

# Called with each record, and whether an earlier run has made it.
Tell: TypeAlias = Callable[[Record, bool], None]

BEFORE: Final = "done before"
_ERRORS: Final = {
    "max_relative": "largest distance of a vertex, over the diagonal",
    "normal_deviation_degrees": "mean deviation of the face normals, degrees",
}


@dataclass
class Totals:
    """Sums over records.

    Attributes
    ----------
    files, source_bytes, target_bytes : Counter
        By what became of the files.
    codes : Counter
        How many files have failed with which exit code.
    worst : dict
        The largest error of each kind, and the file that has it.
    """

    files: Counter[str] = field(default_factory=Counter)
    source_bytes: Counter[str] = field(default_factory=Counter)
    target_bytes: Counter[str] = field(default_factory=Counter)
    codes: Counter[int] = field(default_factory=Counter)
    worst: dict[str, tuple[float, str]] = field(default_factory=dict)
    start: float = field(default_factory=time.perf_counter)

    def add(self, record: Record, before: bool) -> None:
        """Count a record."""
        status = BEFORE if before else record["status"]
        self.files[status] += 1
        self.source_bytes[status] += record.get("source_bytes") or 0
        self.target_bytes[status] += record.get("target_bytes") or 0
        if record["status"] == FAILED:
            self.codes[record["exit_code"]] += 1
        for name in _ERRORS:
            value = (record.get("errors") or {}).get(name)
            if value is not None and value > self.worst.get(name, (-1.0, ""))[0]:
                self.worst[name] = value, record["source"]

    @property
    def exit_code(self) -> int:
        """The worst code of all files, as for the other commands."""
        return max(self.codes, default=SUCCESS)

    def as_object(self) -> dict[str, object]:
        """Return the sums for `--json`."""
        return {
            "files": {name: self.files[name] for name in (DONE, BEFORE, SKIPPED, FAILED)},
            "source_bytes": self.source_bytes[DONE] + self.source_bytes[BEFORE],
            "target_bytes": self.target_bytes[DONE] + self.target_bytes[BEFORE],
            "exit_codes": {str(code): count for code, count in sorted(self.codes.items())},
            "worst": {
                name: {"value": value, "file": file} for name, (value, file) in self.worst.items()
            },
            "seconds": time.perf_counter() - self.start,
            "exit_code": self.exit_code,
        }

    def as_text(self) -> str:
        """Return the sums as a table."""
        blocks = [table(self._rows())]
        if self.worst:
            rows = [
                (_ERRORS[name], number(e), shown(file)) for name, (e, file) in self.worst.items()
            ]
            blocks.append(table([("worst", "", "file"), *rows]))
        return "\n\n".join(blocks)

    def _rows(self) -> Iterator[tuple[str, ...]]:
        seconds = time.perf_counter() - self.start
        yield "", "files", "bytes in", "bytes out", "of it", "files/s"
        for name in (DONE, BEFORE, SKIPPED, FAILED):
            size, made = self.source_bytes[name], self.target_bytes[name]
            if self.files[name] or name == DONE:
                yield (
                    name,
                    str(self.files[name]),
                    str(size) if size else "-",
                    str(made) if made else "-",
                    f"{100 * made / size:.2f} %" if made and size else "-",
                    f"{self.files[name] / seconds:.2f}" if name == DONE else "-",
                )


def _line(record: Record) -> str:
    """Return in a line what became of a file."""
    names = f"{shown(record['source'])} -> {shown(record['target'])}"
    if record["status"] != DONE:
        return f"{names}: {record['status']}"
    sizes = f"{record['source_bytes']} -> {record['target_bytes']} bytes"
    return f"{names}: {sizes}, {record['seconds']:.2f} s"


def tell_record(record: Record, *, as_json: bool) -> None:
    """Tell a record to programs, and a failure to people."""
    if record["status"] == FAILED:
        click.echo(record.get("traceback", ""), nl=False, err=True)
        click.echo(f"deltamesh: {record['message']}", err=True)
    if as_json:
        print_json(record)


@contextmanager
def progress(
    wanted: bool | None, sizes: list[int], *, verbose: bool, quiet: bool
) -> Iterator[Callable[[Record, int], None]]:
    """Give a function that is told each record of a file that was worked on, and the file's size.

    On a terminal a bar shows how much is done and how long the rest will take, by bytes of input;
    with `verbose`, and where there is no terminal and progress is wanted, each file has a line.
    """
    terminal = sys.stderr is not None and sys.stderr.isatty()
    if verbose or (wanted and not terminal):
        count = 0

        def tell(record: Record, size: int) -> None:
            nonlocal count
            count += 1
            click.echo(f"deltamesh: [{count}/{len(sizes)}] {_line(record)}", err=True)

        yield tell
    elif wanted or (wanted is None and terminal and not quiet):
        with _bar(sizes) as tell_bar:
            yield tell_bar
    else:
        yield lambda record, size: None


@contextmanager
def _bar(sizes: list[int]) -> Iterator[Callable[[Record, int], None]]:
    # Imported here: rich takes 0.1 s, and most runs have no terminal to draw on.
    from rich import progress as bars
    from rich.console import Console

    columns = (
        bars.BarColumn(),
        bars.TextColumn("{task.fields[count]}/{task.fields[files]} files"),
        bars.TaskProgressColumn(),
        bars.TimeElapsedColumn(),
        bars.TextColumn("left"),
        bars.TimeRemainingColumn(),
    )
    # Even a file of no bytes is some work.
    with bars.Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=sum(sizes) + len(sizes), count=0, files=len(sizes))
        done = 0

        def tell(record: Record, size: int) -> None:
            nonlocal done
            done += 1
            bar.update(task, advance=size + 1, count=done)

        yield tell
