"""Bounds on errors, from a quality or from errors in units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from deltamesh._measures.margins import LEAST, SHARE
from deltamesh._measures.metrics import VertexErrors
from deltamesh._methods import AUTO
from deltamesh._options import DEFAULT_QUALITY, Options
from deltamesh_formats.errors import TargetError

# Positions may differ by that between machines and solvers, in diagonals of the bounding box
# (SPEC.md 5.4).
POSITION_TOLERANCE: Final = 1e-9

# Share of a bound that decoded positions may use up: what is written of them uses up the rest.
DECODED: Final = 1 / (1 + SHARE)

# The bounds of quality 5: the mean deviation of the face normals in degrees, which shading does not
# show, and the RMS distance over the diagonal, which bounds the error of a silhouette. Two levels
# up halve both.
QUALITY_NORMAL: Final = 1.0
QUALITY_RMS: Final = 1.5e-3


@dataclass(frozen=True)
class Bounds:
    """The largest errors that are allowed; of `metrics.VertexErrors`, with the same units."""

    rms: float = math.inf
    max: float = math.inf
    normal_deviation: float = math.inf
    dihedral: float = math.inf

    def before_writing(self, scale: float) -> Bounds:
        """Return bounds of decoded positions, which those rounded by a margin keep as they are.

        Parameters
        ----------
        scale : float
            Diagonal of the bounding box.
        """
        least = math.sqrt(3) * LEAST * scale
        values = {name: DECODED * bound for name, bound in vars(self).items()}
        return Bounds(**{**values, "max": DECODED * (self.max - least)})

    def shares(self, errors: VertexErrors) -> dict[str, float]:
        """Return each error over its bound; at most 1 where it is kept."""
        return {name: _share(getattr(errors, name), bound) for name, bound in vars(self).items()}

    def excess(self, errors: VertexErrors) -> float:
        """Return the largest of the shares."""
        return max(self.distance_excess(errors), self.angle_excess(errors))

    def distance_excess(self, errors: VertexErrors) -> float:
        """Return the largest share of a distance."""
        return max(_share(errors.rms, self.rms), _share(errors.max, self.max))

    def angle_excess(self, errors: VertexErrors) -> float:
        """Return the largest share of an angle."""
        normal = _share(errors.normal_deviation, self.normal_deviation)
        return max(normal, _share(errors.dihedral, self.dihedral))

    @property
    def has_angle(self) -> bool:
        """Whether an angle is bounded."""
        return min(self.normal_deviation, self.dihedral) < math.inf

    def missed(self, errors: VertexErrors) -> TargetError:
        """Return the error to raise where no trial has less than these, before writing."""
        shares = self.shares(errors)
        name = max(shares, key=lambda name: shares[name])
        bound, had = getattr(self, name) / DECODED, getattr(errors, name) / DECODED
        text = name.replace("_", " ")
        return TargetError(f"{text} {bound:g} cannot be met: the least found is {had:g}")


def _share(error: float, bound: float) -> float:
    if bound:
        return error / bound
    return math.inf if error else 1.0  # a bound of 0 is kept by 0 alone


def bounds_of(options: Options, scale: float) -> Bounds | None:
    """Return the bounds that options ask for, None where they ask for a rate or for nothing.

    Parameters
    ----------
    options : Options
    scale : float
        Diagonal of the bounding box.

    Raises
    ------
    TargetError
        For a distance that positions may differ by between machines.
    """
    if options.method == AUTO and not options.has_rate:
        return _of_quality(DEFAULT_QUALITY, scale)
    largest = min(options.max_error or math.inf, (options.max_error_rel or math.inf) * scale)
    if not largest > 2 * POSITION_TOLERANCE * scale and scale:
        raise TargetError(
            f"a distance of {largest:g} cannot be promised: positions may differ by"
            f" {POSITION_TOLERANCE * scale:g} between machines"
        )
    quality = Bounds() if options.quality is None else _of_quality(options.quality, scale)
    bounds = Bounds(
        rms=quality.rms,
        max=largest - POSITION_TOLERANCE * scale,
        normal_deviation=min(options.normal_error or math.inf, quality.normal_deviation),
        dihedral=options.dihedral_error or math.inf,
    )
    return None if bounds == Bounds() else bounds


def _of_quality(quality: int, scale: float) -> Bounds:
    factor = 2 ** ((DEFAULT_QUALITY - quality) / 2)
    rms = QUALITY_RMS * factor * scale
    return Bounds(rms=rms or math.inf, normal_deviation=QUALITY_NORMAL * factor)
