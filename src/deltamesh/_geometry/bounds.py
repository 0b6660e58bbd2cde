"""Bounds on errors, from a quality or from errors in units.

They are of two kinds: angles (normals, dihedral angles) and distances (RMS, largest). Those of the
default quality hold unless others of their kind are given; one kind alone is no bound on a shape: a
box may keep all of its angles and lose a third of its size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._measures.measure import Measured
from deltamesh._measures.parts import QUALITY_NORMAL, QUALITY_RMS
from deltamesh._methods import ANGLE_BOUNDS, BOUNDS, DISTANCE_BOUNDS, RATES
from deltamesh._options import DEFAULT_QUALITY, Options
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import TargetError

# Positions may differ by that between machines and solvers, in diagonals of the bounding box of
# their component (SPEC.md 5.4); that of the whole mesh is at least as long.
POSITION_TOLERANCE: Final = 1e-9


@dataclass(frozen=True)
class Bounds:
    """The largest errors that are allowed.

    Attributes
    ----------
    rms, max : float
        Lengths, of the whole and of each part.
    normal_deviation, dihedral : float
        In degrees, of the whole.
    part_rms : float
        Of each part, over its own diagonal.
    part_normal, part_dihedral : float
        In degrees, of each part.
    """

    rms: float = math.inf
    max: float = math.inf
    normal_deviation: float = math.inf
    dihedral: float = math.inf
    part_rms: float = math.inf
    part_normal: float = math.inf
    part_dihedral: float = math.inf

    def excess(self, measured: Measured) -> float:
        """Return the largest error over its bound, of the whole and of every part."""
        return self.binding(measured).share

    def part_excess(self, measured: Measured) -> tuple[Floats, Floats]:
        """Return the largest distance, and the largest angle, of each part over their bounds.

        Returns
        -------
        float64 (q,), float64 (q,)
            Those of the whole, (1,), if the mesh is one part.
        """
        of_parts = self._of_whole(measured) if measured.parts is None else self._of_parts(measured)
        distances, angles = (
            [_shares(one.errors, one.bound) for one in of_parts if one.is_length == is_length]
            for is_length in (True, False)
        )
        return np.max(distances, axis=0), np.max(angles, axis=0)

    def distance_over_angle(self, measured: Measured) -> float:
        """Return how many times nearer to its bound the largest distance is than the angle."""
        distance, angle = (float(each.max()) for each in self.part_excess(measured))
        return distance / angle if angle else math.inf

    def binding(self, measured: Measured) -> Binding:
        """Return the bound that is the nearest to its error, or the furthest exceeded."""
        whole = self._of_whole(measured)
        found = [Binding(one.name, float(one.errors[0]), one.bound) for one in whole]
        for one in self._of_parts(measured):
            part = int(np.argmax(_shares(one.errors, one.bound)))
            found.append(Binding(one.name, float(one.errors[part]), one.bound, part))
        return max(found, key=lambda one: one.share)

    def within(self, other: Bounds) -> Bounds:
        """Return the tighter bound of each kind of two."""
        return Bounds(*map(min, vars(self).values(), vars(other).values()))

    @property
    def of_angles(self) -> Bounds:
        """The bounds on angles alone, of the whole."""
        return Bounds(normal_deviation=self.normal_deviation, dihedral=self.dihedral)

    @property
    def has_angle(self) -> bool:
        """Whether an angle is bounded."""
        return min(self.normal_deviation, self.dihedral) < math.inf

    def _of_whole(self, measured: Measured) -> tuple[_Bounded, ...]:
        e, doubt = measured.errors, measured.doubt
        return (
            _Bounded("RMS distance", np.array([e.rms + doubt]), self.rms, is_length=True),
            _Bounded("maximum distance", np.array([e.max + doubt]), self.max, is_length=True),
            _Bounded("normal deviation", np.array([e.normal_deviation]), self.normal_deviation),
            _Bounded("dihedral deviation", np.array([e.dihedral]), self.dihedral),
        )

    def _of_parts(self, measured: Measured) -> tuple[_Bounded, ...]:
        e = measured.parts
        if e is None:
            return ()
        relative, doubt = "RMS distance over the diagonal", measured.doubt
        return (
            _Bounded(relative, e.relative_rms, self.part_rms, is_length=True),
            _Bounded("RMS distance", e.rms + doubt, self.rms, is_length=True),
            _Bounded("maximum distance", e.max + doubt, self.max, is_length=True),
            _Bounded("normal deviation", e.normal_deviation, self.part_normal),
            _Bounded("dihedral deviation", e.dihedral, self.part_dihedral),
        )


NO_BOUNDS: Final = Bounds()


@dataclass(frozen=True)
class _Bounded:
    """Errors of the whole, (1,), or of the parts, (q,), that have one bound."""

    name: str
    errors: Floats
    bound: float
    is_length: bool = False


@dataclass(frozen=True)
class Binding:
    """An error and its bound.

    Attributes
    ----------
    name : str
    error, bound : float
    part : int or None
        The part whose error it is; None for the whole.
    """

    name: str
    error: float
    bound: float
    part: int | None = None

    @property
    def share(self) -> float:
        """The error over the bound."""
        return float(_shares(np.array([self.error]), self.bound)[0])


def _shares(errors: Floats, bound: float) -> Floats:
    if bound:
        return errors / bound
    return np.where(errors > 0, math.inf, 1.0)  # a bound of 0 is kept by 0 alone


def bounds_of(options: Options, scale: float) -> Bounds | None:
    """Return the bounds that options ask for, None where they ask for a rate, or to be exact.

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
    if options.exact or any(getattr(options, rate) is not None for rate in RATES):
        return None
    given = {name for name in BOUNDS if getattr(options, name) is not None}
    quality, default = options.quality, None if options.only else DEFAULT_QUALITY
    of_angles = quality or (None if given & set(ANGLE_BOUNDS) else default)
    of_distances = quality or (None if given & set(DISTANCE_BOUNDS) else default)
    normal = min(options.normal_error or math.inf, QUALITY_NORMAL * _factor(of_angles))
    dihedral = options.dihedral_error or math.inf
    part_rms = QUALITY_RMS * _factor(of_distances)
    least = POSITION_TOLERANCE * scale
    rms = _length(options.rms_error, options.rms_error_rel, scale)
    largest = _length(options.max_error, options.max_error_rel, scale)
    return Bounds(
        rms=min(rms - least, part_rms * scale or math.inf),
        max=largest - least,
        normal_deviation=normal,
        dihedral=dihedral,
        part_rms=part_rms,
        part_normal=normal,
        part_dihedral=dihedral,
    )


def furthest_at_rate(scale: float) -> Bounds:
    """Return the distances of quality 1, beyond which a shape is lost, whatever its angles."""
    rms = QUALITY_RMS * _factor(1)
    return Bounds(rms=rms * scale or math.inf, part_rms=rms)


def _length(error: float | None, relative: float | None, scale: float) -> float:
    """Return the lesser of a length and of a share of the diagonal."""
    length = min(error or math.inf, (relative or math.inf) * scale)
    if not length > 2 * POSITION_TOLERANCE * scale and scale:
        raise TargetError(
            f"a distance of {length:g} cannot be promised: positions may differ by"
            f" {POSITION_TOLERANCE * scale:g} between machines"
        )
    return length


def _factor(quality: int | None) -> float:
    """Return the bounds of a quality over those of the default one."""
    return math.inf if quality is None else 2 ** ((DEFAULT_QUALITY - quality) / 2)
