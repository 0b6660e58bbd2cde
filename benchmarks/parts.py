"""Scenes of parts of unlike size: what becomes of the worst part, and what it costs.

Each component and object is measured by its own diagonal after decoding. Beside it is Draco at the
least number of bits at which no part is worse than the quality allows.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click
import corpus
import decoded
import made_scenes
import pool

from deltamesh._mesh import TriangleMesh
from deltamesh._methods import METHODS
from deltamesh._options import DEFAULT_QUALITY, MAX_QUALITY
from deltamesh.bench import missing
from deltamesh.bench._peers import DRACO_MAX_BITS, draco_file, draco_positions
from deltamesh_cli.output import table
from deltamesh_formats.container.layout import STEPS
from deltamesh_formats.errors import DeltameshError
from deltamesh_formats.polymesh.mesh import PolyMesh

_EXAMPLES = """\
python benchmarks/parts.py
python benchmarks/parts.py --scene "20 balls" --quality 7 --method auto --uniform"""

CHOICES = ("auto", *(name for name, one in METHODS.items() if not one.layout.exact))


class Row(NamedTuple):
    """A scene under a codec.

    Attributes
    ----------
    scene, codec : str
    parts : int
    size : int
        Bytes of the file.
    steps : int
        Bytes of the section of steps by vertex; 0 without one.
    seconds : float
        CPU time of encoding.
    trials : int
        Geometries that were coded and decoded.
    normal, rms : float
        Of the worst part: degrees, and over its own diagonal.
    whole_normal, whole_rms : float
        Of the scene.
    lost, turned : int
        Triangles.
    """

    scene: str
    codec: str
    parts: int
    size: int
    steps: int
    seconds: float
    trials: int
    normal: float
    rms: float
    whole_normal: float
    whole_rms: float
    lost: int
    turned: int


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.option("--scene", "names", multiple=True, type=click.Choice(list(made_scenes.SCENES)))
@click.option("--method", "methods", multiple=True, type=click.Choice(CHOICES))
@click.option(
    "--quality",
    type=click.IntRange(1, MAX_QUALITY),
    default=DEFAULT_QUALITY,
    show_default=True,
    help="Of ours; Draco's bits are the least that keep it.",
)
@click.option("--uniform", is_flag=True, help="Ours again with the finest step for all parts, too.")
@click.option("--peer/--no-peer", default=True, help="Measure Draco, too (extra bench).")
@click.option(
    "--share",
    type=click.FloatRange(0, 1, min_open=True),
    default=1.0,
    show_default=True,
    help="Of the parts of the scenes.",
)
@click.option("--json", "file", type=click.Path(dir_okay=False, path_type=Path), help="Write all.")
@pool.jobs
def command(
    names: tuple[str, ...],
    methods: tuple[str, ...],
    quality: int,
    uniform: bool,
    peer: bool,
    share: float,
    file: Path | None,
    jobs: int,
) -> None:
    """Encode generated scenes, decode them, and measure each part by its own size.

    Exits with 1 if a part is worse than the quality allows.
    """
    if peer and (absent := missing("draco")):
        raise click.ClickException(f"{absent[0]} is missing: pip install '.[bench]', or --no-peer")
    start = time.perf_counter()
    tasks = [
        (name, methods or CHOICES, quality, uniform, peer, share)
        for name in names or made_scenes.SCENES
    ]
    rows = [row for found in pool.each(measured, tasks, jobs) for row in found]
    click.echo(table(_cells(rows)))
    click.echo(f"{time.perf_counter() - start:.0f} s", err=True)
    if file is not None:
        file.write_text(json.dumps([row._asdict() for row in rows], indent=1) + "\n")
    bound = 1 + 1e-6  # errors are recorded in binary32, and rounded up
    if any(badness(row, quality) > bound for row in rows):
        raise click.exceptions.Exit(1)


def measured(task: tuple[str, Sequence[str], int, bool, bool, float]) -> list[Row]:
    """Return the rows of a scene: ours by each method, and Draco's."""
    name, methods, quality, uniform, peer, share = task
    mesh = made_scenes.scene(name, share)
    rows = []
    for method in methods:
        one = _found(mesh, method=method, quality=quality)
        if one is None:
            continue
        rows.append(_row(name, method, one))
        if uniform and rows[-1].steps:
            alike = _found(mesh, **_finest(one))
            rows += [] if alike is None else [_row(name, f"{method}, finest", alike)]
    return [*rows, *([] if not peer else _draco(name, mesh, quality))]


