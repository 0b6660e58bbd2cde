"""The options of the encoder, checked in one place."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Integral

from deltamesh_formats.errors import OptionError

METHODS = ("highpass", "refined", "cartesian", "lossless")
ANCHOR_METHODS = ("farthest", "greedy", "random")
# What is asked for by default: bits a coordinate, and a step in diagonals of the bounding box. The
# range of the deltas is no scale to go by: one vertex of high valence makes it a thousand times
# what it is elsewhere.
DEFAULT_CARTESIAN_BITS = 11
DEFAULT_HIGHPASS_STEP = 1 / 1000

# How coarse the deltas are that get refined along the normals, and the dead zones of both.
DEFAULT_COARSE = 8.0
MAX_COARSE = 64.0
DEAD_ZONE = 0.2
NORMAL_DEAD_ZONE = 0.1
SOLVERS = ("auto", "rslab", "pardiso", "scipy")
# The ways to say how small or how good: at most one of them.
RATES = ("bits", "step", "normal_error", "max_error", "max_error_rel")
MAX_BITS = 30
MAX_THREADS = 1024
MAX_NAME = 255


@dataclass(frozen=True)
class Options:
    """What to encode how; `deltamesh.encode` documents each.

    Raises
    ------
    OptionError
        For the first option that is unknown, out of range, or contradicts another.
    """

    method: str = "highpass"
    bits: int | None = None
    step: float | None = None
    normal_error: float | None = None
    max_error: float | None = None
    max_error_rel: float | None = None
    diffusion: bool = True
    anchors: int | float | None = None
    anchor_method: str = "farthest"
    seed: int = 0
    solver: str = "auto"
    threads: int | None = None
    coarse: float | None = None
    drop_isolated: bool = False
    keep_order: bool = False
    source_format: str = ""

    def __post_init__(self) -> None:
        _require_one_of("method", self.method, METHODS)
        _require_one_of("anchor_method", self.anchor_method, ANCHOR_METHODS)
        _require_one_of("solver", self.solver, SOLVERS)
        given = [name for name in RATES if getattr(self, name) is not None]
        _require(len(given) <= 1, f"{' and '.join(given)} exclude each other")
        meaningless = self.method == "lossless" and given
        _require(not meaningless, f"{' and '.join(given)} means nothing with method lossless")
        for name in RATES[1:]:
            value = getattr(self, name)
            fits = value is None or (math.isfinite(value) and value > 0)
            _require(fits, f"{name} must be a number above 0, not {value}")
        if self.coarse is not None:
            _require(self.method == "refined", f"coarse means nothing with method {self.method}")
            fits = 1 <= self.coarse <= MAX_COARSE
            _require(fits, f"coarse must lie in 1..{MAX_COARSE:g}, not {self.coarse!r}")
        if self.bits is not None:
            _require_within("bits", self.bits, 0 if self.method == "highpass" else 1, MAX_BITS)
        _require_within("seed", self.seed, 0, (1 << 64) - 1)
        if self.threads is not None:
            _require_within("threads", self.threads, 1, MAX_THREADS)
        fits = self.source_format.isprintable() and len(self.source_format.encode()) <= MAX_NAME
        _require(fits, "source_format must be printable, and at most 255 bytes")

    @property
    def effective_bits(self) -> int | None:
        """Bits per coordinate, None for a step."""
        if all(getattr(self, name) is None for name in RATES) and self.method == "cartesian":
            return DEFAULT_CARTESIAN_BITS
        return self.bits


def _require_one_of(name: str, value: str, known: tuple[str, ...]) -> None:
    _require(value in known, f"{name} must be one of {', '.join(known)}, not {value!r}")


def _require_within(name: str, value: int, low: int, high: int) -> None:
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    _require(whole and low <= value <= high, f"{name} must lie in {low}..{high}, not {value!r}")


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise OptionError(message)
