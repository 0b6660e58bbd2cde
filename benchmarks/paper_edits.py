"""A bar, bent and twisted by its ends: section 5 of the paper."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from paper_models import Floats, Model
from paper_tables import Row, Table, small

from deltamesh import differential as dc

# How far from an end its vertices are held, of the length; rings of the rotations that are fitted.
_HELD, _RINGS = 0.05, 4


def rotation(axis: int, degrees: float) -> Floats:
    """Return the rotation about a coordinate axis, float64 (3, 3)."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[[i, j], [i, j]] = c
    R[i, j], R[j, i] = -s, s
    return R


# Of the upper end: its rotation, and where its middle goes, unless it stays.
EDITS = {
    "bent by 120°": (rotation(1, 120), (3.2, 0.0, 3.4)),
    "twisted by 135°": (rotation(2, 135), None),
}


def edited(m: Model, name: str) -> tuple[Floats, dict[str, Floats], float]:
    """Return handles' goals, positions by each scheme, and how far handles are off, by scheme."""
    turn, goal = EDITS[name]
    z = (m.V[:, 2] - m.V[:, 2].min()) / np.ptp(m.V[:, 2])
    moved = z > 1 - _HELD
    handles = np.flatnonzero(moved | (z < _HELD))
    middle = m.V[moved].mean(axis=0)
    to = np.array(middle if goal is None else goal)
    turned = moved[handles, None]
    c = np.where(turned, (m.V[handles] - middle) @ turn.T + to, m.V[handles])
    R = np.where(turned[:, :, None], turn, np.eye(3))
    system = dc.LeastSquares(m.L, handles)
    plain = system.solve(m.delta, c)
    local = dc.fitted_rotations(m.L, m.V, plain, _RINGS)
    blended = system.solve(np.zeros((len(m.V), 9)), R.reshape(-1, 9)).reshape(-1, 3, 3)
    each = dc.nearest_rotations(blended)
    found = {
        "deltas as they are": plain,
        "turned by rotations of that": system.solve(np.einsum("nij,nj->ni", local, m.delta), c),
        "two systems": system.solve(dc.turned_deltas(m.L, m.V, each), c),
    }
    return handles, found, c


def _edits(m: Model) -> Iterator[Row]:
    for name in EDITS:
        handles, found, c = edited(m, name)
        i, j = m.edges.T
        lengths = np.linalg.norm(m.V[i] - m.V[j], axis=1)
        for scheme, x in found.items():
            ratio = np.linalg.norm(x[i] - x[j], axis=1) / lengths
            miss = np.linalg.norm(x[handles] - c, axis=1).max() / m.diagonal
            stretch = 100 * math.sqrt(((ratio - 1) ** 2).mean())
            yield name, scheme, f"{stretch:.0f} %", f"{m.errors(x).dihedral:.2f}", small(miss)


TABLES = (
    Table(
        "edits",
        ("mesh", "edit", "deltas", "edges, RMS change", "dihedral angles", "handles off by"),
        _edits,
        ("fine bar",),
        (),
    ),
)
