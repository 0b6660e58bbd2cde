"""Reports of `deltamesh batch`: each failure, progress, and a table at the end."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final, TypeAlias

from deltamesh.batch import DONE, FAILED, SKIPPED, Record
from deltamesh_cli.failures import DONE as SUCCESS
from deltamesh_cli.output import display_name, duration, message, number, print_json, table
from deltamesh_cli.progress import messages_above, use_drawing, use_lines

# Called with each record of a file that was worked on, and the size of that file in bytes.
Advance: TypeAlias = Callable[[Record, int], None]

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
        Numbers by the status of the files.
    codes : Counter
        Number of failed files by exit code.
    worst : dict
        The largest error of each kind, and the file that has it.
    losing : dict
        What is not kept, of each file of which something is not.
    """

    files: Counter[str] = field(default_factory=Counter)
    source_bytes: Counter[str] = field(default_factory=Counter)
    target_bytes: Counter[str] = field(default_factory=Counter)
    codes: Counter[int] = field(default_factory=Counter)
    worst: dict[str, tuple[float, str]] = field(default_factory=dict)
    losing: dict[str, list[str]] = field(default_factory=dict)
    start: float = field(default_factory=time.perf_counter)

    def add(self, record: Record, before: bool) -> None:
        """Count a record; `before` says whether an earlier run made it."""
        status = BEFORE if before else record["status"]
        self.files[status] += 1
        self.source_bytes[status] += record.get("source_bytes") or 0
        self.target_bytes[status] += record.get("target_bytes") or 0
        if record["status"] == FAILED:
            self.codes[record["exit_code"]] += 1
        if record.get("not_kept"):
            self.losing[record["source"]] = record["not_kept"]
        for name in _ERRORS:
            value = (record.get("errors") or {}).get(name)
            if value is not None and value > self.worst.get(name, (-1.0, ""))[0]:
                self.worst[name] = value, record["source"]

    @property
    def count(self) -> int:
        """The number of files."""
        return sum(self.files.values())

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
                (_ERRORS[name], number(value), display_name(file))
                for name, (value, file) in self.worst.items()
            ]
            blocks.append(table([("worst", "", "file"), *rows]))
        if self.losing:
            file, (first, *_) = next(iter(self.losing.items()))
            example = f"{display_name(first)} of {display_name(file)}"
            blocks.append(f"not kept is something of {len(self.losing)} files, such as {example}")
        return "\n\n".join(blocks)

    def _rows(self) -> Iterator[tuple[str, ...]]:
        seconds = time.perf_counter() - self.start
        yield "", "files", "bytes in", "bytes out", "out/in", "files/s"
        for name in (DONE, BEFORE, SKIPPED, FAILED):
            size, made = self.source_bytes[name], self.target_bytes[name]
            if self.files[name] or name == DONE:
                yield (
                    name,
                    str(self.files[name]),
                    str(size) if size else "-",
                    str(made) if made else "-",
                    _ratio(made, size) if made and size else "-",
                    f"{self.files[name] / seconds:.2f}" if name == DONE else "-",
                )


def _ratio(made: int, size: int) -> str:
    """Return the size of outputs over that of inputs: in percent or, of what grows, how often."""
    return f"{100 * made / size:.2f} %" if made < size else f"{made / size:.1f} times"


def names_of(record: Record) -> str:
    """Return the input and the output of a record for a message."""
    return f"{display_name(record['source'])} -> {display_name(record['target'])}"


def _line(record: Record) -> str:
    """Return a record in one line."""
    if record["status"] != DONE:
        return f"{names_of(record)}: {record['status']}"
    sizes = f"{record['source_bytes']} -> {record['target_bytes']} bytes"
    return f"{names_of(record)}: {sizes}, {record['seconds']:.2f} s"


def report_record(record: Record, *, as_json: bool, quiet: bool = False) -> None:
    """Report a failure on standard error and, with `as_json`, any record on standard output.

    A file without a surface is skipped, with a message, too. Unless `quiet` is set, what a user
    should know of a file that is done is a note.
    """
    if "message" in record:
        message(f"{record.get('traceback', '')}deltamesh: {record['message']}")
    for note in () if quiet else record.get("notes", ()):
        message(f"note: {note}")
    if as_json:
        print_json(record)


@contextmanager
def displayed_files(
    show: bool | None, sizes: list[int], *, verbose: bool, quiet: bool
) -> Iterator[Advance]:
    """Yield a function that takes each record of a file that was worked on, and displays it.

    A bar on a terminal shows the part that is done and the time that is left, by bytes of input.
    With `verbose`, or if progress is requested without a terminal, each file has a line.
    """
    if use_lines(show, verbose=verbose):
        count = 0

        def print_line(record: Record, size: int) -> None:
            nonlocal count
            count += 1
            message(f"deltamesh: [{count}/{len(sizes)}] {_line(record)}")

        yield print_line
    elif use_drawing(show, quiet=quiet):
        with _bar(sizes) as advance:
            yield advance
    else:
        yield lambda record, size: None


def times(elapsed: float, remaining: float | None) -> str:
    """Return the seconds that have passed and, if they are known, those that are left, in words."""
    left = "" if remaining is None else f", {duration(remaining)} left"
    return f"{duration(elapsed)} elapsed{left}"


@contextmanager
def _bar(sizes: list[int]) -> Iterator[Advance]:
    # Imported here: rich takes 0.1 s, and most runs have no terminal to draw on.
    from rich import progress as bars
    from rich.console import Console
    from rich.text import Text

    class Times(bars.ProgressColumn):
        def render(self, task: bars.Task) -> Text:
            return Text(times(task.elapsed or 0.0, None if task.finished else task.time_remaining))

    columns = (
        bars.BarColumn(),
        bars.TextColumn("{task.fields[count]}/{task.fields[files]} files"),
        bars.TaskProgressColumn(),
        Times(),
    )
    console = Console(stderr=True)
    # Even an empty file is some work, so each counts one byte more.
    with bars.Progress(*columns, console=console) as bar, messages_above(console):
        task = bar.add_task("", total=sum(sizes) + len(sizes), count=0, files=len(sizes))
        done = 0

        def advance(record: Record, size: int) -> None:
            nonlocal done
            done += 1
            bar.update(task, advance=size + 1, count=done)

        yield advance
