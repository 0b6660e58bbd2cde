"""Arguments of public functions: checks whose errors name the argument that is wrong."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TypeGuard

from deltamesh_formats.errors import OptionError
from deltamesh_formats.printing import shortened

# Characters of a wrong value that a message shows.
_SHOWN = 60


def require(holds: bool, rule: str, value: object) -> None:
    """Raise an `OptionError` unless a condition holds: a rule, and the value that breaks it."""
    if not holds:  # only then: a value may be a mesh, or a list of a million faces
        raise OptionError(f"{rule}, not {brief(value)}")


def require_one_of(name: str, value: object, known: tuple[str, ...]) -> None:
    """Refuse what is not one of these words."""
    fits = isinstance(value, str) and value in known
    require(fits, f"{name} must be one of {', '.join(known)}", value)


def require_whole(name: str, value: object, low: int, high: int | None = None) -> None:
    """Refuse what is not an integer from `low` to `high`, or from `low` on."""
    bounds = f"lie in {low}..{high}" if high is not None else f"be a whole number from {low} on"
    fits = is_whole(value) and low <= value <= (value if high is None else high)
    require(fits, f"{name} must {bounds}", value)


def is_whole(value: object) -> TypeGuard[int]:
    """Return whether a value is an integer, and no truth value."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def require_number(name: str, value: object, low: float, high: float) -> None:
    """Refuse what is not a real number from `low` to `high`."""
    fits = is_real(value) and low <= value <= high
    require(fits, f"{name} must lie in {low:g}..{high:g}", value)


def require_above_0(name: str, value: object) -> None:
    """Refuse what is not a positive, finite number."""
    fits = is_real(value) and 0 < _as_float(value) < math.inf
    require(fits, f"{name} must be a number above 0", value)


def _as_float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def require_limit(name: str, value: object) -> None:
    """Refuse what is not a number from 0 on; infinity is one."""
    fits = is_real(value) and value >= 0
    require(fits, f"{name} must be a number from 0 on", value)


def is_real(value: object) -> TypeGuard[float]:
    """Return whether a value is a real number, and no truth value."""
    return isinstance(value, Real) and not isinstance(value, bool)


def require_flag(name: str, value: object) -> None:
    """Refuse what is not True or False, of Python or of numpy."""
    is_scalar = getattr(value, "ndim", 0) == 0
    require(is_scalar and value in (True, False), f"{name} must be a bool", value)


def require_type(name: str, value: object, kind: type) -> None:
    """Refuse what is not an object of a class."""
    require(isinstance(value, kind), f"{name} must be a {kind.__name__}", value)


def brief(value: object) -> str:
    """Return a wrong value as a message shows it, in one short line."""
    return shortened(" ".join(repr(value).split()), _SHOWN)
