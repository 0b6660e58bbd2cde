"""Decoding in the browser: CPU and memory of Chromium while the page decodes a file.

The page of `deltamesh view` is opened anew for each file, without one in it. Once it is at rest, it
decodes the file twice, in its worker: most of WebAssembly and JavaScript is compiled in the first
call. CPU seconds are those of all threads of the process that runs the page, those that compile
among them; memory is the most that it had resident. For Linux, with chromium and chromedriver.
"""

from __future__ import annotations

import base64
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import click
import corpus
import large

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

import browser

import deltamesh
from deltamesh._page.filling import page_of
from deltamesh_cli.output import table

_EXAMPLES = """\
python benchmarks/chromium.py
python benchmarks/chromium.py --runs 5 bunny turbineblade 1000000"""

MESHES = ("torus", "bunny", "turbineblade", "1000000")
TICKS = os.sysconf("SC_CLK_TCK")

# The bytes are there before the clock starts; what comes back is not kept.
GIVEN = "globalThis.given = Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0))"
BEGUN = """
globalThis.vertices = 0;
deltameshViewer.decode(given.slice()).then(({ mesh }) => (vertices = mesh.positions.length / 3));
"""

# Seconds after which a page that has been opened is at rest.
REST = 2.0

_HEADING = ("mesh", "vertices", "bytes", "page, CPU s", "first", "second", "MiB")


class Row(NamedTuple):
    """Measurement of a file: CPU seconds of the page and of both calls, and MiB resident."""

    vertices: int
    page: float
    first: float
    second: float
    memory: float


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("names", nargs=-1)
@click.option("--runs", default=3, show_default=True, help="Of which the best counts.")
def command(names: tuple[str, ...], runs: int) -> None:
    """Measure meshes by NAMES, or surfaces of so many vertices."""
    if browser.chromium() is None:
        raise click.UsageError("no chromium with chromedriver")
    rows = []
    for name in names or MESHES:
        if not name.isdigit() and not corpus.present([name]):
            continue
        mesh = large.surface(int(name)) if name.isdigit() else corpus.bare(name)
        data = deltamesh.encode(mesh.vertices, mesh.faces)
        found = [decoded(data) for _ in range(runs)]
        best = [min(column) for column in zip(*found, strict=True)]
        cells = (f"{best[0]:.0f}", str(len(data)), *(f"{one:.2f}" for one in best[1:4]))
        rows.append((name, *cells, f"{best[4]:.0f}"))
    click.echo(table([_HEADING, *rows]))


def decoded(data: bytes) -> Row:
    """Return what a new browser takes to decode a file."""
    with tempfile.TemporaryDirectory() as folder:
        page, profile = Path(folder, "page.html"), Path(folder, "profile")
        page.write_text(page_of([], "empty"), encoding="utf-8")
        with browser.started(profile) as one:
            one.open(page)
            one.run(GIVEN, base64.b64encode(data).decode())
            time.sleep(REST)
            times = [cpu_of(profile)]
            for _ in range(2):
                one.run(BEGUN)
                while not (vertices := one.run("return vertices")):
                    time.sleep(0.2)
                times.append(cpu_of(profile))
            first, second = times[1] - times[0], times[2] - times[1]
            return Row(vertices, times[0], first, second, most_memory_of(profile))


def renderers(profile: Path) -> Iterator[Path]:
    """Yield the folders in /proc of the processes of a browser that run pages."""
    for path in Path("/proc").glob("[0-9]*"):
        try:
            words = (path / "cmdline").read_bytes()
        except OSError:
            continue  # it has ended
        if b"--type=renderer" in words and os.fsencode(profile) in words:
            yield path


def cpu_of(profile: Path) -> float:
    """Return the CPU seconds of all threads that run pages of a browser so far."""
    found = [(path / "stat").read_text().rsplit(")", 1)[1].split() for path in renderers(profile)]
    assert found
    return sum(int(fields[11]) + int(fields[12]) for fields in found) / TICKS


def most_memory_of(profile: Path) -> float:
    """Return the most memory that a process that runs pages had resident, in MiB."""
    texts = [(path / "status").read_text() for path in renderers(profile)]
    lines = [line for text in texts for line in text.splitlines() if line.startswith("VmHWM:")]
    return max(int(line.split()[1]) for line in lines) / 1024


if __name__ == "__main__":
    command()
