"""Margins: how far a writer may round the numbers of a decoded mesh.

Decoded positions are real numbers, and files have floats of some size or decimals. A margin is a
small share of the error that positions have: within it, what is written keeps the bounds that the
encoder was given, and has no digits that mean nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._measures.measure import Measure, Measured
from deltamesh._measures.metrics import VertexErrors
from deltamesh._measures.parts import PartErrors
from deltamesh_formats.array_types import Floats
from deltamesh_formats.meshfiles.number_text import rounded

# Of a distance, or of half a step of an attribute: what rounding may add to it.
SHARE: Final = 1 / 200
# Of an angle. Rounding errors are independent of the others: squares add up.
ANGLE_SHARE: Final = 1 / 100
# What rounding may add to any angle, in degrees, and to the RMS distance of a part, in diagonals of
# the part and as a share of that: so little is not seen, however small the error is.
LEAST_ANGLE: Final = 0.002
LEAST_RMS: Final = 1e-3
# Halvings of the diagonal of the mesh that are the least margin; decoders differ by more than that.
MOST_HALVINGS: Final = 33


def margin_of(
    measure: Measure,
    measured: Measured,
    decoded: Floats,
    diagonal: float,
    keeps: Callable[[Measured], bool],
) -> int:
    """Return the margin of the coordinates of decoded positions as `Meta.margin` has it.

    Rounding by a margin r moves a vertex by at most sqrt(3) r, and no distance grows by more. What
    it does to angles is measured, and twice the difference is taken for the most. Faces that have
    become lines turn however little they are moved: where no margin leaves the angles alone, the
    largest one is taken that keeps the bounds.

    Parameters
    ----------
    measure : Measure
    measured : Measured
        The errors of the decoded positions.
    decoded : float64 (n, 3)
    diagonal : float
        Of the bounding box of the mesh.
    keeps : callable
        Whether errors are within the bounds.
    """
    rms = measured.errors.rms
    if not (0 < diagonal < math.inf):
        return 0
    # Where the share of the RMS distance is below the least number, its logarithm is not.
    share = math.log2(SHARE / math.sqrt(3))
    first = math.log2(diagonal) - math.log2(rms) - share if rms else math.inf
    halvings, fallback = max(1, math.ceil(min(first, MOST_HALVINGS))), 0
    while halvings <= MOST_HALVINGS:
        margin = diagonal * 2.0**-halvings
        most = _most(measured, measure(rounded(decoded, margin)), math.sqrt(3) * margin)
        excess = max(_excesses(measured, most, diagonal))
        if keeps(most):
            if excess <= 1:
                return halvings
            fallback = fallback or halvings
        halvings += max(1, math.ceil(math.log2(excess) / 2)) if 1 < excess < math.inf else 1
    return fallback


def _most(before: Measured, after: Measured, distance: float) -> Measured:
    """Return the errors that positions may have once they are rounded."""
    parts = None
    if before.parts is not None and after.parts is not None:
        parts = replace(
            before.parts,
            rms=before.parts.rms + distance,
            max=before.parts.max + distance,
            normal_deviation=_doubled(before.parts.normal_deviation, after.parts.normal_deviation),
            dihedral=_doubled(before.parts.dihedral, after.parts.dihedral),
        )
    a, b = before.errors, after.errors
    errors = VertexErrors(
        rms=a.rms + distance,
        max=a.max + distance,
        normal_deviation=float(_doubled(a.normal_deviation, b.normal_deviation)),
        dihedral=float(_doubled(a.dihedral, b.dihedral)),
    )
    return replace(before, errors=errors, parts=parts)


def _doubled(before: Floats | float, after: Floats | float) -> Floats:
    return np.asarray(before + 2 * np.abs(np.asarray(after) - before))


def _excesses(before: Measured, most: Measured, diagonal: float) -> Iterator[float]:
    """Yield what each error may grow by, over what it is allowed to."""
    least = 2.0 ** (1 - MOST_HALVINGS) * diagonal
    yield from _of_errors(before.errors, most.errors, least)
    if before.parts is not None and most.parts is not None:
        own = np.maximum(least, SHARE * LEAST_RMS * before.parts.diagonal)
        yield from _of_errors(before.parts, most.parts, own)


def _of_errors(
    before: VertexErrors | PartErrors, most: VertexErrors | PartErrors, least: Floats | float
) -> Iterator[float]:
    for name, share, floor in (
        ("rms", SHARE, least),
        ("max", SHARE, least),
        ("normal_deviation", ANGLE_SHARE, LEAST_ANGLE),
        ("dihedral", ANGLE_SHARE, LEAST_ANGLE),
    ):
        error = np.asarray(getattr(before, name))
        allowed = np.maximum(share * error, floor)
        growth = np.asarray(getattr(most, name)) - error
        with np.errstate(divide="ignore", invalid="ignore"):  # a share below the least number is 0
            yield float(np.max(np.where(growth > 0, growth / allowed, 0.0), initial=0.0))
