"""Connectivity, the Laplacian and predictions: sections 1, 2 and 2.2 of the paper."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Model
from paper_tables import Row, Table, small

from deltamesh import differential as dc
from deltamesh._graph.parallelograms import parallelograms

# What is known of the shapes: handles.
_GENUS = {"torus": 1}


def _topology(m: Model) -> Iterator[Row]:
    V, E, F = len(m.V), len(m.edges), len(m.F)
    sides = np.sort(np.stack((m.F, np.roll(m.F, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    found, counts = np.unique(sides, axis=0, return_counts=True)
    rim = found[counts == 1]
    ends = np.unique(rim)
    border = dc.laplacian(np.searchsorted(ends, rim)[:, [0, 1, 1]], len(ends))
    loops = int(dc.components(border).max(initial=-1)) + 1
    genus = _GENUS.get(m.name, 0)
    yield (
        *(f"{one:,}" for one in (V, E, F)),
        *(str(one) for one in (genus, loops, V - E + F, 2 * (1 - genus) - loops)),
        *(f"{one:.2f}" for one in (F / V, E / V, 2 * E / V)),
    )


def _rank(m: Model) -> Iterator[Row]:
    values, _ = m.spectrum
    components = int(dc.components(m.L).max()) + 1
    rank = int((values > 1e-9).sum())
    least, most = values[values > 1e-9][[0, -1]]
    row = len(m.V), components, rank, f"{least:.2g}", f"{most:.1f}"
    yield tuple(f"{one:,}" if isinstance(one, int) else one for one in row)


def _recovery(m: Model) -> Iterator[Row]:
    """Positions from exact deltas and one anchor a component, and an anchor of another number."""
    labels = dc.components(m.L)
    first = np.unique(labels, return_index=True)[1]
    last = len(labels) - 1 - np.unique(labels[::-1], return_index=True)[1]
    for name, anchors in (("first", first), ("last", last)):
        x = dc.LeastSquares(m.L, anchors).solve(m.delta, m.V[anchors])
        yield f"{len(labels):,}", name, small(m.errors(x).max)


def _predictions(m: Model) -> Iterator[Row]:
    step = np.ptp(m.V, axis=0).max() / 4095
    grid = np.rint((m.V - m.V.min(axis=0)) / step)
    first, corners, _ = parallelograms(m.F, len(m.V))
    counts = np.diff(first)
    before = np.vstack((grid[:1], grid[:-1]))  # what predicts where no parallelogram does
    some = counts > 0
    each = grid[corners[:, 0]] + grid[corners[:, 1]] - grid[corners[:, 2]]
    one, mean = before.copy(), before.copy()
    one[some] = each[first[:-1][some]]
    owner = np.repeat(np.arange(len(m.V)), counts)
    sums = np.stack([np.bincount(owner, column, len(m.V)) for column in each.T], axis=1)
    mean[some] = np.rint(sums[some] / counts[some, None])
    centre = np.rint(m.delta / m.valences / step)
    scaled = np.rint(m.delta / step)
    yield tuple(f"{entropy(one):.2f}" for one in (grid - one, grid - mean, centre, scaled))


def entropy(values: Floats) -> float:
    """Return the sum of the order-0 entropies of the columns, in bits a row."""
    bits = 0.0
    for column in values.T:
        counts = np.unique(column, return_counts=True)[1]
        bits += float(np.log2(len(column)) - (counts * np.log2(counts)).sum() / len(column))
    return bits


_MODELS = ("horse", "bunny", "camelhead", "screwdriver", "fandisk")

TABLES = (
    Table(
        "predictions",
        ("mesh", "one parallelogram", "mean of all parallelograms", "Laplacian", "L x itself"),
        _predictions,
        ("torus",),
        _MODELS,
    ),
    Table(
        "topology",
        ("mesh", "V", "E", "F", "g", "b", "V - E + F", "2(1 - g) - b", "F/V", "E/V", "degree"),
        _topology,
        ("ball", "torus", "bar"),
        _MODELS,
    ),
    Table(
        "rank",
        ("mesh", "n", "components", "rank", "least eigenvalue above 0", "largest"),
        _rank,
        ("ball", "two balls"),
        ("torus",),
    ),
    Table(
        "recovery",
        ("mesh", "vertices", "anchors of the components", "largest error"),
        _recovery,
        ("ball", "two balls", "torus"),
        ("horse",),
    ),
)
