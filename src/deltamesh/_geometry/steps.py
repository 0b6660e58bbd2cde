"""Steps by vertex: the exponents in section STEP, and what follows from them; SPEC.md 5.19.

The step of a vertex is that of the file, the coarsest, times the *ratio* of its exponent e:
2^(-e / 4), rounded in one way that is the same everywhere. Small parts of a scene, and small
features of a part, then keep their shape without paying for it everywhere. Without STEP, all ratios
are 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from deltamesh._geometry.integers import NO_POINTS, NONE, Integers
from deltamesh._graph.elements import of_graph
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh._streams.labels import decode_labels, encode_labels
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.container import Parameters, Section
from deltamesh_formats.container.fields import take
from deltamesh_formats.container.layout import STEPS
from deltamesh_formats.container.payload_layout import (
    MAX_EXPONENT,
    MAX_GRID_BITS,
    PER_OCTAVE,
    QUARTERS,
)
from deltamesh_formats.container.sections import payload_of
from deltamesh_formats.errors import FormatError, located
from deltamesh_formats.polymesh.permutations import numbered

LEAST: Final = 2  # different exponents, where there are any


def _ratios() -> Floats:
    octaves, quarters = np.divmod(np.arange(MAX_EXPONENT + 1), PER_OCTAVE)
    return np.asarray(np.ldexp(np.array(QUARTERS)[quarters], -octaves), dtype=np.float64)


# The ratio of each exponent.
RATIOS: Final = _ratios()


def chosen(settings: Settings, surface: Surface, step: float) -> tuple[float, Ints]:
    """Return the coarsest step, and the exponents of the settings, none where all steps are alike.

    Parameters
    ----------
    settings : Settings
    surface : Surface
    step : float
        The coarsest step of what has importance 1. Where it is 0, no step has an exponent.

    Returns
    -------
    float
    int64 (n,) or (0,)

    Raises
    ------
    ValueError
        For exponents, or levels of importance, of another number of vertices, beyond the largest,
        or without a 0.
    """
    exponents, coarser = (
        np.frombuffer(each, dtype=np.uint8).astype(np.int64)
        for each in (settings.exponents, settings.coarser)
    )
    for each in (exponents, coarser):
        if len(each) not in (0, surface.vertex_count):
            raise ValueError(f"{len(each)} exponents of {surface.vertex_count} vertices")
        if (each.min(initial=MAX_EXPONENT) > 0 and len(each)) or each.max(initial=0) > MAX_EXPONENT:
            raise ValueError(f"exponents of {each.min()} to {each.max()}")
    if not step or not (exponents.any() or coarser.any()):
        return step, NONE
    level = np.zeros(surface.vertex_count, dtype=np.int64)
    level += exponents if len(exponents) else 0
    level -= coarser if len(coarser) else 0
    level = np.maximum(level, level.max() - MAX_EXPONENT)
    coarsest = int(level.min())
    level -= coarsest
    return step * 2.0 ** (-coarsest / PER_OCTAVE), level if level.any() else NONE


def ratios(integers: Integers) -> Floats:
    """Return the ratio of each row of the values, float64 (n, 1): 1 for isolated vertices."""
    if not len(integers.exponents):
        return np.broadcast_to(1.0, (len(integers.values), 1))
    result = np.ones((len(integers.values), 1))
    result[: len(integers.exponents), 0] = RATIOS[integers.exponents]
    return result


def of_vertices(step: float, integers: Integers) -> Floats:
    """Return the step of each row of the values, float64 (n, 1), which may be a view of one."""
    if not len(integers.exponents):
        return np.broadcast_to(step, (len(integers.values), 1))
    return step * ratios(integers)


def anchor_ratios(integers: Integers) -> Floats:
    """Return the ratio of each anchor, float64 (k, 1)."""
    return ratios(integers)[integers.anchors]


def extra_bits(exponents: Ints, count: int) -> Ints:
    """Return how many bits more a grid coordinate takes, at most, in finer steps, int64 (count,).

    They are those of the exponents, and 0 for further elements.
    """
    return np.pad(-(-exponents // PER_OCTAVE), (0, count - len(exponents)))


def encode(surface: Surface, exponents: Ints) -> dict[str, bytes]:
    """Return the payload of STEP, by its id, where there are exponents."""
    if not len(exponents):
        return {}
    labels, distinct = numbered(exponents)
    stream = encode_labels(of_graph(*surface.graph), labels)
    return {STEPS: bytes([len(distinct), *distinct]) + stream}


def decode(surface: Surface, parameters: Parameters, sections: Mapping[str, Section]) -> Ints:
    """Return the exponents of the vertices, int64 (n,), or none: the mirror of `encode`.

    Raises
    ------
    FormatError
    """
    if STEPS not in sections:
        return NONE
    with payload_of(sections[STEPS]) as payload:
        if not parameters.step:
            raise FormatError("steps by vertex in a file of 0 bits", 0)
        count = take(payload, 0, 1)[0]
        if count < LEAST:
            raise FormatError(f"{count} different steps", 0)
        distinct = np.array(take(payload, 1, count), dtype=np.int64)
        if distinct.max() > MAX_EXPONENT:
            raise FormatError(f"an exponent of {distinct.max()}", 1 + int(np.argmax(distinct)))
        if len(np.unique(distinct)) < count:
            raise FormatError("an exponent that comes twice", 1)
        if distinct.min() > 0:
            raise FormatError("no vertex of the coarsest step", 1)
        at = 1 + count
        with located(at):
            labels = decode_labels(payload[at:], of_graph(*surface.graph))
        if labels.max(initial=-1) + 1 != count:
            raise FormatError(f"{labels.max(initial=-1) + 1} labels of {count} steps", at)
        return distinct[labels]


def grid_bits(points: Ints, extra: Ints, others: Ints = NO_POINTS) -> list[int]:
    """Return the bits of a coordinate x, y, z that hold grid points, and others without `extra`."""
    both = np.concatenate([points >> extra[:, None], others])
    return [int(most).bit_length() for most in both.max(axis=0, initial=0)]


def read_grid_bits(payload: memoryview) -> Ints:
    """Return the bits of each coordinate of a grid point, int64 (3,), at the begin of a payload.

    Raises
    ------
    FormatError
    """
    bits = np.array(take(payload, 0, 3), dtype=np.int64)
    if bits.max() > MAX_GRID_BITS:
        raise FormatError(f"a grid of more than {MAX_GRID_BITS} bits", int(np.argmax(bits)))
    return bits
