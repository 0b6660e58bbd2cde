"""Search for the largest step of each component that keeps the bounds of every part.

The components of a mesh do not see each other: what errs in one follows from its own step. So the
steps are searched for side by side, in quarters of an octave, each trial being one for all of them.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from deltamesh._geometry.bounds import Bounds
from deltamesh._geometry.step_search import MOST_TRIES, PER_OCTAVE, close_enough, fit_step
from deltamesh._geometry.trial import Attempt, ScaleError, Trial
from deltamesh._measures.metrics import mean_edges
from deltamesh._measures.parts import Parts
from deltamesh._options import Settings
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.container.payload_layout import MAX_EXPONENT
from deltamesh_formats.container.payload_layout import PER_OCTAVE as LEVELS
from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.permutations import distinct

# Trials once all parts are good, by effort.
TRIES: Final = {1: 3, 2: 5, 3: 8}
# Bases that are tried, and the share of the bounds that the largest component aims at then.
BASES: Final = 2
NEAREST: Final = 0.98
# A part within that share of its bound is settled: a level more would exceed it.
SETTLED: Final = 0.85
# Levels are quarters of an octave, a step between two of them is had by another base: one for the
# component of the most vertices, if that is good for more than this.
WORTH: Final = 1.03
# What the next level aims at, and how many levels it is away at most.
AIM: Final = 0.93
FURTHEST: Final = 5 * LEVELS


@dataclass(frozen=True)
class Components:
    """Components of a mesh, as a search for their steps sees them.

    Attributes
    ----------
    of_vertex : int64 (n,)
        The component of each vertex of the faces.
    edge, diagonal : float64 (c,)
        Mean length of the edges, and diagonal of the bounding box.
    part, touched : int64 (t,)
        The components that each part touches, pair by pair.
    """

    of_vertex: Ints
    edge: Floats
    diagonal: Floats
    part: Ints
    touched: Ints

    @property
    def alone(self) -> bool:
        """Whether the mesh is one part."""
        return len(self.part) == 1

    def largest_rms(self, bounds: Bounds) -> Floats:
        """Return the largest RMS distance that bounds leave to each component, float64 (c,)."""
        return np.where(self.diagonal > 0, bounds.part_rms * self.diagonal, math.inf)

    def excess(self, of_parts: Floats) -> Floats:
        """Return the largest excess of the parts that touch each component, float64 (c,)."""
        found = np.zeros(len(self.edge))
        np.maximum.at(found, self.touched, of_parts[self.part])
        return found

    def grouped(self, group: Ints) -> Components:
        """Return groups of components, int64 (c,), each of one step, as components."""
        count = int(group.max()) + 1
        edge, diagonal = np.full(count, math.inf), np.full(count, math.inf)
        np.minimum.at(edge, group, self.edge)
        np.minimum.at(diagonal, group, self.diagonal)
        return Components(group[self.of_vertex], edge, diagonal, self.part, group[self.touched])

    def settings(self, settings: Settings, steps: Steps) -> Settings:
        """Return settings with these steps."""
        level = steps.level - steps.level.min()
        if not level.any():
            return replace(settings, step=steps.coarsest, exponents=b"")
        exponents = level.astype(np.uint8)[self.of_vertex].tobytes()
        return replace(settings, step=steps.coarsest, exponents=exponents)


@dataclass(frozen=True)
class Steps:
    """Step of each component: `base` over 2^(level / 4), level int64 (c,)."""

    base: float
    level: Ints

    @property
    def coarsest(self) -> float:
        """The largest step."""
        return float(self.base * 2.0 ** (-int(self.level.min()) / LEVELS))

    @property
    def finest(self) -> float:
        """The smallest step."""
        return float(self.base * 2.0 ** (-int(self.level.max()) / LEVELS))

    def times(self, factor: float) -> Steps:
        """Return steps that many times as large."""
        return Steps(self.base * factor, self.level)


def steps_near(wanted: Floats) -> Steps:
    """Return the steps nearest to those wanted, float64 (c,)."""
    base = float(wanted.max())
    level = np.rint(-LEVELS * np.log2(wanted / base)).astype(np.int64)
    return Steps(base, _within_reach(level))


def _within_reach(level: Ints) -> Ints:
    """Return levels of which none is coarser than exponents can tell, beside the finest."""
    return np.asarray(np.maximum(level, level.max() - MAX_EXPONENT))


@dataclass
class _Known:
    """What trials have told of each component.

    Attributes
    ----------
    bad, good : float64 (c,)
        The finest level that failed, the coarsest that held; -inf and inf as long as there is none.
    bad_excess, good_excess : float64 (c,)
    failures : int64 (c,)
        Trials that have failed.
    """

    bad: Floats
    good: Floats
    bad_excess: Floats
    good_excess: Floats
    failures: Ints

    def learn(self, level: Ints, excess: Floats) -> None:
        holds = excess <= 1
        self.failures += ~holds
        better, worse = holds & (level < self.good), ~holds & (level > self.bad)
        self.good[better], self.good_excess[better] = level[better], excess[better]
        self.bad[worse], self.bad_excess[worse] = level[worse], excess[worse]
        # Errors do not always fall with the step: the newer trial is believed.
        crossed = self.bad >= self.good
        self.bad[crossed & holds], self.good[crossed & ~holds] = -math.inf, math.inf

    @property
    def settled(self) -> Bools:
        return np.asarray((self.good_excess > SETTLED) | (self.good - self.bad <= 1))


def fit_steps(
    settings: Settings,
    bounds: Bounds,
    steps: Steps,
    components: Components,
    effort: int,
    attempt: Attempt,
    rival: Trial | None,
    missed: list[Trial],
) -> tuple[Trial | None, Steps]:
    """Return the smallest trial within the bounds that was found, and about the largest steps.

    There is no trial, perhaps, where none can win. The best that was not good goes to `missed`.

    Raises
    ------
    ScaleError
        If no step has a scale that fits.
    """
    c = len(steps.level)
    bad, good, bad_excess, good_excess = (
        np.full(c, x) for x in (-math.inf, math.inf, math.inf, 0.0)
    )
    known = _Known(bad, good, bad_excess, good_excess, np.zeros(c, dtype=np.int64))
    found: Trial | None = None
    last = steps
    for tries in range(1, MOST_TRIES + 1):
        try:
            trial = attempt(components.settings(settings, steps))
        except ScaleError:
            if found is None:
                raise
            break
        except MeshError:  # 2^30 steps are not enough for a component: half as far, then
            level = last.level + (steps.level - last.level) // 2
            if (level == last.level).all():
                break
            steps = Steps(steps.base, level)
            continue
        excess = _excess(trial, bounds, components)
        known.learn(steps.level, excess)
        if (excess > 1).any():
            least = bounds.excess(missed[0].measured) if missed else math.inf
            if excess.max() < least:
                missed[:] = [trial]
        elif found is None or trial.size < found.size:
            found = trial
        enough = tries >= TRIES[effort] and np.isfinite(known.good).all()
        level = known.good.astype(np.int64) if enough else _next(known, steps.level)
        level = _within_reach(level)
        last, steps = steps, Steps(steps.base, level)
        if (level == last.level).all() or (found is not None and tries > TRIES[effort]):
            break
        if rival is not None and _floor(trial, excess, components) >= rival.size:
            kept = np.where(np.isfinite(known.good), known.good, level).astype(np.int64)
            return found, Steps(steps.base, _within_reach(kept))
    return found, steps


def with_fewer_levels(
    settings: Settings,
    bounds: Bounds,
    found: tuple[Trial | None, Steps],
    components: Components,
    effort: int,
    attempt: Attempt,
    rival: Trial | None,
) -> tuple[Trial | None, Steps]:
    """Return a smaller trial, if there is one, of two different steps, or of one for all.

    What is alike in several components, such as copies of a bolt, or the height at which houses
    stand, is coded in fewer bytes where their steps are the same.
    """
    steps = found[1]
    level = steps.level - steps.level.min()
    if not level.any():
        return found
    if len(distinct(level)) > 2:
        fine = _finer_of_two(level, np.bincount(components.of_vertex, minlength=len(level)))
        two = Steps(steps.coarsest, np.array([level[fine == i].max() for i in range(2)]))
        least, grouped = _smaller(rival, found[0]), components.grouped(fine)
        with suppress(MeshError):  # 2^30 steps are not enough for a component
            trial, two = fit_steps(settings, bounds, two, grouped, effort, attempt, least, [])
            if trial is not None and trial is _smaller(found[0], trial):
                found = trial, Steps(two.base, two.level[fine])
    one = Steps(steps.finest, np.zeros_like(level))
    with suppress(MeshError):
        attempt(components.settings(settings, one))
        least = _smaller(rival, found[0])
        close = close_enough(effort, len(components.of_vertex))
        trial = fit_step(settings, bounds, one.base, close, attempt, least, [])
        if trial is not None and trial is _smaller(found[0], trial):
            found = trial, replace(one, base=trial.step)
    return found


def with_nearer_base(
    settings: Settings,
    bounds: Bounds,
    found: tuple[Trial, Steps],
    components: Components,
    attempt: Attempt,
) -> tuple[Trial, Steps]:
    """Return a smaller trial, if there is one, whose largest component is nearer to its bounds.

    The others keep their levels if they are far from their bounds, or else take no larger step. Of
    one step for all, a search has found the largest.
    """
    trial, steps = found
    excess = _excess(trial, bounds, components)
    vertices = np.bincount(components.of_vertex, minlength=len(excess))
    largest = int(np.argmax(vertices))
    if not trial.settings.exponents or not excess[largest] > 0:
        return found
    factor = float(NEAREST / excess[largest])
    for _ in range(BASES):
        if factor < WORTH:
            break
        finer = (excess * factor > NEAREST) & (np.arange(len(excess)) != largest)
        level = steps.level + np.where(finer, math.ceil(LEVELS * math.log2(factor)), 0)
        other = Steps(steps.base * factor, _within_reach(level.astype(np.int64)))
        with suppress(MeshError):
            tried = attempt(components.settings(settings, other))
            if bounds.excess(tried.measured) <= 1 and tried.size < found[0].size:
                return tried, other
        factor = math.sqrt(factor)
    return found


def _smaller(one: Trial | None, other: Trial | None) -> Trial | None:
    """Return the smaller of two trials, the first if they are alike; None if there is none."""
    trials = [trial for trial in (one, other) if trial is not None]
    return min(trials, key=lambda trial: trial.size) if trials else None


def _finer_of_two(level: Ints, vertices: Ints) -> Ints:
    """Return which components, 0 or 1, take the finer of the two levels that cost the least.

    Each of the two is the finest of its components; the cost is that of their vertices.
    """
    levels, inverse = np.unique(level, return_inverse=True)
    below = np.cumsum(np.bincount(inverse, vertices))[:-1]
    coarser = int(np.argmax(below * (levels[-1] - levels[:-1])))
    return np.asarray(inverse > coarser, dtype=np.int64)


def _excess(trial: Trial, bounds: Bounds, components: Components) -> Floats:
    """Return the excess of each component; that of the whole too, where no part tells of it."""
    excess = components.excess(np.maximum(*bounds.part_excess(trial.measured)))
    whole = bounds.excess(trial.measured)
    return excess if whole <= 1 or (excess > 1).any() else np.maximum(excess, whole)


def _next(known: _Known, level: Ints) -> Ints:
    """Return the level to try next for each component, int64 (c,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        finer = np.ceil(LEVELS * np.log2(known.bad_excess / AIM))
        coarser = np.floor(LEVELS * np.log2(AIM / known.good_excess))
        low, high = np.log2(known.good_excess / AIM), np.log2(known.bad_excess / AIM)
        between = known.good + np.rint((known.bad - known.good) * low / (low - high))
        middle = np.rint((known.bad + known.good) / 2)
    # Where slivers have lost their normals, errors fall slowly at first.
    finer = known.bad + np.clip(finer * 2.0 ** np.maximum(known.failures - 2, 0), 1, FURTHEST)
    coarser = known.good - np.clip(coarser, 1, FURTHEST)
    between = np.where(np.isfinite(between), between, middle)
    between = np.clip(between, known.bad + 1, np.maximum(known.good - 1, known.bad + 1))
    has_bad, has_good = np.isfinite(known.bad), np.isfinite(known.good)
    found = np.where(has_bad & has_good, between, np.where(has_bad, finer, coarser))
    found = np.where(has_good & known.settled, known.good, found)
    return np.asarray(np.where(np.isfinite(found), found, level), dtype=np.int64)


def _floor(trial: Trial, excess: Floats, components: Components) -> float:
    """Return a size below which no trial like this one will come, at the bounds."""
    with np.errstate(divide="ignore"):
        octaves = np.maximum(np.log2(1 / excess), 0)
    vertices = np.bincount(components.of_vertex, minlength=len(excess))
    return trial.size - PER_OCTAVE * float(octaves @ vertices)


def components_of(V: Floats, F: Ints, parts: Parts, part_diagonal: Floats) -> Components:
    """Return the components of a mesh.

    Parameters
    ----------
    V : float64 (n, 3)
        The vertices of the faces.
    F : int64 (m, 3)
    parts : Parts
    part_diagonal : float64 (q,)
        Diagonal of each part.
    """
    if not parts.components:  # faces that are all degenerate
        none = np.zeros(1, dtype=np.int64)
        return Components(none[:0], part_diagonal, part_diagonal, none, none)
    count, own = parts.components, parts.divisions[0]
    touching = [(part * count + own)[part >= 0] for part in parts.divisions]
    part, touched = np.divmod(distinct(np.concatenate(touching)), count)
    edge = mean_edges(V, F, parts.component[F[:, 0]], count)
    return Components(parts.component[: len(V)], edge, part_diagonal[:count], part, touched)
