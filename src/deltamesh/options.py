"""The options of the encoder, checked in one place."""

from __future__ import annotations

import math
from dataclasses import dataclass

from deltamesh_formats.errors import OptionError

METHODS = ("highpass", "cartesian")
ANCHOR_METHODS = ("farthest", "greedy", "random")
DEFAULT_BITS = {"highpass": 8, "cartesian": 11}
MAX_BITS = 30


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
    diffusion: bool = True
    anchors: int | float | None = None
    anchor_method: str = "farthest"
    seed: int = 0
    solver: str = "auto"
    threads: int | None = None
    drop_isolated: bool = False
    source_format: str = ""

    def __post_init__(self) -> None:
        _require(self.method in METHODS, f"method {self.method!r} is none of {METHODS}")
        known = self.anchor_method in ANCHOR_METHODS
        _require(known, f"anchor_method {self.anchor_method!r} is none of {ANCHOR_METHODS}")
        _require(self.bits is None or self.step is None, "bits and step exclude each other")
        if self.bits is not None:
            lowest = 0 if self.method == "highpass" else 1
            fits = not isinstance(self.bits, bool) and lowest <= self.bits <= MAX_BITS
            _require(fits, f"bits must lie in {lowest}..{MAX_BITS}, not {self.bits}")
        if self.step is not None:
            fits = math.isfinite(self.step) and self.step > 0
            _require(fits, f"step must be a length above 0, not {self.step}")
        _require(0 <= self.seed < 1 << 64, f"seed must lie in 0..2^64 - 1, not {self.seed}")
        enough = self.threads is None or self.threads >= 1
        _require(enough, f"threads must be at least 1, not {self.threads}")

    @property
    def effective_bits(self) -> int | None:
        """Bits per coordinate, None when a step was asked for."""
        if self.bits is None and self.step is None:
            return DEFAULT_BITS[self.method]
        return self.bits


def _require(holds: bool, message: str) -> None:
    if not holds:
        raise OptionError(message)
