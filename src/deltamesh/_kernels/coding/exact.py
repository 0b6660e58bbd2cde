"""Numbers to the last bit: the distance of each from a prediction, in units of its own format.

See `src/core/exact.c`.
"""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.grid import FORMAT_SIZE
from deltamesh._kernels.coding.models import Model, model_of
from deltamesh._kernels.core import call, constant, graph, ints, ints_out, scratch, shorts
from deltamesh_formats.array_types import Ints, Shorts

# Choices of a coordinate: the first format, the second, its raw bits, a negative zero.
FIRST, SECOND = constant("DM_FIRST_FORMAT"), constant("DM_SECOND_FORMAT")
RAW, NEGATIVE_ZERO = constant("DM_RAW"), constant("DM_NEGATIVE_ZERO")

# Columns of the table of axes: the row of its first format, the number of formats, whether there
# are raw coordinates and negative zeros.
AXIS_SIZE = constant("DM_AXIS_SIZE")

_AXIS, _FORMAT = model_of("exact_axis"), model_of("exact_format")


def model_for(formats: int) -> Model:
    """Return the model of three axes and that many formats."""
    slots = 3 * _AXIS.slots + formats * _FORMAT.slots
    return Model(slots, 3 * tuple(_AXIS.mixers) + formats * tuple(_FORMAT.mixers))


def code_exact(
    c: Coder,
    indptr: Shorts,
    indices: Shorts,
    first: Shorts,
    corners: Shorts,
    axes: Ints,
    formats: Ints,
    width: int,
    choices: Ints,
    values: Ints,
) -> None:
    """Code `choices` and `values` (n, 3), filled in place when decoding.

    A value is an index or, where it is raw, `width` bits. Neighbours are as
    `adjacency.adjacency` returns them, parallelograms as `parallelograms.parallelograms` does.
    """
    n, count, rows = len(values), len(corners), len(formats)
    call(
        "dm_code_exact",
        c.pointer,
        *graph(indptr, indices, n),
        shorts(first, n + 1),
        shorts(corners, count, 3),
        count,
        ints(axes, 3, AXIS_SIZE),
        ints(formats, rows, FORMAT_SIZE),
        rows,
        width,
        ints_out(choices, n, 3),
        ints_out(values, n, 3),
        scratch(n, 3),
        scratch(n, 3),
    )
