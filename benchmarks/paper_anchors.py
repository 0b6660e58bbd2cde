"""Anchors: how many, of which weight, and rows that are erased; section 3.1 of the paper."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Ints, Model
from paper_tables import Row, Table, small

from deltamesh import differential as dc

# Steps of the deltas in the diagonal.
STEPS = 1000
_SHARES = (0.001, 0.01)
_WEIGHTS = (0.1, 1.0, 10.0, 100.0, math.inf)


def _counts(m: Model) -> Iterator[Row]:
    step = m.diagonal / STEPS
    plain, diffused = (m.quantized(step, diffusion) for diffusion in (0.0, 1.0))
    for k in sorted({1, 10, *(round(part * len(m.V)) for part in _SHARES)}):
        anchors = dc.farthest_anchors(m.L, k)
        system = dc.LeastSquares(m.L, anchors)
        cells = []
        for delta in (plain, diffused):
            found = m.errors(system.solve(delta, m.V[anchors]))
            cells += [small(found.rms), f"{found.normal_deviation:.2f}"]
        yield f"{len(anchors)} ({100 * k / len(m.V):.1f} %)", *cells


def erased(m: Model, bits: int) -> tuple[Ints, dict[str, Floats]]:
    """Return 1 % of anchors, and positions where they are added and where they replace rows."""
    step, anchors = dc.step_of(m.delta, bits), dc.farthest_anchors(m.L, len(m.V) // 100)
    delta = m.quantized(step, 0.0)
    systems = {"added": dc.LeastSquares(m.L, anchors), "erased": dc.Poisson(m.L, anchors)}
    return anchors, {name: one.solve(delta, m.V[anchors]) for name, one in systems.items()}


def _rows(m: Model) -> Iterator[Row]:
    for bits in (7, 6):
        anchors, found = erased(m, bits)
        step = dc.step_of(m.delta, bits)
        for name, x in found.items():
            off = np.linalg.norm(dc.deltas(m.L, x) - m.delta, axis=1) / step
            at, elsewhere = off[anchors], np.delete(off, anchors)
            rms = (f"{math.sqrt((one * one).mean()):.2f}" for one in (at, elsewhere))
            errors = m.errors(x)
            yield (
                f"{bits}",
                name,
                *rms,
                f"{errors.normal_deviation:.2f}",
                small(errors.rms),
                small(errors.max),
            )


def _weights(m: Model) -> Iterator[Row]:
    anchors = dc.farthest_anchors(m.L, round(0.02 * len(m.V)))
    step = m.diagonal / STEPS
    given = m.quantized(step, 0.0), m.quantized(step, 1.0), np.zeros_like(m.V)
    for weight in _WEIGHTS:
        system = dc.LeastSquares(m.L, anchors, weight)
        found = [m.errors(system.solve(delta, m.V[anchors])) for delta in given]
        name = "hard" if weight == math.inf else f"{weight:g}"
        yield name, *(f"{one.rms:.2e}" for one in found), f"{found[-1].max:.2e}"


TABLES = (
    Table(
        "counts",
        (
            "mesh",
            "anchors",
            "RMS, plain",
            "normals, plain",
            "RMS, diffused",
            "normals, diffused",
        ),
        _counts,
        ("torus",),
        ("horse",),
    ),
    Table(
        "rows",
        (
            "mesh",
            "bits",
            "rows of anchors",
            "error of deltas there (steps)",
            "elsewhere",
            "normals",
            "RMS",
            "max",
        ),
        _rows,
        ("torus",),
        ("horse",),
    ),
    Table(
        "weights",
        ("mesh", "weight", "RMS, plain", "RMS, diffused", "RMS, no deltas", "max, no deltas"),
        _weights,
        ("torus",),
        ("camelhead", "screwdriver"),
    ),
)
