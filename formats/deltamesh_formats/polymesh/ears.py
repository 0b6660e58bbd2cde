"""Ears of simple polygons, which are clipped off until none is left.

An ear is a triangle of three corners in sequence that lies in the polygon (G. Meisters, *Polygons
have ears*, 1975; H. ElGindy, H. Everett, G. Toussaint, *Slicing an ear using prune-and-search*,
1993). All polygons are clipped at the same time, each at all ears that are better than those
beside them: clipping one of these leaves the others ears.

A hole is a part of the outline, reached over a bridge: two edges that run there and back. Corners
at one position do not hide each other, therefore. A corner that repeats the one before it is
clipped first: as long as an outline has it, neither of the two is the tip of an ear.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.polymesh.permutations import ranges
from deltamesh_formats.polymesh.planes import TINY, following

# The sine of the angle below which a corner is taken as flat, and the part of a triangle's height
# by which a corner beside it still hides it: slivers are clipped only when nothing else is left.
FLAT: Final = 1e-5

# What counts as an ear, from one level to the next when no corner of a polygon is known as one: a
# triangle that is no sliver and that no corner touches; one that no corner touches; one with no
# corner inside.
_CLEAR, _EXACT, _OPEN, _NONE = range(4)

_PAIRS: Final = 1 << 19  # of ears and corners at a time
_APART: Final = 8.0  # of the keys of polygons, whose coordinates are from -2 to 2


def clip_ears(x: Floats, y: Floats, offsets: Ints) -> tuple[Ints, Bools]:
    """Cut polygons into triangles at diagonals inside of them.

    Parameters
    ----------
    x, y : float64 (c,)
        Of the corners, polygon after polygon, as `planes.in_planes` has them.
    offsets : int64 (p + 1,)
        Polygons of at least four corners.

    Returns
    -------
    triangles : int64 (t, 3)
        Corners, polygon after polygon; the size less two for each that is cut.
    cut : bool (p,)
        Whether each polygon is: none of its triangles is turned over, so that their areas add up to
        its own. That may fail where an outline crosses itself; it has no triangles then.
    """
    outlines = _Outlines(x, y, offsets)
    ears = outlines.clip()
    polygon = outlines.polygon[ears[:, 0]]
    cut = outlines.level < _NONE
    cut[polygon[_turn(outlines.x, outlines.y, *ears.T) < -TINY]] = False
    kept = cut[polygon]
    ears, polygon = ears[kept], polygon[kept]
    return ears[np.argsort(polygon, kind="stable")], cut


class _Outlines:
    """What is left of each polygon, as a ring of corners."""

    def __init__(self, x: Floats, y: Floats, offsets: Ints) -> None:
        self.offsets, self.size = offsets, np.diff(offsets)
        self.polygon = np.repeat(np.arange(len(self.size)), self.size)
        self.level = np.full(len(self.size), _CLEAR)
        # Corners are sorted along x: the longer of the two.
        width, height = (
            np.maximum.reduceat(a, offsets[:-1]) - np.minimum.reduceat(a, offsets[:-1])
            for a in (x, y)
        )
        turned = (height > width)[self.polygon]
        self.x, self.y = np.where(turned, y, x), np.where(turned, -x, y)
        self.after = following(offsets)
        self.before = np.empty_like(self.after)
        self.before[self.after] = np.arange(len(x))
        self.area, self.quality, self.score = np.empty((3, len(x)))
        self.flat = np.empty(len(x), dtype=np.bool_)  # or reflex, and not clipped yet
        self.repeats = np.empty(len(x), dtype=np.bool_)  # the position of the corner before
        self.is_ear = np.empty(len(x), dtype=np.bool_)  # as far as is known
        self.marked = np.zeros(len(self.size), dtype=np.bool_)
        self._measure(np.arange(len(x)))
        self._sort()

    def clip(self) -> Ints:
        """Clip all ears; return them as triangles of corners.

        A round costs what it changes, since a winding polygon takes very many: only corners
        beside a clipped ear are looked at again, the others on the next level.
        """
        found = [np.empty((0, 3), dtype=np.int64)]
        ears, changed = np.empty(0, dtype=np.int64), np.arange(len(self.x))
        unfinished = np.arange(len(self.size))
        while len(unfinished):
            ears = np.concatenate([ears, self._clear(changed)])
            best = ears[self._is_best(ears)]
            before, after, polygon = self.before[best], self.after[best], self.polygon[best]
            found.append(np.stack([before, best, after], axis=1))
            self._unlink(best)
            finished, one = np.unique(polygon[self.size[polygon] == 3], return_index=True)
            first = before[self.size[polygon] == 3][one]
            second = self.after[first]
            found.append(np.stack([first, second, self.after[second]], axis=1))
            again = self._raise(self._without(unfinished, polygon))
            unfinished = self._without(unfinished, finished)
            unfinished = unfinished[self.level[unfinished] < _NONE]
            changed = np.concatenate([np.unique(np.concatenate([before, after])), again])
            ears, changed = (a[self.size[self.polygon[a]] > 3] for a in (ears, changed))
            ears = ears[self.is_ear[ears]]
        return np.concatenate(found)

    def _clear(self, corners: Ints) -> Ints:
        """Return those of the corners that are ears."""
        level, area = self.level[self.polygon[corners]], self.area[corners]
        repeats = self.repeats[corners] & (level < _NONE)
        sharp = np.choose(level, [~self.flat[corners], area > 0, area >= -TINY, False])
        self._look(corners[sharp & ~repeats])
        self.is_ear[corners[repeats]] = True
        clear: Ints = corners[self.is_ear[corners]]
        self.score[clear] = np.where(self.repeats[clear], np.inf, self.quality[clear])
        return clear

    def _is_best(self, ears: Ints) -> Bools:
        """Return which ears are better than those beside them, the first of equal ones."""
        best = self._beats(ears, self.before[ears]) & self._beats(ears, self.after[ears])
        # Of four corners, two that are opposite must not both go.
        four = np.flatnonzero(self.size[self.polygon[ears]] == 4)
        if len(four):
            best[four] &= self._beats(ears[four], self.after[self.after[ears[four]]])
        return best

    def _beats(self, ears: Ints, others: Ints) -> Bools:
        mine, theirs = self.score[ears], self.score[others]
        return np.asarray((mine > theirs) | ((mine == theirs) & (ears < others)))

    def _unlink(self, ears: Ints) -> None:
        before, after = self.before[ears], self.after[ears]
        self.after[before], self.before[after] = after, before
        self.after[ears], self.flat[ears], self.is_ear[ears] = -1, False, False
        np.subtract.at(self.size, self.polygon[ears], 1)
        self._measure(np.concatenate([before, after]))
        self.until_sorting -= len(ears)
        if self.until_sorting < 0:
            self._sort()

    def _raise(self, stuck: Ints) -> Ints:
        """Put polygons without an ear on the next level; return their corners."""
        self.level[stuck] += 1
        if not len(stuck):
            return stuck
        first = self.offsets[stuck]
        corners = ranges(first, self.offsets[stuck + 1] - first)
        return corners[self.after[corners] >= 0]

    def _without(self, polygons: Ints, others: Ints) -> Ints:
        self.marked[others] = True
        rest = polygons[~self.marked[polygons]]
        self.marked[others] = False
        return rest

    def _measure(self, corners: Ints) -> None:
        before, after = self.before[corners], self.after[corners]
        x, y = self.x, self.y
        ax, ay = x[corners] - x[before], y[corners] - y[before]
        bx, by = x[after] - x[corners], y[after] - y[corners]
        area, a, b = ax * by - ay * bx, ax * ax + ay * ay, bx * bx + by * by
        around = a + b + (ax + bx) ** 2 + (ay + by) ** 2
        self.area[corners] = area
        self.quality[corners] = area / np.where(around > 0, around, 1)
        self.score[corners] = -np.inf
        self.repeats[corners] = (ax == 0) & (ay == 0)
        self.flat[corners] = area <= FLAT * np.sqrt(a * b)
        self.is_ear[corners] = False

    def _sort(self) -> None:
        """Sort the corners that may hide an ear: one that is hidden, is by a reflex corner."""
        flat = np.flatnonzero(self.flat)
        key = _APART * self.polygon[flat] + self.x[flat]
        order = np.argsort(key, kind="stable")
        self.sorted, self.keys = flat[order], key[order]
        self.until_sorting = int(self.size.sum()) // 2

    def _look(self, ears: Ints) -> None:
        """Find out which corners are ears of those that are sharp enough."""
        self.is_ear[ears] = True
        x = np.stack([self.x[self.before[ears]], self.x[ears], self.x[self.after[ears]]])
        low, high = x.min(axis=0), x.max(axis=0)
        margin = 2 * FLAT * (high - low)
        base = _APART * self.polygon[ears]
        first = np.searchsorted(self.keys, base + (low - margin), side="left")
        count = np.searchsorted(self.keys, base + (high + margin), side="right") - first
        ears, first, count = (a[count > 0] for a in (ears, first, count))
        total, begin = np.cumsum(count), 0
        while begin < len(ears):
            # Several at a time, at least one.
            end = np.searchsorted(total, total[begin] - count[begin] + _PAIRS, side="right")
            some = slice(begin, max(int(end), begin + 1))
            other = self.sorted[ranges(first[some], count[some])]
            self.is_ear[self._hidden(np.repeat(ears[some], count[some]), other)] = False
            begin = some.stop

    def _hidden(self, ear: Ints, other: Ints) -> Ints:
        """Return the ears of those pairs in which the other corner hides the ear."""
        x, y, level = self.x, self.y, self.level[self.polygon[ear]]
        margin = np.choose(level, [-FLAT * self.area[ear], 0.0, TINY])
        near = np.flatnonzero(self.flat[other])
        sides = (self.after, self.before), (self.before, None), (None, self.after)
        for from_, to in sides:
            some, at = ear[near], other[near]
            a, b = (some if link is None else link[some] for link in (from_, to))
            near = near[_turn(x, y, a, b, at) >= margin[near]]
        for link in (self.before, None, self.after):
            some, at = ear[near], other[near]
            corner = some if link is None else link[some]
            near = near[(x[at] != x[corner]) | (y[at] != y[corner])]
        return ear[near]


def _turn(x: Floats, y: Floats, a: Ints, b: Ints, c: Ints) -> Floats:
    """Return twice the area of triangles, negative where they turn to the right."""
    turn: Floats = (x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])
    return turn
