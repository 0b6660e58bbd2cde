"""Conversions: arithmetic that numbers of a format went through before they came to be in a mesh.

A program that reads a mesh in millimetres and writes it in metres multiplies decimals by 0.001, one
that centres it subtracts the same number from each; dequantization multiplies integers by a step
and adds an origin. The results use all the bits of their type, and yet each is known by the number
before. A *conversion* is up to two operations with a constant, each rounded as IEEE 754 has it. A
program may have done something else that rounds differently: the *deviation* of a value is how many
floats lie between it and what the conversion makes of its number, as in the modes of multiples of
M. Loncaric, "Pcodec: better compression for numerical sequences", 2025.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.payload_layout import OPERATORS

ADD, MULTIPLY, DIVIDE = (OPERATORS[name] for name in ("add", "multiply", "divide"))

# Deviations are coded as signed integers of 31 bits.
DEVIATION_BOUND: Final = 1 << 31
# Operands are normal numbers of such magnitudes: what is computed with them is far from overflow.
_SMALLEST, _LARGEST = 2.0**-1022, 1e150
_LARGEST_ORDINAL: Final = {True: 0x7F7FFFFF, False: 0x7FEFFFFFFFFFFFFF}


@dataclass(frozen=True)
class Operation:
    """Operation on a number: adding, multiplying by or dividing by an operand.

    Attributes
    ----------
    operator : {ADD, MULTIPLY, DIVIDE}
    operand : float
    """

    operator: int
    operand: float


@dataclass(frozen=True)
class Conversion:
    """Operations that make a value of a number of a format.

    Attributes
    ----------
    operations : tuple of Operation
        Two at most, in their order.
    double : bool
        Whether the first of two results of float32 values is a binary64 number.
    deviations : bool
        Whether there are values that are other floats than the results.
    """

    operations: tuple[Operation, ...]
    double: bool
    deviations: bool

    @property
    def identical(self) -> bool:
        """Whether every value is its number."""
        return not (self.operations or self.deviations)


NO_CONVERSION: Final = Conversion((), double=False, deviations=False)


def conversion_fault(conversion: Conversion, single: bool) -> str:
    """Return the fault of a conversion by the rules of SPEC.md 5.12; "" for none."""
    if len(conversion.operations) > 2:
        return f"{len(conversion.operations)} operations in a column"
    if conversion.double and not (single and len(conversion.operations) == 2):
        return "a conversion in binary64 that is none"
    for operation in conversion.operations:
        if operation.operator not in OPERATORS.values():
            return f"invalid operator: {operation.operator}"
        if not _SMALLEST <= abs(operation.operand) <= _LARGEST:
            return f"invalid operand: {operation.operand}"
    return ""


def converted(numbers: Floats, conversion: Conversion, single: bool) -> Floats:
    """Return what the operations make of numbers; one that is too large becomes infinite.

    Parameters
    ----------
    numbers : float64 (n,)
    conversion : Conversion
    single : bool
        Whether the values are float32.
    """
    if conversion.identical:
        return numbers
    x = numbers
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for operation in conversion.operations:
            if operation.operator == ADD:
                x = x + operation.operand
            elif operation.operator == MULTIPLY:
                x = x * operation.operand
            else:
                x = x / operation.operand
            if single and not conversion.double:
                x = x.astype(np.float32).astype(np.float64)
        return x.astype(np.float32).astype(np.float64) if single else x


def unconverted(values: Floats, conversion: Conversion) -> Floats:
    """Return about the numbers of which the operations make the values."""
    x = values
    with np.errstate(all="ignore"):
        for operation in reversed(conversion.operations):
            if operation.operator == ADD:
                x = x - operation.operand
            elif operation.operator == MULTIPLY:
                x = x / operation.operand
            else:
                x = x * operation.operand
    return x


def ordinals(values: Floats, single: bool) -> Ints:
    """Return the places of floats in their order: 0 for 0.0, -1 for -0.0, one more for the next."""
    if single:
        bits = values.astype(np.float32).view(np.int32).astype(np.int64)
        return np.where(bits < 0, -(bits & 0x7FFFFFFF) - 1, bits)
    bits = np.ascontiguousarray(values).view(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFFFFFFFFFF) - 1, bits)


def from_ordinals(places: Ints, single: bool) -> Floats:
    """Return the floats: the mirror of `ordinals`; beyond the largest they are infinite."""
    size = np.where(places < 0, -(places + 1), places)
    good = size <= _LARGEST_ORDINAL[single]
    kept = np.where(good, size, 0)
    found = kept.astype(np.int32).view(np.float32).astype(np.float64) if single else kept.view("f8")
    return np.where(good, np.where(places < 0, -found, found), np.inf)
