"""Least-squares meshes and few bits: figures 3 to 6 and smoothing (section 5) of the paper."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from paper_models import Floats, Ints, Model, source
from paper_tables import Row, Table, small

from deltamesh import bench
from deltamesh import differential as dc

Bools = NDArray[np.bool_]

_BITS = 7
# Shares of anchors of least-squares meshes, and of the low-frequency error around a hole.
_SHARES = (0.005, 0.01, 0.02, 0.05)
_ELSEWHERE = 0.002
# Where the hole of figure 4 begins, as a share of the most edges from the border; rings around it.
_HOLE, _RINGS = 0.25, 2
# Greedy anchors within the hole, "a few numbers more".
_INSIDE = 10
_STEPS = 1000
_DETAILS = (0.0, 0.5, 1.0, 2.0)


def _cartesian(m: Model) -> Iterator[Row]:
    bits = {"bunny": (5, 11)}.get(m.name, (8, 8))
    for label in (f"highpass bits={bits[0]}", f"cartesian bits={bits[1]}"):
        found = bench.measure(m.name, source(m.name), bench.codec_of(label))
        yield (
            f"{len(m.V):,}",
            label.replace(" bits=", ", ") + " bits",
            f"{found.bytes:,}",
            f"{found.normal_deg:.2f}",
            small(found.rms),
        )


def few_bits(m: Model, diffusion: float) -> tuple[int, Floats]:
    """Return the bytes of connectivity and deltas of figure 3, and the positions."""
    step, anchors = dc.step_of(m.delta, _BITS), dc.farthest_anchors(m.L, round(0.01 * len(m.V)))
    integers = dc.quantized_deltas(m.L, m.delta, step, diffusion)
    x = dc.LeastSquares(m.L, anchors).solve(integers * step, m.V[anchors])
    return m.connectivity + dc.coded_size(m.L, integers), x


def _few_bits(m: Model) -> Iterator[Row]:
    for name, diffusion in (("plain", 0.0), ("diffused", 1.0)):
        size, x = few_bits(m, diffusion)
        error = x - m.V
        means = error - m.L @ error / m.valences
        smoothness = np.linalg.norm(means) / np.linalg.norm(error)
        found = m.errors(x)
        cells = f"{found.normal_deviation:.2f}", small(found.rms), f"{smoothness:.2f}"
        yield name, f"{size:,}", *cells


def rim(m: Model) -> Ints:
    """Return the vertices on boundary loops."""
    sides = np.sort(np.stack((m.F, np.roll(m.F, -1, axis=1)), axis=2).reshape(-1, 2), axis=1)
    found, counts = np.unique(sides, axis=0, return_counts=True)
    return np.unique(found[counts == 1])


def hole(m: Model) -> tuple[Bools, dict[str, tuple[Ints, Floats]], int, int]:
    """Return the vertices without bits of figure 4, which are all but those near the border.

    Also anchors and positions, by where there are anchors; and bytes, with the connectivity, of the
    deltas of the others, and of all.
    """
    depth = m.hops(rim(m))
    inside = depth > _HOLE * depth.max()
    around = np.flatnonzero(~inside & (m.hops(np.flatnonzero(inside)) <= _RINGS))
    far = dc.farthest_anchors(m.L, round(_ELSEWHERE * len(m.V)))
    far = far[~inside[far]]
    steps = np.where(inside, 1e9 * m.diagonal, m.diagonal / _STEPS)
    integers = dc.quantized_deltas(m.L, np.where(inside[:, None], 0, m.delta), steps)
    integers[inside] = 0
    whole = dc.quantized_deltas(m.L, m.delta, m.diagonal / _STEPS)
    delta = integers * np.where(inside, 0, steps)[:, None]
    few, found = np.union1d(around, far), {}
    for _ in range(_INSIDE):
        x = dc.LeastSquares(m.L, few).solve(delta, m.V[few])
        found.setdefault("around it", (few, x))
        few = np.append(few, np.argmax(np.linalg.norm(x - m.V, axis=1)))
    x = dc.LeastSquares(m.L, few).solve(delta, m.V[few])
    found[f"and {_INSIDE} greedy ones within"] = few, x
    found["none around it"] = far, dc.LeastSquares(m.L, far).solve(delta, m.V[far])
    sizes = (m.connectivity + dc.coded_size(m.L, one) for one in (integers, whole))
    return inside, found, *sizes


def _hole(m: Model) -> Iterator[Row]:
    inside, found, size, whole = hole(m)
    faces = m.F[inside[m.F].all(axis=1)]
    for name, (_, x) in found.items():
        distance = np.linalg.norm(x - m.V, axis=1)[inside] / m.diagonal
        kept = f"{100 * area(x, faces) / area(m.V, faces):.0f} %"
        rms = small(float(np.sqrt((distance**2).mean())))
        yield f"{inside.sum():,}", f"{size:,} of {whole:,}", name, kept, rms


def area(V: Floats, F: Ints) -> float:
    """Return twice the area of triangles."""
    a, b, c = V[F.T]
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def _smooth(m: Model) -> Iterator[Row]:
    zero = np.zeros_like(m.V)
    for part in _SHARES:
        k = round(part * len(m.V))
        cells = []
        for anchors in (dc.farthest_anchors(m.L, k), dc.greedy_anchors(m.L, m.V, k)):
            system = dc.LeastSquares(m.L, anchors)
            positions = m.V[anchors], dc.fitted_positions(system, zero, m.V)
            found = [m.errors(system.solve(zero, one)) for one in positions]
            cells += [small(one.rms) for one in found] + [small(found[0].max)]
        yield f"{k} ({100 * part:g} %)", *cells


def selected(m: Model, k: int) -> dict[str, tuple[Ints, Floats]]:
    """Return anchors by each method, and the least-squares meshes that they make."""
    zero, found = np.zeros_like(m.V), {}
    for name, anchors in (
        ("random", dc.random_anchors(m.L, k)),
        ("farthest", dc.farthest_anchors(m.L, k)),
        ("greedy", dc.greedy_anchors(m.L, m.V, k)),
    ):
        found[name] = anchors, dc.LeastSquares(m.L, anchors).solve(zero, m.V[anchors])
    return found


# Vertices an anchor: 1000 on the screwdriver of figure 6.
SPACING = 27.15


def _selection(m: Model) -> Iterator[Row]:
    k = round(len(m.V) / SPACING)
    for name, (_, x) in selected(m, k).items():
        found = m.errors(x)
        yield f"{len(m.V):,}", f"{k:,}", name, small(found.rms), small(found.max)


def _detail(m: Model) -> Iterator[Row]:
    anchors = dc.farthest_anchors(m.L, round(0.01 * len(m.V)))
    system = dc.LeastSquares(m.L, anchors)
    for detail in _DETAILS:
        found = m.errors(system.solve(detail * m.delta, m.V[anchors]))
        yield f"{detail:g}", f"{found.normal_deviation:.1f}", small(found.rms)


TABLES = (
    Table(
        "cartesian",
        ("mesh", "vertices", "quantized", "bytes", "normals", "RMS"),
        _cartesian,
        ("coarse sphere",),
        ("fine sphere", "bunny"),
    ),
    Table(
        "few-bits",
        ("mesh", "rounding", "bytes", "normals", "RMS", "smoothness of the error"),
        _few_bits,
        ("torus",),
        ("horse",),
    ),
    Table(
        "hole",
        ("mesh", "vertices without bits", "bytes", "anchors", "area kept", "RMS within"),
        _hole,
        ("bar",),
        ("camelhead",),
    ),
    Table(
        "smooth",
        (
            "mesh",
            "anchors",
            "farthest: RMS",
            "fitted",
            "max, copied",
            "greedy: RMS",
            "fitted",
            "max, copied",
        ),
        _smooth,
        ("torus",),
        ("camelhead",),
    ),
    Table(
        "selection",
        ("mesh", "vertices", "anchors", "chosen", "RMS", "max"),
        _selection,
        ("torus",),
        ("screwdriver x 4",),
    ),
    Table("detail", ("mesh", "detail", "normals", "RMS"), _detail, ("torus",), ("bunny",)),
)
