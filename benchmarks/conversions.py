"""Bytes that conversions save: exact positions of meshes that programs changed after reading them.

Decimals of a mesh are converted as programs convert them, and coded to the last bit with and
without the search of a conversion. The bits are those of a coordinate; "decimals" are those of the
decimals before. CPU seconds are those of both choices and of the coding.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
import corpus
import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements, of_vertices
from deltamesh._streams import column_choice
from deltamesh._streams.column_choice import choose_columns, numbers_of
from deltamesh._streams.exact import DOUBLE, SINGLE, encode_numbers, pack_formats
from deltamesh._streams.number_formats import from_indices, raw_bits
from deltamesh_cli.output import table

Values = NDArray[np.float64]

_EXAMPLES = """\
python benchmarks/conversions.py
python benchmarks/conversions.py fandisk.obj --places 5"""

_HEADING = ("conversion", "type", "without", "with", "decimals", "CPU without", "CPU with")
_PLACES = 3


def as_single(x: Any) -> Any:
    """Return numbers rounded to float32, as float64."""
    return np.asarray(x, dtype=np.float32).astype(np.float64)


def dequantized(x: Values, bits: int, single: bool) -> Values:
    """Return values on a grid of a number of bits, multiplied by a step and moved."""
    low, extent = x.min(axis=0), np.ptp(x, axis=0).max()
    k = np.rint((x - low) / extent * (2**bits - 1))
    step, origin = extent / (2**bits - 1), low + 0.1
    if single:
        return np.asarray(as_single(as_single(k * as_single(step)) + as_single(origin)))
    return np.asarray(k * step + origin)


def in_unit_box(x: Values, rounded: Callable[[Any], Any] = np.asarray) -> Values:
    """Return values less their mean, divided by their largest extent."""
    moved = rounded(x - rounded(x.mean(axis=0)))
    return np.asarray(rounded(moved * rounded(1 / np.ptp(x, axis=0).max())))


def off(x: Values, share: float) -> Values:
    """Return values of which some are moved to anywhere near."""
    rng = np.random.default_rng(1)
    moved = x + rng.normal(size=x.shape) * np.abs(x).mean() / 100
    some = rng.random(len(x)) < share
    return np.asarray(as_single(np.where(some.reshape(-1, *[1] * (x.ndim - 1)), moved, x)))


# Whether values are float32, and how they are made of decimals of their type. The last ones have
# deviations: a value that is none of a conversion of two operations.
KINDS: dict[str, tuple[bool, Callable[[Values], Values]]] = {
    "- mean": (True, lambda d: as_single(d - as_single(d.mean(axis=0)))),
    "- 12.748": (True, lambda d: as_single(d - as_single(12.748))),
    "* 0.001": (True, lambda d: as_single(d * as_single(0.001))),
    "* 25.4": (True, lambda d: as_single(d * as_single(25.4))),
    "* 0.3048 in float64": (True, lambda d: as_single(d * 0.3048)),
    "/ 1000": (True, lambda d: as_single(d / 1000)),
    "- mean, float64": (False, lambda d: d - d.mean(axis=0)),
    "* 0.001, float64": (False, lambda d: d * 0.001),
    "* 25.4, float64": (False, lambda d: d * 25.4),
    "* 0.0254, float64": (False, lambda d: d * 0.0254),
    "/ 1000, float64": (False, lambda d: d / 1000),
    "* 0.3048, float64": (False, lambda d: d * 0.3048),
    "10 bits": (True, lambda d: dequantized(d, 10, single=True)),
    "12 bits": (True, lambda d: dequantized(d, 12, single=True)),
    "14 bits": (True, lambda d: dequantized(d, 14, single=True)),
    "16 bits": (True, lambda d: dequantized(d, 16, single=True)),
    "12 bits in float64": (True, lambda d: as_single(dequantized(d, 12, single=False))),
    "14 bits, float64": (False, lambda d: dequantized(d, 14, single=False)),
}
DEVIATING: dict[str, tuple[bool, Callable[[Values], Values]]] = {
    "unit box in float64": (True, lambda d: as_single(in_unit_box(d))),
    "unit box": (True, lambda d: in_unit_box(d, as_single)),
    "unit box, float64": (False, in_unit_box),
    "* 25.4, 1 % moved": (True, lambda d: off(as_single(d * as_single(25.4)), 0.01)),
}


def of_columns(d: Values) -> dict[str, tuple[bool, Values]]:
    """Return whether values are float32, and these, of meshes that are not all converted."""
    one = as_single(np.stack([25.4 * d[:, 0], np.sin(d[:, 1]), np.cos(d[:, 2])], axis=1))
    flat = as_single(np.stack([25.4 * d[:, 0], 25.4 * d[:, 1], 0 * d[:, 2] + 0.1], axis=1))
    return {"* 25.4, x alone": (True, one), "* 25.4, z constant": (True, flat)}


@click.command(epilog=corpus.epilog(_EXAMPLES))
@click.argument("file", required=False, type=click.Path(exists=True, path_type=Path))
@click.option("--places", default=_PLACES, show_default=True, help="Places of the decimals.")
def command(file: Path | None, places: int) -> None:
    """Print the bits of a coordinate, of FILE or of the mesh of the repository in millimetres.

    Exits with 1 if a mesh takes more bytes with the search of conversions.
    """
    mesh = corpus.load(corpus.GENERATED) if file is None else corpus.read(file)
    mesh = corpus.as_polymesh(mesh).triangulation() if file else mesh
    V = mesh.vertices if file else 40 * mesh.vertices
    rows = list(measured(of_vertices(mesh.faces, len(V)), V.round(places)))
    click.echo(table([_HEADING, *rows]))
    larger = [row[0] for row in rows if float(row[3]) > float(row[2])]
    if larger:
        raise click.ClickException(f"larger with a conversion: {', '.join(larger)}")


def measured(elements: Elements, decimals: Values) -> list[tuple[str, ...]]:
    """Return a row for each kind of conversion."""
    made = {
        name: (single, function(as_single(decimals) if single else decimals))
        for name, (single, function) in (KINDS | DEVIATING).items()
    }
    made |= of_columns(decimals)
    before = [
        coded(elements, as_single(decimals) if single else decimals, single)[0]
        for single in (False, True)
    ]
    rows = []
    for name, (single, V) in made.items():
        found = coded(elements, V, single)
        with_none = without(elements, V, single)
        bits = (with_none[0], found[0], before[single])
        times = (f"{1e3 * one[1]:.0f} ms" for one in (with_none, found))
        kind = "float32" if single else "float64"
        rows.append((name, kind, *(f"{8 * size / V.size:.2f}" for size in bits), *times))
    return rows


def coded(elements: Elements, V: Values, single: bool) -> tuple[int, float]:
    """Return the bytes of exact values (n, 3), and the CPU seconds that these took."""
    width, usable, raw = SINGLE if single else DOUBLE, np.ones(V.shape, bool), raw_bits(V, single)
    begin = time.process_time()
    columns = choose_columns(elements, V, usable, raw, single)
    numbers = numbers_of(V, usable, raw, columns, single)
    size = len(pack_formats(width, columns) + encode_numbers(elements, width, columns, *numbers))
    seconds = time.process_time() - begin
    for a, column in enumerate(columns):
        found = from_indices(*(one[:, a] for one in numbers), column, single)
        if found.tobytes() != V[:, a].tobytes():
            raise click.ClickException("values do not come back as they were")
    return size, seconds


def without(elements: Elements, V: Values, single: bool) -> tuple[int, float]:
    """Return what `coded` returns, without the search of conversions."""
    search = column_choice.choose_conversion
    column_choice.choose_conversion = lambda values, errors, single, cost, plain: (cost, plain)
    try:
        return coded(elements, V, single)
    finally:
        column_choice.choose_conversion = search


if __name__ == "__main__":
    command()