def badness(row: Row, quality: int) -> float:
    """Return the larger error of the worst part over its bound."""
    part = decoded.PartError(row.rms, 0, row.normal, 0)
    return decoded.badness(part) * 2 ** ((quality - DEFAULT_QUALITY) / 2)


def _found(mesh: PolyMesh, **options: Any) -> decoded.Found | None:
    try:
        return decoded.found(mesh, **options)
    except DeltameshError as error:
        click.echo(f"no file with {options}: {error}", err=True)
        return None


def _finest(one: decoded.Found) -> dict[str, Any]:
    """Return options that give all vertices the finest step of a file."""
    chosen = one.encoded.draft.chosen.settings
    step = chosen.step * 2 ** (-max(chosen.exponents) / 4) if chosen.step else None
    options = {"method": chosen.method, "step": step, "anchors": chosen.anchors}
    if chosen.layout.coarse:
        options["coarse"] = chosen.coarse
    return options if chosen.layout.anchored else {k: options[k] for k in ("method", "step")}


def _row(scene: str, codec: str, one: decoded.Found) -> Row:
    steps = one.encoded.container.sections.get(STEPS)
    method = one.encoded.container.parameters.method
    return Row(
        scene,
        codec if codec.startswith(method) else f"{codec}: {method}",
        max(len(one.parts), 1),
        one.size,
        steps.size if steps else 0,
        one.seconds,
        one.trials,
        one.largest.normal,
        one.largest.rms,
        one.whole.normal,
        one.whole.rms,
        one.lost,
        one.turned,
    )


def _draco(scene: str, mesh: PolyMesh, quality: int) -> list[Row]:
    """Return Draco's row at the least number of bits at which every part keeps a quality."""
    low, high, kept = 1, DRACO_MAX_BITS, None
    while low <= high:
        bits = (low + high) // 2
        row = _draco_row(scene, mesh, bits)
        if badness(row, quality) <= 1:
            kept, high = bits, bits - 1
        else:
            low = bits + 1
    if kept is None:
        click.echo(f"no bits of Draco keep every part of {scene}", err=True)
        return []
    triangles = TriangleMesh(mesh.vertices, mesh.triangles)
    start = time.process_time()
    size = len(draco_file(triangles, kept))
    seconds = time.process_time() - start
    return [_draco_row(scene, mesh, kept)._replace(size=size, seconds=seconds)]


def _draco_row(scene: str, mesh: PolyMesh, bits: int) -> Row:
    """Return the errors of Draco's positions, without a size."""
    whole, parts, lost, turned = decoded.errors_of(mesh, draco_positions(mesh.vertices, bits))
    largest = decoded.largest_of(parts or [whole])
    normal, rms = largest.normal, largest.rms
    codec, count = f"draco bits={bits}", max(len(parts), 1)
    return Row(
        scene, codec, count, 0, 0, 0.0, 1, normal, rms, whole.normal, whole.rms, lost, turned
    )


_HEADING = (
    "scene",
    "parts",
    "codec",
    "bytes",
    "STEP",
    "CPU s",
    "trials",
    "worst part's normal",
    "RMS",
    "whole normal",
    "RMS",
    "lost",
    "turned",
)


def _cells(rows: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    yield _HEADING
    for row in rows:
        yield (
            row.scene,
            str(row.parts),
            row.codec,
            str(row.size),
            str(row.steps),
            f"{row.seconds:.1f}",
            str(row.trials),
            f"{row.normal:.3f}",
            f"{row.rms:.2e}",
            f"{row.whole_normal:.3f}",
            f"{row.whole_rms:.2e}",
            str(row.lost),
            str(row.turned),
        )


if __name__ == "__main__":
    command()
