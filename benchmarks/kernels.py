"""Milliseconds of the kernels, each on one mesh, in both directions where it has two.

The functions that are timed take and return arrays and bytes; what they do beside the call of a
kernel is next to nothing. CPU time, the best of some runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import click
import corpus
import numpy as np

from deltamesh._geometry.quantize import Rounding, quantize_delta
from deltamesh._graph.adjacency import adjacency, components
from deltamesh._graph.elements import Elements
from deltamesh._graph.parallelograms import NO_QUADS, parallelograms
from deltamesh._kernels.coding import residual, stitching
from deltamesh._kernels.coding.delta import code_deltas, code_refinements
from deltamesh._kernels.mesh import cutting, distance, laplacian
from deltamesh._measures.hausdorff import squared_hausdorff
from deltamesh._order.coding import decode_order, encode_order
from deltamesh._order.reordering import Order
from deltamesh._shape.connectivity import decode_connectivity, encode_connectivity
from deltamesh._shape.polygons import plain
from deltamesh._shape.topology import build_topology
from deltamesh._streams.columns import decode_three, encode_three
from deltamesh._streams.entropy import decode_with, encode_with
from deltamesh._streams.floats import bits_of, decode_floats, encode_floats
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.permutations import numbered

Timed = tuple[str, Callable[[], object]]


def mesh_of(size: int) -> tuple[Floats, Ints]:
    """Return a bumpy torus of size^2 vertices, in an order of its own, closed and oriented."""
    i, j = np.divmod(np.arange(size * size), size)
    u, v = 2 * np.pi * i / size, 2 * np.pi * j / size
    r = (
        1
        + 0.1 * np.sin(9 * u) * np.cos(7 * v)
        + 0.002 * np.random.default_rng(1).normal(size=u.shape)
    )
    V = np.stack(((3 + r * np.cos(v)) * np.cos(u), (3 + r * np.cos(v)) * np.sin(u), r * np.sin(v)))
    right, down = i * size + (j + 1) % size, (i + 1) % size * size + j
    both = (i + 1) % size * size + (j + 1) % size
    here = i * size + j
    F = np.concatenate((np.stack((here, down, both), 1), np.stack((here, both, right), 1)))
    return np.ascontiguousarray(V.T), F


def kernels(V: Floats, F: Ints) -> Iterator[Timed]:
    """Yield the name of each kernel and what runs it."""
    opposite = _opposites(F)
    topology = build_topology(F, opposite, len(V))
    payload, coded = encode_connectivity(topology)
    view, n, m = memoryview(payload), len(coded.order), len(F)
    yield "connectivity, encode", lambda: encode_connectivity(topology)
    yield "connectivity, decode", lambda: decode_connectivity(view, n, m)

    V, F = V[coded.order], coded.manifold.faces
    graph, opposite = adjacency(F, n), coded.manifold.opposite
    extent = float(np.ptp(V, axis=0).max())
    delta = laplacian.apply(*graph, V)
    step = float(np.abs(delta).max()) / 16
    diffused = Rounding(tangential=1.0)
    yield "diffusion", lambda: quantize_delta(delta, graph, step, diffused)
    values = quantize_delta(delta, graph, step, diffused)
    stream = encode_with(residual.MODEL, n, lambda c: code_deltas(c, *graph, values.copy()))
    yield (
        "deltas, encode",
        lambda: encode_with(residual.MODEL, n, lambda c: code_deltas(c, *graph, values.copy())),
    )
    yield (
        "deltas, decode",
        lambda: decode_with(
            residual.MODEL, stream, lambda c: code_deltas(c, *graph, np.zeros_like(values))
        ),
    )
    fine = np.ascontiguousarray(values[:, :1])
    yield (
        "refinements, encode",
        lambda: encode_with(
            residual.MODEL, n, lambda c: code_refinements(c, *graph, values, fine.copy())
        ),
    )

    elements = Elements(n, *graph, *parallelograms(F, n, NO_QUADS, opposite))
    grid = np.rint((V - V.min(axis=0)) / extent * 4095).astype(np.int64)
    three = encode_three(elements, grid)
    yield "positions, encode", lambda: encode_three(elements, grid)
    yield "positions, decode", lambda: decode_three(three, elements)
    bits = bits_of(V.astype(np.float32).astype(np.float64))
    (exact,) = encode_floats(elements, bits, 8)
    both = [(0, len(exact))]
    yield "exact numbers, encode", lambda: encode_floats(elements, bits, 8)
    yield (
        "exact numbers, decode",
        lambda: decode_floats(memoryview(exact), both, elements, 3, 8),
    )

    labels = numbered((np.arctan2(V[:, 1], V[:, 0]) * 4).astype(np.int64))[0]
    labelled = encode_labels(elements, labels)
    yield "labels, encode", lambda: encode_labels(elements, labels)
    yield "labels, decode", lambda: decode_labels(labelled, elements)

    rng = np.random.default_rng(2)
    order = Order(_nearly(n, rng), _nearly(m, rng), rng.integers(0, 3, m))
    ordered = encode_order(F, plain(m), order)
    yield "order, encode (14 trials)", lambda: encode_order(F, plain(m), order)
    yield "order, decode", lambda: decode_order(memoryview(ordered), F, plain(m), n)

    boundary, none = np.zeros(n, dtype=bool), np.arange(n)
    yield (
        "stitches, encode",
        lambda: encode_with(
            stitching.MODEL, n, lambda c: stitching.code_stitches(c, *graph, boundary, none.copy())
        ),
    )
    label = np.empty(3 * m, dtype=np.int64)
    yield "fans", lambda: cutting.label_fans(opposite, label)
    anchors = np.empty(n // 1000 + 1, dtype=np.int64)
    first = np.unique(components(*graph), return_index=True)[1]
    yield "farthest points", lambda: distance.farthest_points(*graph, first, anchors)
    moved = V + 1e-3 * rng.normal(size=V.shape)
    some = rng.permutation(m)[:4000]
    yield "Hausdorff, 4000 faces", lambda: squared_hausdorff(V[F[some]], moved[F[some]])


def _nearly(n: int, rng: np.random.Generator) -> Ints:
    """Return an order that is one of two interleaved runs, with some exchanges."""
    order = np.concatenate((np.arange(0, n, 2), np.arange(1, n, 2)))
    a, b = rng.integers(0, n, (2, n // 20))
    order[a], order[b] = order[b].copy(), order[a].copy()
    return numbered(order)[0].argsort() if len(np.unique(order)) < n else order


def _opposites(F: Ints) -> Ints:
    from deltamesh._graph.halfedges import pair_halfedges

    return pair_halfedges(F)


@click.command(epilog=corpus.epilog("python benchmarks/kernels.py --size 300"))
@click.option(
    "--size", type=click.IntRange(10), default=200, show_default=True, help="Root of the vertices."
)
@click.option(
    "--runs", type=click.IntRange(1), default=5, show_default=True, help="Runs of each kernel."
)
def command(size: int, runs: int) -> None:
    """Print milliseconds of CPU time of each kernel on a torus of size^2 vertices."""
    for name, run in kernels(*mesh_of(size)):
        run()
        best = min(_seconds(run) for _ in range(runs))
        click.echo(f"{name:28} {1e3 * best:10.2f}")


def _seconds(run: Callable[[], object]) -> float:
    start = time.process_time()
    run()
    return time.process_time() - start


if __name__ == "__main__":
    command()
