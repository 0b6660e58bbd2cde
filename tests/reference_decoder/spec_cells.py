"""§5.20 of `formats/SPEC.md`, and what §5.4 makes of it, to be read beside it.

Anchors that positions go through.
"""

from __future__ import annotations

import math

import numpy as np
import spec_steps
from spec_coder import check


def owners(near, anchors):
    """The places among the anchors of those in whose component there are others."""
    parts = [set(part) & set(anchors) for part in spec_steps.components(near)]
    return [i for i, a in enumerate(anchors) if any(a in part and len(part) > 1 for part in parts)]


def units_of(payload, stages, p, near, anchors):
    """The units, and how many vectors follow."""
    own = owners(near, anchors)
    check(p["interpolated"] and own, "CELL without cells")
    check(len(payload) >= stages and max(payload[:stages]) <= 64, "units")
    return [unit - 32 for unit in payload[:stages]], stages * len(own)


def cells_of(near, anchors):
    """The place among the anchors of the one whose cell each vertex is in."""
    found, queue = [-1] * len(near), list(anchors)
    for place, a in enumerate(anchors):
        found[a] = place
    for v in queue:
        for w in sorted(near[v]):
            if found[w] < 0:
                found[w] = found[v]
                queue.append(w)
    return found


def added(units, vectors, step, near, anchors, ratios):
    """y of each anchor's cell at each stage."""
    own, cells = owners(near, anchors), cells_of(near, anchors)
    y = np.zeros((len(units), len(anchors), 3))
    for k, vector in enumerate(vectors):
        stage, place = k // len(own), own[k % len(own)]
        unit = math.ldexp(step, units[stage]) * ratios[anchors[place]]
        y[stage, place] = unit * np.array(vector, float) / cells.count(place)
    return y


def interpolated(delta, near, anchors, points, y):
    """L x = d in the rows of all vertices but the anchors, which are at their points.

    By component, about the mean of its anchors, for the digits.
    """
    x, d = np.zeros_like(delta), delta + y[cells_of(near, anchors)]
    for part in spec_steps.components(near):
        own = [i for i, a in enumerate(anchors) if a in part]
        held, centre = [anchors[i] for i in own], points[own].sum(axis=0) / len(own)
        free = [v for v in part if v not in held]
        L = np.zeros((len(near), len(near)))
        for v in part:
            L[v, v] = len(near[v])
            L[v, near[v]] = -1
        d[part] -= d[part].sum(axis=0) / len(part)
        x[held] = points[own] - centre
        right = d[free] - L[np.ix_(free, held)] @ x[held]
        x[free] = np.linalg.solve(L[np.ix_(free, free)], right)
        x[part] += centre
    return x
